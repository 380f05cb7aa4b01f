#pragma once

#include <Eigen/Core>

namespace dlo::force_model {

/// Torsional stiffness and twist angles. They are used between two neighbouring grips that hold the
/// rod's frame (Grip::d1); elsewhere the rod can rotate about its tangent freely.
struct Twist {
  double stiffness = 0;  ///< GJ [N m^2], >= 0; > 0 where two grips hold frames
  /// GJ of the rod at each joint P_1 .. P_{n-1} [N m^2], > 0 between grips that hold frames; empty:
  /// `stiffness` everywhere.
  Eigen::VectorXd stiffnesses = {};
  /// Last twist angle between each pair of neighbouring grips that hold frames, along the rod
  /// [rad]. The frames determine the angle up to full rotations; the value nearest to this one is
  /// used. A Simulation updates it in each step. Empty: all 0.
  Eigen::VectorXd angles = {};
};

/// Part of a rod between two segments whose material frames are held.
///
/// The twist theta is the angle about the last segment's direction from the first d1, transported
/// along the polygon without twist (from segment to segment by the shortest turn), to the last d1,
/// in the branch nearest to `angle`. A round rod's twisting moment is the same all along,
///     E = theta^2 / (2 C),   M = theta / C,   C = int ds / GJ                              (1)
/// With the curvature binormal kb = 2 u x v / (1 + u.v) of a joint between segments a u and b v,
///     d theta = sum over joints  kb . (da / a + db / b) / 2                                (2)
/// where held frames come along with their segments without rotating about them (Bergou et al.,
/// Discrete elastic rods, SIGGRAPH 2008, with the sign of theta instead of the transported
/// frame's).
struct TwistedSpan {
  Eigen::Index first_segment = 0;  ///< index k of the segment from P_k to P_{k+1}
  Eigen::Index last_segment = 0;   ///< > first_segment
  /// Only its component across the segment is used.
  Eigen::Vector3d first_d1 = Eigen::Vector3d::UnitX();
  /// Only its component across the segment is used.
  Eigen::Vector3d last_d1 = Eigen::Vector3d::UnitX();
  double compliance = 0;  ///< C [1/(N m)], > 0
  double angle = 0;       ///< theta is the branch nearest to it [rad]
};

/// Returns theta [rad]. @param points  points of the whole rod [m], 3 x (n+1)
/// @throws std::invalid_argument if the segments do not exist or the compliance is not > 0
[[nodiscard]] double twist_angle(const TwistedSpan& span,
                                 const Eigen::Ref<const Eigen::Matrix3Xd>& points);

/// Returns E of (1) [J]. Arguments and errors as for twist_angle.
[[nodiscard]] double twist_energy(const TwistedSpan& span,
                                  const Eigen::Ref<const Eigen::Matrix3Xd>& points);

/// Adds minus the derivative of E by the points: at each joint three forces along its binormal,
///     P_{i+1}: -M kb / (2 b)    P_{i-1}: M kb / (2 a)    P_i: minus the sum of both
/// Net force is zero, net torque M (t_last - t_first), t the end segments' directions: it balances
/// the couples -M t_last and M t_first with which the rod turns the frames back. A joint that is
/// folded back on itself, or next to a segment of zero length, has no binormal and exerts no force.
/// @param[in,out] forces  added to, not overwritten [N], 3 x (n+1)
/// @throws std::invalid_argument as twist_angle, or if shapes differ
void add_twist_forces(const TwistedSpan& span, const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                      Eigen::Ref<Eigen::Matrix3Xd> forces);

/// Computes the derivative of theta by the points (2), overwritten [rad/m], 3 x (n+1). Errors as
/// for add_twist_forces.
void twist_gradient(const TwistedSpan& span, const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                    Eigen::Ref<Eigen::Matrix3Xd> gradient);

/// Returns a bound of the contribution of E to the stiffness of the fastest mode [N/m]:
///     |grad theta|^2 / C + 8 |M| (1 + tan(alpha/2) + tan^2(alpha/2)) / L^2
/// The first term is exact. The second uses the largest alpha, at most hooke_fold_angle, and the
/// shortest segment L, at least a tenth of its rest length. Errors as for add_twist_forces.
[[nodiscard]] double twist_mode_bound(const TwistedSpan& span,
                                      const Eigen::Ref<const Eigen::VectorXd>& rest_lengths,
                                      const Eigen::Ref<const Eigen::Matrix3Xd>& points);

}  // namespace dlo::force_model
