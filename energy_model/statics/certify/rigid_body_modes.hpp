#pragma once

#include <Eigen/Core>
#include <optional>

#include "linear/reduced_hessian.hpp"
#include "problem/span.hpp"
#include "strain/span_energy.hpp"

namespace dlo::energy_model {

/// Numbers of rotations of a span's shape as a whole that its grips, weight and loads leave free
/// and that change the shape's position. The shape belongs to a circle (or a sphere) of equilibria
/// of equal energy. Each such rotation is a zero mode of the second variation that indicates
/// neither a fold nor a bifurcation. A rotation with the axis and rate omega is free if omega x v =
/// 0 for every prescribed position and direction v and for every force; obstacles are ignored.
struct RigidBodyModes {
  Eigen::Index in_plane = 0;  ///< planar span: rotations about its normal; in space: all of them
  /// Planar span: rotations about axes in its plane; 0 if Span::stays_in_plane().
  Eigen::Index out_of_plane = 0;

  [[nodiscard]] Eigen::Index all() const { return in_plane + out_of_plane; }
};

/// Counts the rigid-body modes of a shape. @param tangents  along the shape, 3 x M; a rotation
/// about the axis of a straight round rod does not move it and does not count
[[nodiscard]] RigidBodyModes rigid_body_modes(const Span& span, const Eigen::Matrix3Xd& tangents);

/// Returns the unit eigenvectors of the eigenvalues nearest to zero, one more than there are
/// rigid-body modes, if a shift of the shape along the rod is among them; otherwise std::nullopt. A
/// uniform straight rod on which only grips at its ends act has such a mode if it is straight at
/// both ends, like a helix or a loop in the middle of a long rod: the shape may be anywhere along
/// the rod with equal energy.
/// @param hessian  at the shape
/// @param rigid    RigidBodyModes::in_plane of the shape
[[nodiscard]] std::optional<Eigen::MatrixXd> sliding_modes(const SpanEnergy& model,
                                                           const Eigen::VectorXd& x,
                                                           ReducedHessian& hessian,
                                                           Eigen::Index rigid);

/// Whether a rotation that keeps all prescribed vectors and forces maps one shape to the other, so
/// that both belong to the same circle of equilibria; false for a rod with material directors.
/// @param a, b  points of both shapes at the same arc lengths, relative to the anchor, 3 x M
[[nodiscard]] bool is_rotated_copy(const Span& span, const Eigen::Matrix3Xd& a,
                                   const Eigen::Matrix3Xd& b);

}  // namespace dlo::energy_model
