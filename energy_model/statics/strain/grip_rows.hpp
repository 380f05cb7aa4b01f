#pragma once

#include <Eigen/Core>
#include <vector>

#include "frames/planar_frames.hpp"
#include "frames/rod_frames.hpp"
#include "problem/span.hpp"
#include "strain/direction_residual.hpp"

namespace dlo::energy_model {

/// A span in its plane at unknowns x: tangents at the nodes (nodes x 3), and what they were made
/// of.
struct PlanarPoint {
  const PlanarFrames& frames;
  PlanarFrames::State& state;
  const Eigen::MatrixX3d& tangents;
  const Eigen::VectorXd& x;
};

/// The same in space.
struct SpatialPoint {
  const RodFrames& frames;
  RodFrames::State& state;
  const Eigen::MatrixX3d& tangents;
  /// Derivative of the last unknown by the twist psi; 0: psi is none of them.
  double twist_root = 0;
  double psi = 0;  ///< by which d1 at the end is ahead of the frames' [rad]

  [[nodiscard]] Eigen::Index strains() const { return frames.fields() * frames.columns(); }
};

/// Constraints of the grips beyond the first: of a hold's position as seen from the anchor, in two
/// components (plane) or three, then of the directions that clamps hold, in one or two, and last of
/// d1 at the end where the ends' frames are held (Span::twist). Their multipliers are the grips'
/// forces [EI/l^2] and torques [EI/l].
///
/// Rows of positions are the first ones of `residual` and `jacobian`, those of directions the last
/// ones; the contacts' may stand between.
class GripRows {
 public:
  void reset(const Span& span, const std::vector<Piece>& pieces, const LegendreTable& table);
  /// Besides, of a span in its plane.
  void reset_in_plane(const PlanarFrames& frames);

  [[nodiscard]] Eigen::Index positions() const { return axes_ * reach_.cols(); }
  [[nodiscard]] Eigen::Index directions() const { return std::ssize(directions_); }

  void constrain(const PlanarPoint& at, Eigen::Ref<Eigen::VectorXd> residual,
                 Eigen::Ref<Eigen::MatrixXd> jacobian) const;
  void constrain(const SpatialPoint& at, Eigen::Ref<Eigen::VectorXd> residual,
                 Eigen::Ref<Eigen::MatrixXd> jacobian) const;
  /// Adds quadrature weight of the node times the forces that the multipliers carry there, nodes x
  /// 3.
  void add_forces(const Eigen::Ref<const Eigen::VectorXd>& multipliers,
                  Eigen::MatrixX3d& carried) const;
  /// By piece, what -mu times the residuals of directions has as first and second derivatives by
  /// turns of the frame at its end.
  void turn_derivatives(const SpatialPoint& at,
                        const Eigen::Ref<const Eigen::VectorXd>& multipliers,
                        std::vector<Eigen::Vector3d>& couples,
                        std::vector<Eigen::Matrix3d>& curvatures) const;
  /// Second derivatives with the twist psi of a factor times the row of d1: the last row and column
  /// of the Hessian. After FrameHessian::add(), which leaves the turns of the end.
  void add_twist_hessian(const SpatialPoint& at, double factor, Eigen::MatrixXd& hessian) const;
  /// Constraints on tilts out of the plane, one a row.
  void tilt_jacobian(const PlanarFrames& frames, Eigen::MatrixXd& jacobian) const;

  /// How far from the holds tangents at the nodes (3 x nodes) end.
  [[nodiscard]] double gap(const Eigen::Matrix3Xd& tangents) const;
  /// Turns the clamps' angles to the winding of the shape with these angles at the nodes, and of
  /// these unknowns. In the plane.
  void unwrap(const Eigen::VectorXd& angles, Eigen::Index nodes_of_piece);
  void unwrap(const Eigen::Ref<const Eigen::VectorXd>& x, double start_theta);
  /// Takes on the winding of the same span's rows.
  void unwrap(const GripRows& other);
  /// Of the clamp at the end.
  void turn_end_clamp(const Eigen::Vector3d& direction, const Eigen::Vector3d& d1);

  /// Torque of a hold, and moment about the anchor of all holds. @param at  in space; null: plane
  [[nodiscard]] Eigen::Vector3d torque(Eigen::Index hold, const Eigen::VectorXd& multipliers,
                                       const SpatialPoint* at) const;
  [[nodiscard]] Eigen::Vector3d moment(const Eigen::VectorXd& multipliers,
                                       const SpatialPoint* at) const;

 private:
  /// A constraint on a director that a clamp holds, in one component.
  struct DirectionRow {
    Eigen::Index hold;   // in holds_
    Eigen::Index piece;  // at whose end it is
    Eigen::Vector3d to = Eigen::Vector3d::Zero();
    Eigen::Vector3d across = Eigen::Vector3d::Zero();
    bool of_d1 = false;  // not of the tangent
    double angle = 0;    // in the plane, PlanarFrames::angle_towards(), whole turns counted
  };
  void list_directions(const Span& span, const std::vector<Piece>& pieces);
  [[nodiscard]] static DirectionResidual residual_of(const DirectionRow& row,
                                                     const SpatialPoint& at);

  Eigen::Index axes_ = 2;  // position components that are constrained, 2 or 3
  std::vector<Span::Hold> holds_;
  Eigen::MatrixXd reach_;  // per hold, quadrature weight of the node times -1, 0, 1
  std::vector<std::vector<double>> reach_signs_;  // the same by hold and piece, without weights
  std::vector<DirectionRow> directions_;
  Eigen::MatrixXd held_angle_;  // in the plane, of the direction rows by unknown
};

}  // namespace dlo::energy_model
