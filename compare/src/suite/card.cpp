#include "suite/card.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <mutex>
#include <optional>
#include <utility>

#include "dlo/compare/deviation.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/reference.hpp"
#include "dlo/compare/shape_verdict.hpp"
#include "foreign/foreign_program.hpp"
#include "parallel/threads.hpp"
#include "shape/curve.hpp"
#include "suite/answer.hpp"
#include "suite/cause.hpp"

namespace dlo::compare {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

/// Runs a simulator with N, 2N and 4N points, up to the first run that is not supported.
/// @param measure  called with each solved run; sets its error, or throws InputError
CardScene run_scene(const BatteryScene& scene, const Simulator& simulator,
                    const CardOptions& options, const std::function<void(SimulatorRun&)>& measure) {
  CardScene result{.id = scene.id, .group = scene.group, .order = none};
  for (const int factor : {1, 2, 4}) {
    SimulatorRun& run =
        result.runs.emplace_back(stored_or_new_run(options.state, options.version, simulator, scene,
                                                   factor * options.points, options.time_limit));
    try {
      if (run.status == RunStatus::solved) measure(run);
    } catch (const InputError& error) {
      run.status = RunStatus::failed;
      run.problem = error.what();
    }
    run.shape.reset();
    run.motion.reset();
    // If a scene is not supported, further runs with more points are skipped.
    if (run.status == RunStatus::not_supported) break;
  }
  return result;
}

CardScene card_scene(const BatteryScene& scene, const energy_model::Equilibrium& reference,
                     const Simulator& simulator, const CardOptions& options) {
  std::vector<CardShape> shapes;
  CardScene result = run_scene(scene, simulator, options, [&](SimulatorRun& run) {
    const bool has_arc_lengths = !run.shape->arc_length.empty();
    Shape shape = aligned_by_grippers(*run.shape, scene.scene,
                                      has_arc_lengths ? ArcLengths::file : ArcLengths::chord);
    require_held_ends(scene.scene, shape, has_arc_lengths);
    run.error = shape_deviation(scene.scene, shape, reference.sample).rms_over_length;
    shapes.push_back({.points = run.points, .shape = std::move(shape), .error = run.error});
  });
  result.order = convergence_order(shapes);
  if (!shapes.empty()) result.causes = causes_of(scene.scene, reference, shapes);
  return result;
}

/// Order of convergence from which, and error up to which, no cause is searched for a motion: it
/// converges with about second order, or its error is at most 1e-3 (motion_error()).
constexpr double converging_order = 1.5;
constexpr double negligible_motion_error = 1e-3;

CardScene card_motion(const BatteryScene& scene, const MotionReference& reference,
                      const Simulator& simulator, const CardOptions& options) {
  std::vector<CardShape> errors;
  std::optional<MarkerMotion> finest;
  CardScene result = run_scene(scene, simulator, options, [&](SimulatorRun& run) {
    run.error = motion_error(reference, *run.motion);
    errors.push_back({.points = run.points, .shape = {}, .error = run.error});
    finest = std::move(run.motion);
  });
  result.order = convergence_order(errors);
  if (!finest || result.order >= converging_order || errors.back().error <= negligible_motion_error)
    return result;
  result.causes = motion_causes(reference, *finest);
  return result;
}

void add_scene(CardGroup& group, const CardScene& scene) {
  ++group.scenes;
  const RunStatus status = scene.status();
  ++(status == RunStatus::solved          ? group.solved
     : status == RunStatus::not_supported ? group.not_supported
     : status == RunStatus::not_judged    ? group.not_judged
                                          : group.failed);
  if (scene.is_correct()) ++group.right;
  for (const SimulatorRun& run : scene.runs) group.seconds += run.seconds;
  for (const Cause& cause : scene.causes) {
    const auto known = std::find_if(group.causes.begin(), group.causes.end(),
                                    [&](const auto& one) { return one.first == cause.name; });
    if (known == group.causes.end()) {
      group.causes.emplace_back(cause.name, 1);
    } else {
      ++known->second;
    }
  }
  if (status != RunStatus::solved) return;
  for (std::size_t i = 0; i < group.largest.size(); ++i) {
    group.largest[i] = std::fmax(group.largest[i], scene.runs[i].error);
  }
  group.order = std::fmin(group.order, scene.order);
}

/// Renames causes. A single shape that has not come to rest may resemble that of a stiffer rod, but
/// several such shapes give different stiffnesses. If a simulator is not at rest in some scenes and
/// has different apparent stiffnesses in others, it is not at rest in these either.
void join_causes(Card& card) {
  constexpr const char* stiffness = "bending stiffness wrong";
  constexpr const char* imbalance_name = "not at rest";
  constexpr double tolerance = 0.1;
  double least = std::numeric_limits<double>::infinity();
  double most = 0;
  bool rests = true;
  for (const CardScene& scene : card.scenes) {
    for (const Cause& cause : scene.causes) {
      if (cause.name == imbalance_name) rests = false;
      if (cause.name != stiffness) continue;
      least = std::min(least, cause.factor);
      most = std::max(most, cause.factor);
    }
  }
  if (rests || most <= least * (1 + tolerance)) return;
  for (CardScene& scene : card.scenes) {
    for (Cause& cause : scene.causes) {
      if (cause.name != stiffness) continue;
      cause.words += fmt::format(", but in other scenes {:.3g} to {:.3g} times", least, most);
      cause.name = imbalance_name;
      cause.factor = none;
    }
  }
}

/// Solves the reference of a scene. @return a function that computes the results of a simulator
std::function<CardScene(const Simulator&)> scene_judge(const BatteryScene& scene,
                                                       const CardOptions& options) {
  try {
    if (scene.motion) {
      return [&, reference = motion_reference(scene)](const Simulator& simulator) {
        return card_motion(scene, reference, simulator, options);
      };
    }
    return [&, reference = solve_reference(scene.scene, answer_model(scene.scene), {})](
               const Simulator& simulator) {
      return card_scene(scene, reference, simulator, options);
    };
  } catch (const ConvergenceError& error) {
    return [&, problem = std::string(error.what())](const Simulator&) -> CardScene {
      return {
          .id = scene.id,
          .group = scene.group,
          .runs = {{.points = options.points, .status = RunStatus::not_judged, .problem = problem}},
          .order = none};
    };
  }
}

}  // namespace

RunStatus CardScene::status() const {
  for (const SimulatorRun& run : runs) {
    if (run.status != RunStatus::solved) return run.status;
  }
  return RunStatus::solved;
}

std::string CardScene::problem() const {
  for (const SimulatorRun& run : runs) {
    if (run.status != RunStatus::solved) return run.problem;
  }
  return {};
}

bool CardScene::is_correct() const {
  return status() == RunStatus::solved && runs.back().error <= default_tolerance(1).allowed_m &&
         std::none_of(causes.begin(), causes.end(),
                      [](const Cause& cause) { return cause.defect; });
}

std::vector<CardGroup> Card::groups() const {
  std::vector<CardGroup> groups;
  for (const CardScene& scene : scenes) {
    auto group = std::find_if(groups.begin(), groups.end(),
                              [&](const CardGroup& one) { return one.name == scene.group; });
    if (group == groups.end()) {
      groups.push_back({.name = scene.group,
                        .largest = std::vector<double>(points.size(), none),
                        .order = none});
      group = groups.end() - 1;
    }
    add_scene(*group, scene);
  }
  return groups;
}

CardGroup Card::total() const {
  CardGroup total{.largest = std::vector<double>(points.size(), none), .order = none};
  for (const CardScene& scene : scenes) add_scene(total, scene);
  return total;
}

std::vector<Card> make_cards(const std::string& battery_version,
                             const std::vector<BatteryScene>& scenes,
                             const std::vector<Simulator>& simulators, const CardOptions& options) {
  std::vector<Card> cards;
  cards.reserve(simulators.size());
  for (const Simulator& simulator : simulators) {
    cards.push_back({.simulator = simulator.name,
                     .battery_version = battery_version,
                     .points = {options.points, 2 * options.points, 4 * options.points},
                     .scenes = std::vector<CardScene>(scenes.size())});
  }
  const auto all = static_cast<std::int64_t>(scenes.size() * simulators.size());
  std::int64_t done = 0;
  std::mutex output_mutex;
  tbb::task_arena arena(arena_threads(options.threads));
  execute(arena, [&] {
    tbb::parallel_for(std::size_t{0}, scenes.size(), [&](std::size_t i) {
      const auto card_of = scene_judge(scenes[i], options);
      for (std::size_t k = 0; k < simulators.size(); ++k) {
        cards[k].scenes[i] = card_of(simulators[k]);
        if (!options.progress) continue;
        const std::lock_guard lock(output_mutex);
        options.progress(++done, all);
      }
    });
  });
  for (Card& card : cards) join_causes(card);
  return cards;
}

}  // namespace dlo::compare
