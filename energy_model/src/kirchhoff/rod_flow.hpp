#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace dlo::energy_model {

/// A section of the rod, in units of the rod.
struct RodSection {
  double bending = 1;  ///< b, its EI over bending_unit(); about d1 where bending_2 is given
  double torsion = 0;  ///< c, its GJ over the same unit; > 0 where directors come along
  Eigen::Vector3d weight = Eigen::Vector3d::Zero();  ///< w
  std::optional<double> bending_2 = std::nullopt;    ///< about d2; none: as about d1

  /// About d1, d2 and the tangent.
  [[nodiscard]] Eigen::Vector3d stiffness() const {
    return {bending, bending_2.value_or(bending), torsion};
  }
};

/// Cross-section of an inextensible, round, naturally straight Kirchhoff rod in units of its length
/// and stiffness (l, EI/l, EI/l^2).
struct RodState {
  Eigen::Vector3d r = Eigen::Vector3d::Zero();  ///< position
  Eigen::Vector3d t = Eigen::Vector3d::Zero();  ///< unit tangent
  Eigen::Vector3d v = Eigen::Vector3d::Zero();  ///< dt/ds, across t; the moment is b t x v + M t
  Eigen::Vector3d n = Eigen::Vector3d::Zero();  ///< force of what lies beyond s on what lies before
  double torque = 0;                            ///< M, about t: the same all along a round rod
  Eigen::Vector3d d = Eigen::Vector3d::Zero();  ///< director across t; zero: none comes along
};

/// Largest of |n| / b, |v|^2 and (M / b)^2, which bend a rod of the section's stiffness b over
/// lengths of one over its root; 0 without states.
[[nodiscard]] double largest_force(const std::vector<RodState>& states, double bending = 1);

/// The tangents of states, 3 x states.
[[nodiscard]] Eigen::Matrix3Xd tangents_of(const std::vector<RodState>& states);

/// A vector across the unit vector t, turned about it.
[[nodiscard]] Eigen::Vector3d turned(const Eigen::Vector3d& d, const Eigen::Vector3d& t,
                                     double angle);

/// Derivatives of a RodState by some parameters, one a column.
struct RodVariation {
  Eigen::Matrix3Xd r;
  Eigen::Matrix3Xd t;
  Eigen::Matrix3Xd v;
  Eigen::Matrix3Xd n;
  Eigen::RowVectorXd torque;
  /// Of d about t, if the twist stays: dd = turn t x d - (d . dt) t. Zero without d.
  Eigen::RowVectorXd turn;

  explicit RodVariation(Eigen::Index parameters = 0);
};

/// Integrals over a piece of the rod.
struct RodIntegrals {
  double bending = 0;  ///< of b |v|^2 / 2
  double gravity = 0;  ///< of -w . r
};

/// Follows the rod's equations over `length`,
///     r' = t,   t' = v,   b v' = -(n - (n.t) t) - b |v|^2 t + M t x v,   n' = -w,   M' = 0,
/// which follow from m' + t x n = 0 with m = b t x v + M t, and their linearisation, with GSL's
/// rk8pd. No angles, so no chart that could end. Along a piece without weight n and b |v|^2/2 + n.t
/// stay. A director d and its derivatives come along,
///     d' = -(d.v) t + M / c t x d,   turn' = v . (t x dt).
/// @param section    of the piece
/// @param tolerance  local error per step, relative to 1 + |component|
/// @param[in,out] state, variation  from the beginning of the piece to its end
/// @param[out] integrals  of the piece
/// @return false if the integrator gave up
[[nodiscard]] bool follow_rod(const RodSection& section, double length, double tolerance,
                              RodState& state, RodVariation& variation, RodIntegrals& integrals);

/// The same without linearisation.
[[nodiscard]] bool follow_rod(const RodSection& section, double length, double tolerance,
                              RodState& state, RodIntegrals& integrals);

}  // namespace dlo::energy_model
