#pragma once

#include <Eigen/Core>
#include <optional>

#include "linear/reduced_hessian.hpp"
#include "problem/span.hpp"
#include "strain/span_energy.hpp"

namespace dlo::energy_model {

/// Rotations of a span's shape as a whole that its grips, weight and loads leave free and that move
/// it: the shape goes through a circle (or a sphere) of equilibria of equal energy. Each is a zero
/// of the second variation that is no fold and no bifurcation. A rotation with the axis and rate
/// omega is free if omega x v = 0 of every position and direction v that is held and of every
/// force; obstacles are not asked.
struct RigidBodyModes {
  Eigen::Index in_plane = 0;      ///< of a planar span about its normal; in space all of them
  Eigen::Index out_of_plane = 0;  ///< of a planar span about axes in its plane

  [[nodiscard]] Eigen::Index all() const { return in_plane + out_of_plane; }
};

/// @param tangents  along the shape, 3 x M; a round rod that lies on the axis is not moved by a
/// rotation
[[nodiscard]] RigidBodyModes rigid_body_modes(const Span& span, const Eigen::Matrix3Xd& tangents);

/// Returns the unit directions of the eigenvalues nearest to zero, one more than there are
/// rigid-body modes, if one of them shifts the shape along the rod; else nothing. A uniform
/// straight rod that only grips at its ends act on has such a mode if it is straight at both ends,
/// as a helix or a loop in the middle of a long rod: the shape may be anywhere along the rod, with
/// equal energy.
/// @param hessian  at the shape
/// @param rigid    number of rigid_body_modes()
[[nodiscard]] std::optional<Eigen::MatrixXd> sliding_modes(const SpanEnergy& model,
                                                           const Eigen::VectorXd& x,
                                                           ReducedHessian& hessian,
                                                           Eigen::Index rigid);

/// Whether one shape is another one of such a circle: a proper rotation takes all of its points,
/// from the anchor, to the other's and keeps what is held and every force.
/// @param a, b  points of both at the same arc lengths, 3 x M
[[nodiscard]] bool is_turned_copy(const Span& span, const Eigen::Matrix3Xd& a,
                                  const Eigen::Matrix3Xd& b);

}  // namespace dlo::energy_model
