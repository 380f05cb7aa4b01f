#pragma once

#include <Eigen/Core>

#include "dlo/force_model/bending_law.hpp"

namespace dlo::force_model {

/// What resists bending.
struct Bending {
  BendingLaw law = BendingLaw::hooke;  ///< how the moment grows with the angle
  double stiffness = 0;                ///< c_b [N] for `paper`, EI [N m^2] for `hooke`; >= 0
};

/// Moment of one joint [N m] at turning angle `alpha` [rad], 0 <= alpha <= pi.
[[nodiscard]] double joint_moment(const Bending& bending, double segment_length, double alpha);

/// Potential of one joint [J]; its derivative by alpha is joint_moment.
[[nodiscard]] double joint_potential(const Bending& bending, double segment_length, double alpha);

/// Derivative of joint_moment by alpha [N m].
[[nodiscard]] double joint_stiffness(const Bending& bending, double segment_length, double alpha);

/// Adds the inner force of bending on every point.
///
/// With u, v the unit vectors of the two segments at P_i, F = c_b (1 - u.v) e, e the unit chord
/// from P_{i-1} to P_{i+1}:
///     paper:  P_{i+1}: F - (F.v) v      P_{i-1}: -(F - (F.u) u)      P_i: minus the sum of both
/// The paper prints (Formula 4) the same parts with signs that leave a net force; Fig. 2 and
/// equilibrium ask for these. Net force and net torque are zero for any segments. Between unequal
/// ones the moment is c_b (1 - u.v) |u x v| a b / |a u + b v|, by (a - b)^2/(a + b)^2 below that of
/// their mean length for small angles, and has no potential, as it depends on the lengths now.
///
/// With k = 2 (EI/L) / (1 + u.v), a and b the two segments:
///     hooke:  P_{i+1}: k/|b| (u - (u.v) v)   P_{i-1}: -k/|a| (v - (u.v) u)   P_i: minus the sum
/// Net force and net torque are zero for any segments.
///
/// At a full fold (u = -v) the direction of opening is not defined; a fixed one orthogonal to u is
/// taken. A joint next to a segment of zero length has no angle and exerts no force.
/// @param points        positions [m], 3 x (n+1), n >= 1
/// @param rest_lengths  [m], n, > 0
/// @param[in,out] forces  added to, not overwritten [N], 3 x (n+1)
/// @throws std::invalid_argument if a shape or number is out of range
void add_bending_forces(const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                        const Eigen::Ref<const Eigen::VectorXd>& rest_lengths,
                        const Bending& bending, Eigen::Ref<Eigen::Matrix3Xd> forces);

/// Sum of joint_potential over the inner points [J]. Arguments and errors as above.
[[nodiscard]] double bending_energy(const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                                    const Eigen::Ref<const Eigen::VectorXd>& rest_lengths,
                                    const Bending& bending);

}  // namespace dlo::force_model
