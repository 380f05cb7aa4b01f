#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "dlo/compare/scene.hpp"
#include "dlo/energy_model/problem.hpp"

namespace dlo::compare {

/// An interval of a scene's motion.
struct MotionPart {
  /// [s]; empty: first time of a recorded start, else time of the first pose, 0 if nothing moves.
  std::optional<double> from;
  std::optional<double> to;  ///< [s]; empty: time of the last pose
};

/// Returns the first time of the recording in Scene::start [s]; std::nullopt if the start is a
/// shape, or if there is none.
[[nodiscard]] std::optional<double> recorded_start_time(const Scene& scene);

/// Times of the frames of a motion.
class FrameClock {
 public:
  /// @throws InputError if nothing moves (unless the scene has a start and `to` is given), no time
  /// passes, or there are too many frames
  FrameClock(const Scene& scene, const MotionPart& part, const TrackRates& rates);

  [[nodiscard]] std::size_t frames() const { return steps_ + 1; }
  [[nodiscard]] double time(std::size_t frame) const;  ///< time of a frame [s]
  /// Returns the time of the last update of the obstacles up to the time of a frame [s].
  [[nodiscard]] double obstacle_time(std::size_t frame) const;
  /// Returns the scene at the time of a frame, with grippers and obstacles at rest.
  [[nodiscard]] Scene scene(const Scene& scene, std::size_t frame) const;
  /// Returns the scene between a frame and the one before.
  /// @param frame  > 0
  /// @param share  fraction of the interval, 0 to 1
  [[nodiscard]] Scene scene_before(const Scene& scene, std::size_t frame, double share) const;

 private:
  double begin_ = 0, end_ = 0, rate_ = 0, obstacle_rate_ = 0;
  std::size_t steps_ = 0;
};

/// Returns the indices of the obstacles that are in reach in any frame.
[[nodiscard]] std::vector<std::size_t> obstacles_ever_in_reach(const Scene& scene,
                                                               const FrameClock& clock);

/// Returns the problem of a frame with the given obstacles, which are the same in all frames.
/// @throws InputError in the cases of energy_problem(), and for loads without a potential
[[nodiscard]] energy_model::Problem frame_problem(const Scene& now,
                                                  const std::vector<std::size_t>& obstacles);

}  // namespace dlo::compare
