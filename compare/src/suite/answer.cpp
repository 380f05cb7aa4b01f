#include "suite/answer.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "dlo/compare/deviation.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/shape.hpp"
#include "dlo/compare/solve.hpp"
#include "parallel/threads.hpp"
#include "record/solution_fields.hpp"
#include "released/hinge_motion.hpp"

namespace dlo::compare {
namespace {

/// Number of points of the chain with which a rod that stretches is compared.
constexpr int fine_chain = 1024;

/// Returns the answers of `certified` to all scenes, in their order, computed on several threads.
template <typename Of>
std::vector<Of> of_each(const std::vector<BatteryScene>& scenes, int threads,
                        const SolveOptions& options,
                        Of (*certified)(const BatteryScene&, const SolveOptions&)) {
  std::vector<Of> answers(scenes.size());
  tbb::task_arena arena(arena_threads(threads));
  execute(arena, [&] {
    tbb::parallel_for(std::size_t{0}, scenes.size(),
                      [&](std::size_t i) { answers[i] = certified(scenes[i], options); });
  });
  return answers;
}

double or_zero(double estimate) { return std::isfinite(estimate) ? estimate : 0; }

double largest_distance(const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b) {
  return std::sqrt((a - b).colwise().squaredNorm().maxCoeff());
}

AnswerBounds bounds_between(const Solution& a, const Solution& b) {
  AnswerBounds bounds;
  bounds.points_m = largest_distance(a.shape.points, b.shape.points) + or_zero(a.error_estimate) +
                    or_zero(b.error_estimate);
  for (std::size_t i = 0; i < a.grippers.size(); ++i) {
    bounds.forces_N.push_back((a.grippers[i].force - b.grippers[i].force).norm());
    bounds.torques_Nm.push_back((a.grippers[i].torque - b.grippers[i].torque).norm());
  }
  for (std::size_t i = 0; i < a.obstacles.size(); ++i) {
    bounds.obstacles_N.push_back((a.obstacles[i] - b.obstacles[i]).norm());
  }
  bounds.energy_J = std::abs(a.energy.total() - b.energy.total());
  return bounds;
}

/// Adds every other equilibrium that the energy model finds to the answer, and sets the smallest
/// eigenvalue of the answer itself.
void look_for_others(Answer& answer, const SolveOptions& options) {
  const std::vector<double>& s = answer.first.shape.arc_length;
  const AllSolutions all = solve_all(answer.of.scene, options, s);
  const double length = answer.of.scene.length;
  const double large = magnitudes(answer.of.scene).energy;
  for (const Solution& one : all.solutions) {
    const double apart = rms(s, one.shape.points - answer.first.shape.points);
    if (apart < methods_agree * length) {
      answer.first.smallest_eigenvalue = one.smallest_eigenvalue;
      continue;
    }
    answer.others.push_back({one.energy.total(), is_stable(one), one.smallest_eigenvalue, apart});
    constexpr double same = 1e-9;
    if (is_stable(one) && one.energy.total() < answer.first.energy.total() - same * large) {
      answer.is_lowest = false;
    }
  }
  std::stable_sort(answer.others.begin(), answer.others.end(),
                   [](const auto& a, const auto& b) { return a.energy_J < b.energy_J; });
}

}  // namespace

Model answer_model(const Scene& scene) {
  return scene.stretch != Stretch::none ? Model::exact : Model::energy;
}

Answer certified_answer(const BatteryScene& scene, const SolveOptions& options) {
  const std::vector<double> s = equal_arc_lengths(scene.scene.length, answer_points);
  Answer answer{.of = scene};
  answer.first = solve(scene.scene, answer_model(scene.scene), options, s);
  if (scene.scene.stretch != Stretch::none) {
    Scene fine = scene.scene;
    fine.force_model.points = fine_chain;
    answer.second = solve(fine, Model::chain, options, s);
    answer.second_method = fmt::format("chain, N = {}", fine_chain);
  } else {
    answer.second = solve(scene.scene, Model::exact, options, s);
    answer.second_method = to_string(Model::exact);
  }
  answer.bounds = bounds_between(answer.first, answer.second);
  const double agree =
      (scene.scene.stretch != Stretch::none ? chain_agrees : methods_agree) * scene.scene.length;
  if (!(answer.bounds.points_m <= agree)) {
    throw ConvergenceError(fmt::format("{}: {} and {} are {:.3g} m apart (allowed: {:.3g} m)",
                                       scene.id, to_string(answer.first.model),
                                       answer.second_method, answer.bounds.points_m, agree));
  }
  if (scene.scene.stretch == Stretch::none) look_for_others(answer, options);
  return answer;
}

std::vector<Answer> certified_answers(const std::vector<BatteryScene>& scenes, int threads,
                                      const SolveOptions& options) {
  return of_each(scenes, threads, options, certified_answer);
}

namespace {

/// Terms of the energy model, and of a second run that measures the truncation error.
constexpr int fine_terms = 16;
constexpr int fewer_terms = 12;
/// Number of segments of the coarsest chain: its points are the motion_points.
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
  return of_each(scenes, threads, options, certified_motion);
}

}  // namespace dlo::compare
