#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "dlo/compare/scene.hpp"
#include "dlo/energy_model/problem.hpp"

namespace dlo::compare {

/// A part of a scene's motion.
struct MotionPart {
  std::optional<double> from;  ///< [s]; none: the first pose's time
  std::optional<double> to;    ///< [s]; none: the last pose's
};

/// First time of a recording that Scene::start is [s]; none: it is a shape, or there is none.
[[nodiscard]] std::optional<double> recorded_start_time(const Scene& scene);

/// When the frames of a motion are.
class FrameClock {
 public:
  /// @throws InputError if nothing moves, no time passes, or there are too many frames
  FrameClock(const Scene& scene, const MotionPart& part, const TrackRates& rates);

  [[nodiscard]] std::size_t frames() const { return steps_ + 1; }
  [[nodiscard]] double time(std::size_t frame) const;  ///< [s]
  /// When obstacles were moved last [s].
  [[nodiscard]] double obstacle_time(std::size_t frame) const;
  /// As it is then, standing.
  [[nodiscard]] Scene scene(const Scene& scene, std::size_t frame) const;
  /// On the way to a frame from the one before. @param share  of the way, 0 to 1; frame > 0
  [[nodiscard]] Scene scene_before(const Scene& scene, std::size_t frame, double share) const;

 private:
  double begin_ = 0, end_ = 0, rate_ = 0, obstacle_rate_ = 0;
  std::size_t steps_ = 0;
};

/// Those that are in reach at any of the frames.
[[nodiscard]] std::vector<std::size_t> obstacles_ever_in_reach(const Scene& scene,
                                                               const FrameClock& clock);

/// Of the same obstacles in all frames. @throws InputError as energy_problem()
[[nodiscard]] energy_model::Problem frame_problem(const Scene& now,
                                                  const std::vector<std::size_t>& obstacles);

}  // namespace dlo::compare
