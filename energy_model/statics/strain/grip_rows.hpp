#pragma once

#include <Eigen/Core>
#include <vector>

#include "frames/planar_frames.hpp"
#include "frames/rod_frames.hpp"
#include "problem/span.hpp"

namespace dlo::energy_model {

/// Residual of a director p that is prescribed as `to`, in its component along `across`, which is
/// normal to `to`,
///     c = 2 across.p / (1 + to.p).
/// It is approximately the angle, and with both components zero only at p = to. A rotation vector
/// theta of p changes it by couple . theta + theta . curvature theta / 2.
struct DirectionResidual {
  double value = 0;
  Eigen::Vector3d couple = Eigen::Vector3d::Zero();
  Eigen::Matrix3d curvature = Eigen::Matrix3d::Zero();
};

/// A planar span at unknowns x: its frames, their state and the tangents at the nodes (nodes x 3).
struct PlanarPoint {
  const PlanarFrames& frames;
  PlanarFrames::State& state;
  const Eigen::MatrixX3d& tangents;
  const Eigen::VectorXd& x;
};

/// A span in space at its unknowns: its frames, their state and the tangents at the nodes (nodes x
/// 3).
struct SpatialPoint {
  const RodFrames& frames;
  RodFrames::State& state;
  const Eigen::MatrixX3d& tangents;
  /// Derivative of the last unknown by the twist psi; 0 if psi is not an unknown.
  double twist_root = 0;
  double psi = 0;  ///< angle of d1 at the end relative to the frames' d1 [rad]

  [[nodiscard]] Eigen::Index strains() const { return frames.fields() * frames.columns(); }
};

/// Constraints of the grips beyond the first one. First come the positions of the grips relative to
/// the anchor, in two components (plane) or three, then the directions that clamps prescribe, in
/// one or two components, and last d1 at the end if the end frames are prescribed (Span::twist).
/// Their multipliers are the grips' forces [EI/l^2] and torques [EI/l].
///
/// Rows of positions are the first ones of `residual` and `jacobian`, and rows of directions the
/// last ones; rows of contacts may stand between them.
class GripRows {
 public:
  void reset(const Span& span, const std::vector<Element>& elements, const LegendreTable& table);
  /// Adds the data of a span in its plane; call after reset().
  void reset_in_plane(const PlanarFrames& frames);

  [[nodiscard]] Eigen::Index positions() const { return axes_ * reach_.cols(); }
  [[nodiscard]] Eigen::Index directions() const { return std::ssize(directions_); }

  void constrain(const PlanarPoint& at, Eigen::Ref<Eigen::VectorXd> residual,
                 Eigen::Ref<Eigen::MatrixXd> jacobian) const;
  void constrain(const SpatialPoint& at, Eigen::Ref<Eigen::VectorXd> residual,
                 Eigen::Ref<Eigen::MatrixXd> jacobian) const;
  /// Adds to `carried` (nodes x 3) the node's quadrature weight times the forces that the
  /// multipliers carry there.
  void add_forces(const Eigen::Ref<const Eigen::VectorXd>& multipliers,
                  Eigen::MatrixX3d& carried) const;
  /// Computes, for each element, first and second derivatives of -mu times the residuals of
  /// directions by rotations of the frame at its end.
  void rotation_derivatives(const SpatialPoint& at,
                            const Eigen::Ref<const Eigen::VectorXd>& multipliers,
                            std::vector<Eigen::Vector3d>& couples,
                            std::vector<Eigen::Matrix3d>& curvatures) const;
  /// Computes the last row and column of the Hessian, and adds to their common element: second
  /// derivatives of `factor` times the row of d1, at least once by the last unknown (the twist psi
  /// times twist_root). Call it after FrameHessian::add(), which computes the rotations of the
  /// end.
  void add_twist_hessian(const SpatialPoint& at, double factor, Eigen::MatrixXd& hessian) const;
  /// Computes the constraints' Jacobian for tilts out of the plane, one row per constraint.
  void tilt_jacobian(const PlanarFrames& frames, Eigen::MatrixXd& jacobian) const;

  /// Returns the root of the sum of the squared distances by which a shape with these tangents at
  /// the nodes (3 x nodes) misses the grips.
  [[nodiscard]] double gap(const Eigen::Matrix3Xd& tangents) const;
  /// Shifts the clamps' angles by multiples of 2 pi to the winding of a shape; in the plane.
  void unwrap(const Eigen::Ref<const Eigen::VectorXd>& x, double start_theta);
  /// Sets d1 of the clamp at the end, for a span with prescribed end frames.
  /// @param direction  direction of that clamp, which stays as it was in reset()
  void turn_end_clamp(const Eigen::Vector3d& direction, const Eigen::Vector3d& d1);

  /// Returns the torque of a grip.
  /// @param at  in space; null: in the plane
  [[nodiscard]] Eigen::Vector3d torque(Eigen::Index hold, const Eigen::VectorXd& multipliers,
                                       const SpatialPoint* at) const;

 private:
  /// One component of the constraint on a director that a clamp prescribes.
  struct DirectionRow {
    Eigen::Index hold;     // in holds_
    Eigen::Index element;  // the element at whose end the clamp is
    Eigen::Vector3d to = Eigen::Vector3d::Zero();
    Eigen::Vector3d across = Eigen::Vector3d::Zero();
    bool of_d1 = false;  // constrains d1 instead of the tangent
    double angle = 0;    // in the plane: PlanarFrames::angle_towards(), with whole turns
  };
  [[nodiscard]] static DirectionResidual residual_of(const DirectionRow& row,
                                                     const SpatialPoint& at);

  Eigen::Index axes_ = 2;  // position components that are constrained, 2 or 3
  std::vector<Span::Hold> holds_;
  Eigen::MatrixXd reach_;  // per grip: quadrature weight of the node times -1, 0, 1
  std::vector<std::vector<double>> reach_signs_;  // -1, 0, 1 by grip and element
  std::vector<DirectionRow> directions_;
  Eigen::MatrixXd
      direction_derivatives_;  // in the plane: derivatives of the direction rows by the unknowns
};

}  // namespace dlo::energy_model
