#pragma once

#include <Eigen/Core>
#include <optional>

#include "dlo/compare/scene.hpp"
#include "dlo/energy_model/dynamics.hpp"

namespace dlo::compare {

/// Shape and velocities with which a rod with inertia starts.
struct MotionStart {
  energy_model::StartingShape shape;
  energy_model::StartingVelocities velocities;  ///< empty: at rest
  double noise = 0;     ///< standard deviation of a coordinate from the fit of the start [m]
  double duration = 0;  ///< duration of the fitted frames [s]; 0: one frame
};

/// Number of first frames to which smooth_start() fits: the velocity needs several, and the
/// acceleration allows only few.
inline constexpr int start_frames = 11;

/// Fits polynomials of arc length and time to the first frames of a recording, or to its only
/// frame, whose rod is then at rest. The positions and directions of the grippers have so large
/// weights that the polynomials nearly satisfy them.
/// @param scene  its grippers may move
/// @param begin  time at which the rod starts [s]
/// @return std::nullopt if the points of the first frames are too few for a shape: fewer than four
/// including those that grippers hold, or none in an interval longer than half of the rod
[[nodiscard]] std::optional<MotionStart> smooth_start(const Scene& scene, const MarkerMotion& rows,
                                                      double begin);

/// Number of modes by which a start may deviate from another one, for its shape and for its
/// velocities, in each of two directions.
inline constexpr int start_modes = 6;

/// Deviations of a start from a given one, as a vector of modes.
class StartDeviation {
 public:
  /// @param length  of the rod [m];  @param clamped  whether the tangent at s = 0 is known
  StartDeviation(const MotionStart& base, double length, bool clamped);

  [[nodiscard]] static Eigen::Index size() { return 4 * start_modes; }
  /// Returns the start with rotated tangents, and with the velocities of points due to angular
  /// rates of the tangents, both across the tangents. Angles and rates are sums of Legendre's
  /// polynomials of arc length, for a clamped rod without the constant one and minus their values
  /// at s = 0. Noise and duration of the result are not set.
  /// @param modes  angles [rad], start_modes in each of two directions across the rod, then angular
  /// rates [rad/s]
  [[nodiscard]] MotionStart with(const Eigen::VectorXd& modes) const;
  /// Returns estimates of the standard deviations of the modes caused by errors of the base's
  /// points.
  [[nodiscard]] Eigen::VectorXd deviations() const;

 private:
  double length_;
  bool clamped_;
  double noise_, duration_;
  Eigen::Matrix3Xd tangents_, velocities_, d1_, d2_;  // at equal arc lengths
};

}  // namespace dlo::compare
