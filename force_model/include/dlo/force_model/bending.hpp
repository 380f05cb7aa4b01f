#pragma once

#include <Eigen/Core>

#include "dlo/force_model/bending_law.hpp"

namespace dlo::force_model {

/// Bending law and stiffness of the joints, and their angles at rest.
///
/// A joint that is bent by alpha_0 at rest has the moment M(alpha) - M(alpha_0), with M from
/// joint_moment. The natural shape thus adds a constant couple M(alpha_0), as in a rod with the
/// moment EI (kappa - kappa_0). Natural angles have a sign only in a plane: in space they would
/// need the rod's frame, which points do not have. Such a rod therefore lies in the plane z = 0,
/// with all that holds it and acts on it. Its stability out of that plane is not examined.
struct Bending {
  BendingLaw law = BendingLaw::hooke;  ///< dependence of the moment on the angle
  double stiffness = 0;                ///< c_b [N] for `paper`, EI [N m^2] for `hooke`; >= 0
  /// Stiffness of each joint P_1 .. P_{n-1}, in the unit of `stiffness`; empty: all have
  /// `stiffness`.
  Eigen::VectorXd stiffnesses = {};
  /// Angle of each joint P_1 .. P_{n-1} at rest, from x to y [rad], |alpha_0| < hooke_fold_angle,
  /// law hooke only; empty: the rod is intrinsically straight.
  Eigen::VectorXd natural_turns = {};
};

/// Returns law and stiffness of the joint at P_i, 1 <= i <= n-1, without its natural angle.
[[nodiscard]] Bending bending_at(const Bending& bending, Eigen::Index i);

/// Returns the couple M(alpha_0) of the joint at P_i [N m], from x to y; zero for a straight joint.
/// @param segment_length  mean rest length of its two segments [m]
[[nodiscard]] double natural_moment(const Bending& bending, Eigen::Index i, double segment_length);

/// Checks bending parameters. @throws std::invalid_argument if a number is out of range, if a
/// vector neither is empty nor has one entry per joint, or if the paper's law has natural angles
void check(const Bending& bending, Eigen::Index segments);

/// Returns the moment of one joint [N m] at the joint angle `alpha` [rad], 0 <= alpha <= pi,
/// without its natural angle.
/// @throws std::invalid_argument if an argument is out of range
[[nodiscard]] double joint_moment(const Bending& bending, double segment_length, double alpha);

/// Returns the potential of one joint [J]; its derivative by alpha is joint_moment. Arguments and
/// errors as for joint_moment.
[[nodiscard]] double joint_potential(const Bending& bending, double segment_length, double alpha);

/// Returns the derivative of joint_moment by alpha [N m]. Arguments and errors as for joint_moment.
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
/// up to hooke_fold_angle; beyond it the forces have the same directions and the moment of that
/// angle. Net force and net torque are zero for any segments. What a natural turn adds, z the unit
/// vector along +z:
///     P_{i+1}: M(alpha_0)/|b| z x v   P_{i-1}: M(alpha_0)/|a| z x u   P_i: minus the sum
///
/// At a full fold (u = -v) the direction of opening is not defined. A fixed one orthogonal to u is
/// taken, for `paper` only if a = b: else e is parallel to u, and there is no force. A joint next
/// to a segment of zero length has no angle and exerts no force.
/// @param points        positions [m], 3 x (n+1), n >= 1
/// @param rest_lengths  [m], n, > 0
/// @param[in,out] forces  added to, not overwritten [N], 3 x (n+1)
/// @throws std::invalid_argument if a shape or number is out of range
void add_bending_forces(const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                        const Eigen::Ref<const Eigen::VectorXd>& rest_lengths,
                        const Bending& bending, Eigen::Ref<Eigen::Matrix3Xd> forces);

/// Returns the potential energy of bending [J], a sum over the inner points: joint_potential
/// P(alpha), or with a natural angle P(alpha) - P(alpha_0) - M(alpha_0) (alpha - alpha_0), whose
/// minimum is zero, at rest. That angle alpha has a sign, and jumps where the joint is folded back
/// on itself. Arguments and errors as for add_bending_forces.
[[nodiscard]] double bending_energy(const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                                    const Eigen::Ref<const Eigen::VectorXd>& rest_lengths,
                                    const Bending& bending);

}  // namespace dlo::force_model
