#include "suite/motion_answer.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>

#include "dlo/compare/error.hpp"
#include "dlo/compare/shape.hpp"
#include "parallel/threads.hpp"
#include "released/hinge_motion.hpp"
#include "released/released_rod.hpp"

namespace dlo::compare {
namespace {

/// Terms of the energy model, and of a run that shows what those left out change.
constexpr int fine_terms = 16;
constexpr int fewer_terms = 12;
/// Of the coarsest chain: what motion_points lie on.
constexpr int segments = motion_points - 1;

}  // namespace

MotionAnswer certified_motion(const BatteryScene& scene, const SolveOptions& options) {
  const double length = scene.scene.length;
  const ReleasedRod rod{scene.scene, scene.motion.value().begin};
  MotionAnswer answer{.of = scene,
                      .times = scene.motion->times(),
                      .arc_length = equal_arc_lengths(length, motion_points)};
  ReleasedMotion fine = release_rod(rod, answer.times, answer.arc_length, fine_terms, options);
  const ReleasedMotion coarse =
      release_rod(rod, answer.times, answer.arc_length, fewer_terms, options);
  const HingeLimit hinges = hinge_limit(rod, segments, answer.times, options);
  answer.frames = std::move(fine.frames);
  answer.second_method =
      fmt::format("hinges, N = {}, {} and {}, extrapolated", segments, 2 * segments, 4 * segments);
  answer.points_bound_m = largest_distance(answer.frames, hinges.frames) + hinges.error +
                          largest_distance(answer.frames, coarse.frames) + fine.step_error * length;
  const double agree = motions_agree * length;
  if (!(answer.points_bound_m <= agree)) {
    throw ConvergenceError(fmt::format("{}: energy and {} are {:.3g} m apart (allowed: {:.3g} m)",
                                       scene.id, answer.second_method, answer.points_bound_m,
                                       agree));
  }
  return answer;
}

std::vector<MotionAnswer> certified_motions(const std::vector<BatteryScene>& scenes, int threads,
                                            const SolveOptions& options) {
  std::vector<MotionAnswer> answers(scenes.size());
  tbb::task_arena arena(arena_threads(threads));
  execute(arena, [&] {
    tbb::parallel_for(std::size_t{0}, scenes.size(),
                      [&](std::size_t i) { answers[i] = certified_motion(scenes[i], options); });
  });
  return answers;
}

}  // namespace dlo::compare
