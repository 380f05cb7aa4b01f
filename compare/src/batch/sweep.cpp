#include "batch/sweep.hpp"

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <new>
#include <numeric>
#include <stdexcept>
#include <system_error>

#include "base/display.hpp"
#include "base/fingerprint.hpp"
#include "base/quote.hpp"
#include "dlo/compare/comparison.hpp"
#include "dlo/compare/deviation.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/reference.hpp"
#include "dlo/compare/solution.hpp"
#include "dlo/compare/solve.hpp"
#include "parallel/threads.hpp"

namespace dlo::compare {
namespace {

/// So many rows may wait for a slow one before them.
constexpr std::size_t rows_per_thread = 256;

std::string model_columns(SweepModel model) {
  std::string columns = "tip_x_m,tip_y_m,tip_z_m,energy_J,";
  switch (model) {
    case SweepModel::energy:
    case SweepModel::exact:
      return columns + "evaluations,terms,";
    case SweepModel::chain:
      return columns + "evaluations,";
    case SweepModel::force:
      return columns + "steps,";
    case SweepModel::compare:
      columns += "steps,";
      break;
    case SweepModel::compare_chain:
      columns += "evaluations,";
      break;
  }
  return columns +
         "rms_over_length,max_over_length,tip_over_length,effective_modulus_ratio,"
         "rms_at_effective_modulus_over_length,optimum,energy_evaluations,";
}

std::string tip_and_energy(const Solution& solution) {
  const Eigen::Vector3d tip = solution.shape.points.rightCols<1>();
  return fmt::format("{},{},{},{},", csv_number(tip.x()), csv_number(tip.y()), csv_number(tip.z()),
                     csv_number(solution.energy.total()));
}

Model solver_of(SweepModel model) {
  switch (model) {
    case SweepModel::chain:
    case SweepModel::compare_chain:
      return Model::chain;
    case SweepModel::exact:
      return Model::exact;
    case SweepModel::force:
    case SweepModel::compare:
      return Model::force;
    case SweepModel::energy:
      break;
  }
  return Model::energy;
}

}  // namespace

Sweep::Sweep(SceneTemplate scene, Grid grid, SweepModel model, const SolveOptions& options)
    : scene_(std::move(scene)), grid_(std::move(grid)), model_(model), options_(options) {
  for (const Axis& axis : grid_.axes()) gamma_varied_ = gamma_varied_ || axis.field == "gamma";
  require_one_scene();
}

void Sweep::require_one_scene() {
  constexpr std::int64_t most_tries = 1000;
  const std::int64_t tries = std::min(grid_.size(), most_tries);
  // A step near the golden section of the grid that has no divisor in common with it visits every
  // part of it before it comes back.
  std::int64_t step = std::max<std::int64_t>(1, grid_.size() / 1000 * 618);
  while (std::gcd(step, grid_.size()) != 1) ++step;
  std::string first_problem;
  std::int64_t row = 0;
  for (std::int64_t i = 0; i < tries; ++i, row = (row + step) % grid_.size()) {
    try {
      numbers_ = fields_in(in_csv, shape_numbers(), scene(row));
      return;
    } catch (const InputError& error) {
      if (first_problem.empty()) first_problem = error.what();
    }
  }
  throw InputError(fmt::format("{} (none of {} scenes of the grid can be read, this is the first)",
                               first_problem, tries));
}

Scene Sweep::scene(std::int64_t row) const {
  const std::vector<std::int64_t> indices = grid_.indices(row);
  std::vector<FieldValue> values;
  for (std::size_t i = 0; i < indices.size(); ++i) {
    values.push_back({grid_.axes()[i].field, grid_.axes()[i].value(indices[i])});
  }
  return scene_.with(values);
}

std::string Sweep::identity() const {
  std::string grid;
  for (const Axis& axis : grid_.axes()) {
    grid += fmt::format("{} {} {} {} {} {} {}\n", axis.field, static_cast<int>(axis.spacing),
                        axis.first, axis.last, axis.unit, axis.count, fmt::join(axis.values, ","));
  }
  const std::string options = fmt::format("{} {} {} {}", options_.terms, options_.max_evaluations,
                                          options_.max_steps, options_.rest_tolerance);
  return fmt::format("scene {}, grid {}, model {}, options {}", scene_.fingerprint(),
                     fingerprint(grid), to_string(model_), fingerprint(options));
}

std::string Sweep::header() const {
  std::string line = "row,";
  for (const Axis& axis : grid_.axes()) line += csv_field(axis.column()) + ",";
  if (!gamma_varied_) line += "gamma,";
  return line + result_columns() + "status\n";
}

std::string Sweep::result_columns() const {
  std::string columns = model_columns(model_);
  for (const Field<SolvedShape>& number : numbers_) columns += number.key() + ",";
  return columns;
}

std::string Sweep::row_start(std::int64_t row) const {
  const std::vector<std::int64_t> indices = grid_.indices(row);
  std::string line = fmt::format("{},", row);
  for (std::size_t i = 0; i < indices.size(); ++i) {
    line += csv_field(grid_.axes()[i].number(indices[i])) + ",";
  }
  return line;
}

std::string Sweep::results(const Scene& scene) const {
  const bool comparing = model_ == SweepModel::compare || model_ == SweepModel::compare_chain;
  const Model model = solver_of(model_);
  // A comparison and numbers of a shape need all points, a tip does not.
  const bool is_whole = comparing || !numbers_.empty();
  const Solution solution =
      solve(scene, model, options_, is_whole ? std::vector<double>{} : std::vector{scene.length});
  std::string line = gamma_varied_ ? "" : csv_number(scene.gamma()) + ",";
  line += tip_and_energy(solution);
  line += fmt::format("{},", model == Model::force ? solution.steps : solution.evaluations);
  if (model == Model::energy || model == Model::exact) line += fmt::format("{},", solution.terms);
  if (comparing) line += compared(scene, solution);
  for (const Field<SolvedShape>& number : numbers_) {
    line += csv_value(value_of(number, {scene, solution})) + ",";
  }
  return line;
}

std::string Sweep::compared(const Scene& scene, const Solution& solution) const {
  const energy_model::Equilibrium energy = solve_reference(scene, Model::energy, options_);
  const Deviation d = shape_deviation(scene, solution.shape, energy.sample);
  const EffectiveModulus modulus =
      fit_effective_modulus(scene, distance_from(solution.shape), energy, options_);
  return fmt::format("{},{},{},{},{},{},{},", csv_number(d.rms_over_length),
                     csv_number(d.max_m / scene.length), csv_number(d.tip_m / scene.length),
                     csv_number(modulus.ratio), csv_number(modulus.rms_m / scene.length),
                     to_string(modulus.optimum), energy.evaluations);
}

std::string Sweep::without_results(const std::string& status) const {
  const std::string columns = (gamma_varied_ ? "" : "gamma,") + result_columns();
  const auto empty = static_cast<std::size_t>(std::count(columns.begin(), columns.end(), ','));
  return std::string(empty, ',') + csv_field(display(status)) + "\n";
}

std::string Sweep::row(std::int64_t row) const {
  const std::string start = row_start(row);
  try {
    return start + results(scene(row)) + "ok\n";
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::system_error&) {
    throw;  // no threads: the machine's, not the scene's
  } catch (const InputError& error) {
    return start + without_results(error.what());
  } catch (const ConvergenceError& error) {
    return start + without_results(error.what());
  } catch (const std::invalid_argument& error) {
    return start + without_results(error.what());
  } catch (const std::exception& error) {
    return start + without_results(std::string("internal error: ") + error.what());
  }
}

void Sweep::run(RowRange rows, int threads,
                const std::function<void(const std::string& line)>& take) const {
  const int workers = threads > 0 ? threads : tbb::info::default_concurrency();
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(workers));
  tbb::task_arena arena(workers);
  const std::size_t window = rows_per_thread * static_cast<std::size_t>(workers);
  std::int64_t next = rows.first;
  const auto next_row = [&](tbb::flow_control& control) {
    if (next == rows.last) control.stop();
    return next++;
  };
  const auto compute = [this](std::int64_t number) { return row(number); };
  execute(arena, [&] {
    tbb::parallel_pipeline(
        window,
        tbb::make_filter<void, std::int64_t>(tbb::filter_mode::serial_in_order, next_row) &
            tbb::make_filter<std::int64_t, std::string>(tbb::filter_mode::parallel, compute) &
            tbb::make_filter<std::string, void>(tbb::filter_mode::serial_in_order, take));
  });
}

}  // namespace dlo::compare
