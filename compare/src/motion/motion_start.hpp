#pragma once

#include <Eigen/Core>
#include <optional>

#include "dlo/compare/scene.hpp"
#include "dlo/energy_model/dynamics.hpp"

namespace dlo::compare {

/// Shape and velocities with which a rod with inertia starts.
struct MotionStart {
  energy_model::StartingShape shape;
  energy_model::StartingVelocities velocities;
  double noise = 0;     ///< standard deviation of a coordinate from a fit of the start [m]
  double duration = 0;  ///< of the frames that were fitted [s]; 0: one frame
};

/// Number of first frames through which smooth_start() fits a recording: the velocity needs
/// several, the acceleration keeps them few.
inline constexpr int start_frames = 11;

/// Fits polynomials of arc length and time to the first frames of a recording, or to the only one,
/// whose rod is then at rest. The grippers hold the polynomials where and how they are.
/// @param scene  whose grippers may move
/// @param begin  time at which the rod starts [s]
/// @return none if the markers of the first frame are too few for a shape: fewer than four with
/// those that grippers hold, or an interval of half of the rod has none
[[nodiscard]] std::optional<MotionStart> smooth_start(const Scene& scene, const MarkerMotion& rows,
                                                      double begin);

/// Modes by which a start may deviate from another one, for its shape and for its velocities each.
inline constexpr int start_modes = 6;

/// A start and the numbers of another one nearby.
class StartDeviation {
 public:
  /// @param length  of the rod [m];  @param clamped  whether the tangent at s = 0 is known
  StartDeviation(const MotionStart& base, double length, bool clamped);

  [[nodiscard]] static Eigen::Index size() { return 4 * start_modes; }
  /// Returns the start whose tangents are rotated by angles, and whose points have velocities by
  /// angular rates, across the tangents: sums of Legendre's polynomials of arc length.
  /// @param modes  angles [rad] across the rod, start_modes in each of two directions, then angular
  /// rates [rad/s]
  [[nodiscard]] MotionStart with(const Eigen::VectorXd& modes) const;
  /// Returns upper estimates of the standard deviations of the modes, as errors of the base's
  /// points cause them.
  [[nodiscard]] Eigen::VectorXd deviations() const;

 private:
  double length_;
  bool clamped_;
  double noise_, duration_;
  Eigen::Matrix3Xd tangents_, velocities_, d1_, d2_;  // at equal arc lengths
};

}  // namespace dlo::compare
