#include "study/stability_map.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

#include "base/progress_counter.hpp"
#include "dlo/compare/deviation.hpp"
#include "dlo/compare/discretise.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/force_model/batch.hpp"
#include "dlo/force_model/simulation.hpp"
#include "parallel/threads.hpp"
#include "polygon/point_layout.hpp"

namespace dlo::compare {
namespace {

constexpr double disturbance = 1e-6;  // RMS over the points, divided by the length
// Growth factor of a disturbance from which a rod is unstable.
constexpr double unstable_growth = 100;
constexpr long map_samples = 16;  // samples of each rod
constexpr int bisections = 12;

/// Rod at rest with its predicted limits.
struct RodAtRest {
  force_model::Rod rod;
  Eigen::Matrix3Xd points;
  MapColumn column;
};

/// Returns value `index` of a geometric sequence of `count` values from `first` to `last`.
double geometric(double first, double last, int index, int count) {
  if (count == 1) return first;
  return first * std::pow(last / first, static_cast<double>(index) / (count - 1));
}

/// Returns the force model's own rest shape. With unequal segments the paper's law has a rest shape
/// that differs from the chain's minimum.
Eigen::Matrix3Xd rest_points(const Scene& scene, const Discretisation& discretisation) {
  const std::string name = fmt::format("{}, c_c = {:.4g} N", scene.file, discretisation.rod.c_c);
  const energy_model::PolygonResult chain =
      polygon_at_rest(name, discretisation.rod, discretisation.starts.front());
  force_model::Simulation simulation(discretisation.rod, chain.points, {});
  const force_model::RelaxResult rest = simulation.relax({.tolerance = 1e-9});
  if (rest.status != force_model::RelaxStatus::at_rest) {
    throw ConvergenceError(fmt::format("{}: no rest shape for the map: {}", name, rest.message));
  }
  return simulation.points();
}

RodAtRest at_rest(const Scene& scene, double c_c, double c_h) {
  ForceModelSettings settings = scene.force_model;
  settings.c_c = c_c;
  const Discretisation discretisation = discretise(scene, settings);
  RodAtRest result{discretisation.rod, rest_points(scene, discretisation), {}};
  MapColumn& column = result.column;
  column.c_c = discretisation.rod.c_c;
  column.c_h = c_h;
  column.fastest_mode = force_model::mode_bounds(result.rod, result.points).fastest;
  column.predicted = force_model::largest_step_factor(column.fastest_mode, c_h);
  column.table_1 = table_1_step_share * discretisation.parameters.segment_length / (2 * column.c_c);
  return result;
}

std::vector<RodAtRest> rods_of(const Scene& scene, const StabilityMapOptions& options) {
  const Discretisation nominal = discretise(scene, scene.force_model);
  const double L = nominal.parameters.segment_length;
  std::vector<RodAtRest> rods;
  for (int i = 0; i < options.columns; ++i) {
    if (options.axis == MapAxis::c_c) {
      const double softest = scene.bending_stiffness() / (L * L);
      rods.push_back(
          at_rest(scene, geometric(softest, scene.axial_stiffness(), i, options.columns), 0));
    } else {
      constexpr double largest = 0.99;
      const double c_h = options.columns == 1 ? 0 : largest * i / (options.columns - 1);
      rods.push_back(at_rest(scene, nominal.rod.c_c, c_h));
    }
  }
  return rods;
}

Eigen::Matrix3Xd disturbed(const RodAtRest& rest) {
  std::mt19937 engine(1);
  Eigen::Matrix3Xd movement(3, rest.points.cols());
  for (double& x : movement.reshaped()) x = static_cast<double>(engine()) / 2147483648.0 - 1;
  // Natural joint angles have a sign only in the plane of the rod, so the disturbance stays in it.
  if (rest.rod.bending.natural_turns.size() > 0) movement.row(2).setZero();
  const double rms = movement.norm() / std::sqrt(static_cast<double>(movement.cols()));
  return rest.points + disturbance * rest.rod.length() / rms * movement;
}

/// Simulates rods, each with its c_F, and classifies whether they are stable.
class Trials {
 public:
  Trials(const std::vector<RodAtRest>& rods, const StabilityMapOptions& options)
      : rods_(rods),
        options_(options),
        arena_(arena_threads(options.threads)),
        counter_(options.progress, blocks_of(rods.size() * static_cast<std::size_t>(options.rows)) +
                                       bisections * blocks_of(rods.size())) {}

  /// Returns the outcome of each trial. @param which  index of each trial's rod; @param c_F  of
  /// each trial [m/N]
  std::vector<Outcome> run(const std::vector<std::size_t>& which, const std::vector<double>& c_F) {
    std::vector<force_model::BatchRod> starts;
    starts.reserve(which.size());
    for (std::size_t i = 0; i < which.size(); ++i) {
      const RodAtRest& rest = rods_[which[i]];
      force_model::StepOptions step;
      step.policy = {.momentum = true};
      step.c_F = c_F[i];
      step.c_h = rest.column.c_h;
      starts.push_back({rest.rod, disturbed(rest), step});
    }
    force_model::Batch batch(starts);
    std::vector<Outcome> outcomes(which.size(), Outcome::pass);
    const auto run_block = [&](std::size_t block) {
      const std::size_t first = block * force_model::Batch::rods_per_block;
      const std::size_t end = std::min(first + force_model::Batch::rods_per_block, which.size());
      for (long sample = 0; sample < map_samples; ++sample) {
        batch.step_block(block, std::max(1L, options_.steps / map_samples));
        for (std::size_t i = first; i < end; ++i) {
          if (outcomes[i] == Outcome::diverges) continue;
          const Outcome outcome =
              classify_rest(rods_[which[i]], batch.points(i), batch.diverged(i));
          if (outcome != Outcome::pass) outcomes[i] = outcome;
        }
      }
      counter_.add_one();
    };
    execute(arena_, [&] { tbb::parallel_for(std::size_t{0}, batch.blocks(), run_block); });
    return outcomes;
  }

 private:
  static std::int64_t blocks_of(std::size_t rods) {
    constexpr std::size_t block = force_model::Batch::rods_per_block;
    return static_cast<std::int64_t>((rods + block - 1) / block);
  }

  static Outcome classify_rest(const RodAtRest& rest, const Eigen::Matrix3Xd& points,
                               bool diverged) {
    constexpr double divergence_distance = 10;  // lengths
    const double length = rest.rod.length();
    const double distance =
        (points - rest.points).norm() / std::sqrt(static_cast<double>(points.cols()));  // RMS
    if (diverged || !(distance < divergence_distance * length)) return Outcome::diverges;
    return distance > unstable_growth * disturbance * length ? Outcome::oscillates : Outcome::pass;
  }

  const std::vector<RodAtRest>& rods_;
  const StabilityMapOptions& options_;
  tbb::task_arena arena_;
  ProgressCounter counter_;
};

void run_grid(const std::vector<RodAtRest>& rods, const StabilityMapOptions& options,
              Trials& trials, StabilityMap& map) {
  const auto by_prediction = [](const RodAtRest& a, const RodAtRest& b) {
    return a.column.predicted < b.column.predicted;
  };
  const auto [smallest, largest] = std::minmax_element(rods.begin(), rods.end(), by_prediction);
  std::vector<std::size_t> which;
  std::vector<double> c_F;
  for (std::size_t column = 0; column < rods.size(); ++column) {
    for (int row = 0; row < options.rows; ++row) {
      which.push_back(column);
      c_F.push_back(geometric(smallest->column.predicted / 4, largest->column.predicted * 4, row,
                              options.rows));
    }
  }
  const std::vector<Outcome> outcomes = trials.run(which, c_F);
  for (std::size_t i = 0; i < which.size(); ++i) {
    const MapColumn& column = rods[which[i]].column;
    map.points.push_back({column.c_c, column.c_h, c_F[i], outcomes[i]});
  }
}

/// Returns the limit of each column, by bisection between the last stable and the first unstable
/// c_F of its grid; NaN if the grid does not bracket it.
std::vector<double> measured_limits(const StabilityMap& map, std::size_t columns, Trials& trials) {
  const std::size_t rows = map.points.size() / columns;
  std::vector<double> stable(columns, std::numeric_limits<double>::quiet_NaN());
  std::vector<double> unstable = stable;
  std::vector<std::size_t> which(columns, 0);
  for (std::size_t column = 0; column < columns; ++column) {
    which[column] = column;
    const auto first = map.points.begin() + static_cast<std::ptrdiff_t>(column * rows);
    const auto last = first + static_cast<std::ptrdiff_t>(rows);
    const auto limit = std::find_if(
        first, last, [](const MapPoint& point) { return point.outcome != Outcome::pass; });
    // Without a bracket the limit differs from its prediction by at least a factor of four.
    if (limit == first || limit == last) continue;
    unstable[column] = limit->c_F;
    stable[column] = (limit - 1)->c_F;
  }
  for (int i = 0; i < bisections; ++i) {
    std::vector<double> middle(columns, 0);
    for (std::size_t k = 0; k < columns; ++k) {
      middle[k] =
          std::isnan(stable[k]) ? map.points[k * rows].c_F : std::sqrt(stable[k] * unstable[k]);
    }
    const std::vector<Outcome> outcomes = trials.run(which, middle);
    for (std::size_t k = 0; k < columns; ++k) {
      if (std::isnan(stable[k])) continue;
      (outcomes[k] == Outcome::pass ? stable : unstable)[k] = middle[k];
    }
  }
  return stable;
}

}  // namespace

StabilityMap stability_map(const Scene& scene, const StabilityMapOptions& options) {
  if (options.columns < 1 || options.rows < 2 || options.steps < 1 || options.threads < 0) {
    throw std::invalid_argument(fmt::format(
        "stability_map: columns = {} (allowed: >= 1), rows = {} (>= 2), steps = {} (>= 1), "
        "threads = {} (>= 0)",
        options.columns, options.rows, options.steps, options.threads));
  }
  const std::vector<RodAtRest> rods = rods_of(scene, options);
  StabilityMap map{.scene = scene.name, .axis = options.axis};
  Trials trials(rods, options);
  run_grid(rods, options, trials, map);
  const std::vector<double> limits = measured_limits(map, rods.size(), trials);
  for (std::size_t k = 0; k < rods.size(); ++k) {
    map.columns.push_back(rods[k].column);
    map.columns.back().measured = limits[k];
  }
  return map;
}

}  // namespace dlo::compare
