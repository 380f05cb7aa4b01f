#pragma once

#include <Eigen/Core>

namespace dlo::force_model {

/// What resists twist. It does between two neighbouring grips that hold the rod's frame (Grip::d1);
/// elsewhere the rod rotates about itself freely.
struct Twist {
  double stiffness = 0;  ///< GJ [N m^2], >= 0; > 0 where two grips hold frames
  /// Of the rod at each joint P_1 .. P_{n-1} [N m^2], each > 0; empty: all have `stiffness`.
  Eigen::VectorXd stiffnesses = {};
  /// For each pair of neighbouring grips that hold frames, along the rod, its last twist [rad]:
  /// frames say what it is but for whole turns, and it is the one nearest to this. A Simulation
  /// counts on from step to step. Empty: all 0.
  Eigen::VectorXd angles = {};
};

/// The part of a rod between two segments whose material frames are held.
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
  Eigen::Index first_segment = 0;                       ///< from P_k to P_{k+1}
  Eigen::Index last_segment = 0;                        ///< > first_segment
  Eigen::Vector3d first_d1 = Eigen::Vector3d::UnitX();  ///< its part across the segment counts
  Eigen::Vector3d last_d1 = Eigen::Vector3d::UnitX();   ///< as `first_d1`
  double compliance = 0;                                ///< C [1/(N m)], > 0
  double angle = 0;                                     ///< theta is the branch nearest to it [rad]
};

/// theta [rad]. @param points  of the whole rod [m], 3 x (n+1)
/// @throws std::invalid_argument if the segments do not exist
[[nodiscard]] double twist_angle(const TwistedSpan& span,
                                 const Eigen::Ref<const Eigen::Matrix3Xd>& points);

/// E of (1) [J]. Arguments and errors as above.
[[nodiscard]] double twist_energy(const TwistedSpan& span,
                                  const Eigen::Ref<const Eigen::Matrix3Xd>& points);

/// Adds minus the derivative of E by the points: at each joint three forces along its binormal,
///     P_{i+1}: -M kb / (2 b)    P_{i-1}: M kb / (2 a)    P_i: minus the sum of both
/// Net force is zero, net torque M (t_last - t_first), t the end segments' directions: it balances
/// the couples -M t_last and M t_first with which the rod turns the frames back. A joint that is
/// folded back on itself has no binormal and exerts no force.
/// @param[in,out] forces  added to, not overwritten [N], 3 x (n+1)
/// @throws std::invalid_argument if the segments do not exist or shapes differ
void add_twist_forces(const TwistedSpan& span, const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                      Eigen::Ref<Eigen::Matrix3Xd> forces);

/// Derivative of theta by the points (2), overwritten [rad/m], 3 x (n+1). Errors as above.
void twist_gradient(const TwistedSpan& span, const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                    Eigen::Ref<Eigen::Matrix3Xd> gradient);

/// Bound of what E adds to the stiffness of the fastest mode [N/m]:
///     |grad theta|^2 / C + 8 |M| (1 + tan(alpha/2) + tan^2(alpha/2)) / L^2
/// The first part is exact. The second is of the largest alpha, followed to hooke_fold_angle, and
/// the shortest segment L, no less than a tenth of its rest length. Errors as above.
[[nodiscard]] double twist_mode_bound(const TwistedSpan& span,
                                      const Eigen::Ref<const Eigen::VectorXd>& rest_lengths,
                                      const Eigen::Ref<const Eigen::Matrix3Xd>& points);

}  // namespace dlo::force_model
