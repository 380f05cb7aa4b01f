#pragma once

#include <Eigen/Core>
#include <vector>

#include "frames/frame_hessian.hpp"
#include "frames/planar_frames.hpp"
#include "frames/rod_frames.hpp"
#include "strain/contact_place.hpp"
#include "strain/soft_contact.hpp"

namespace dlo::energy_model {

/// What SpanEnergy::evaluate() has computed at a point: a value of its own, whatever is evaluated
/// after it. Where the model asks for a point that is not const it works in its scratch. Buffers
/// survive from one evaluation to the next.
struct SpanPoint {
  Eigen::VectorXd x;
  double energy = 0;         ///< [EI/l]
  Eigen::VectorXd gradient;  ///< of the energy
  Eigen::VectorXd residual;  ///< of the constraints
  Eigen::MatrixXd jacobian;  ///< of them, constraints x unknowns

  Eigen::MatrixX3d t;      ///< tangents at the nodes, nodes x 3
  Eigen::MatrixX3d force;  ///< -dE/dt of all but bending, loads and the obstacles' beyond the node
  PlanarFrames::State plane;  ///< of a span in its plane
  RodFrames::State frames;    ///< of one in space
  ContactPlace contacts;
  SoftContact::Place pressed;
  /// SpanEnergy::revision() of the model; 0: of none.
  long revision = 0;

  // Scratch
  Eigen::MatrixX3d carried;  // force and what grips and contacts add to it
  Eigen::VectorXd along, by_unknown;
  std::vector<Eigen::Vector3d> couples;     // by piece
  std::vector<Eigen::Matrix3d> curvatures;  // by piece
  FrameHessian frame_hessian;

  /// At the nodes, 3 x nodes.
  [[nodiscard]] Eigen::Matrix3Xd tangents() const { return t.transpose(); }
  /// d1 of the rod's own frame there, of a span in space with material directors.
  [[nodiscard]] Eigen::Matrix3Xd d1() const { return frames.d1.bottomRows(t.rows()).transpose(); }
  /// d1 at the end, of the frame with Span::first_d1() at the start, the rod's or Bishop's, of a
  /// span in space.
  [[nodiscard]] Eigen::Vector3d end_d1() const { return frames.end_frame().col(0); }
};

}  // namespace dlo::energy_model
