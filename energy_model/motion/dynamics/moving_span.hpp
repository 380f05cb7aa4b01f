#pragma once

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/deadline.hpp"
#include "dlo/energy_model/dynamics.hpp"
#include "dynamics/span_integrator.hpp"
#include "problem/split.hpp"
#include "search/assemble.hpp"

namespace dlo::energy_model {

/// Results of one span at one time, in SI units.
struct SpanFrame {
  EnergyBalance energy;
  /// Reactions, each with the index of its grip.
  std::vector<std::pair<std::size_t, Reaction>> grips;
  /// Forces, each with the index of its obstacle.
  std::vector<std::pair<std::size_t, Eigen::Vector3d>> obstacles;
  PlacedShape shape;
};

/// Results of one run of a span.
struct SpanRun {
  std::vector<SpanFrame> frames;  ///< at the begin and at the times that were reached
  SolveStatus status = SolveStatus::failed;
  std::string message;
  bool left_plane = false;  ///< whether the motion would move a planar span out of its plane
  long steps = 0;
  double smallest_step = std::numeric_limits<double>::infinity();  ///< smallest time step [s]
  double error = 0;  ///< error estimate of the integrator, divided by the rod length
  double depth = 0;  ///< largest depth within rigid obstacles [m]
};

/// Begin of a span's motion, and the times of its frames.
struct SpanMotion {
  double begin = 0;                      ///< start time [s]
  const StartingShape& start;            ///< shape at the begin
  const std::vector<PointMass>& masses;  ///< point masses that no other span carries
  std::span<const double> times;         ///< times of the frames [s]
};

/// Simulates a span between moving clamps.
/// @param rod  Problem::grips are at their positions at the begin, and each has a motion
[[nodiscard]] SpanRun run_span(const MovingRod& rod, const PlacedSpan& placed,
                               const SpanMotion& motion, const DynamicsOptions& options,
                               const Deadline& deadline);

}  // namespace dlo::energy_model
