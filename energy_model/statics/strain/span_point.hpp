#pragma once

#include <Eigen/Core>
#include <vector>

#include "frames/frame_hessian.hpp"
#include "frames/planar_frames.hpp"
#include "frames/rod_frames.hpp"
#include "strain/contact_place.hpp"

namespace dlo::energy_model {

/// Results of SpanEnergy::evaluate() at one point, independent of later evaluations. Functions of
/// the model that take a non-const point use its scratch. Buffers are kept from one evaluation to
/// the next.
struct SpanPoint {
  Eigen::VectorXd x;
  double energy = 0;         ///< energy at x [EI/l]
  Eigen::VectorXd gradient;  ///< gradient of the energy
  Eigen::VectorXd residual;  ///< residuals of the constraints
  Eigen::MatrixXd jacobian;  ///< derivatives of the constraints, constraints x unknowns

  Eigen::MatrixX3d t;         ///< tangents at the nodes, nodes x 3
  Eigen::MatrixX3d force;     ///< -dE/dt without bending, nodes x 3: loads and soft obstacles
  PlanarFrames::State plane;  ///< frames of a span in its plane
  RodFrames::State frames;    ///< frames of a span in space
  ContactEvaluation contacts;
  /// SpanEnergy::revision() at the evaluation; 0: not evaluated.
  long revision = 0;

  // Scratch
  // `force` plus the forces of grips and contacts; SpanEnergy::hessian() negates it in space.
  Eigen::MatrixX3d carried;
  Eigen::VectorXd along, by_unknown;
  std::vector<Eigen::Vector3d> couples;     // one per element
  std::vector<Eigen::Matrix3d> curvatures;  // one per element
  FrameHessian frame_hessian;

  /// Tangents at the nodes, 3 x nodes.
  [[nodiscard]] Eigen::Matrix3Xd tangents() const { return t.transpose(); }
  /// Returns d1 of the rod's own frame at the nodes, for a span in space with material directors.
  [[nodiscard]] Eigen::Matrix3Xd d1() const { return frames.d1.bottomRows(t.rows()).transpose(); }
  /// Returns d1 at the end of the frame that has Span::first_d1() at the start (the rod's own or
  /// Bishop's), for a span in space.
  [[nodiscard]] Eigen::Vector3d end_d1() const { return frames.end_frame().col(0); }
};

}  // namespace dlo::energy_model
