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

#include "base/number.hpp"
#include "base/quote.hpp"
#include "base/text.hpp"
#include "dlo/compare/comparison.hpp"
#include "dlo/compare/deviation.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/reference.hpp"
#include "dlo/compare/solution.hpp"
#include "dlo/compare/solve.hpp"
#include "parallel/threads.hpp"

namespace dlo::compare {
namespace {

/// Number of finished rows per thread that may wait for a slower row before them.
constexpr std::size_t rows_per_thread = 256;

bool compares(SweepModel model) {
  return model == SweepModel::compare || model == SweepModel::compare_chain;
}

CellKind kind_of(const Axis& axis) {
  if (axis.spacing != Spacing::list) return CellKind::number;
  const bool numbers = std::all_of(axis.values.begin(), axis.values.end(), [](const auto& value) {
    return as_number<double>(value).has_value();
  });
  return numbers ? CellKind::number : CellKind::text;
}

SweepCell field_cell(CellKind kind, const std::string& value) {
  if (kind == CellKind::text) return value;
  return as_number<double>(value).value();
}

SweepCell cell_of(const Json& value) {
  if (value.is_number_integer()) return value.get<std::int64_t>();
  if (value.is_number()) return value.get<double>();
  if (value.is_string()) return value.get<std::string>();
  return {};
}

struct CsvCell {
  std::string operator()(std::monostate /*none*/) const { return ""; }
  std::string operator()(std::int64_t count) const { return fmt::format("{}", count); }
  std::string operator()(double number) const { return csv_number(number); }
  std::string operator()(const std::string& text) const { return csv_field(text); }
};

Model solver_of(SweepModel model) {
  // In the order of SweepModel.
  constexpr Model models[] = {Model::energy, Model::chain, Model::exact,
                              Model::force,  Model::force, Model::chain};
  return models[static_cast<std::size_t>(model)];
}

}  // namespace

Sweep::Sweep(SceneTemplate scene, Grid grid, SweepModel model, const SolveOptions& options)
    : scene_(std::move(scene)), grid_(std::move(grid)), model_(model), options_(options) {
  for (const Axis& axis : grid_.axes()) {
    gamma_varied_ = gamma_varied_ || axis.field == "gamma";
    kinds_.push_back(kind_of(axis));
  }
  require_one_scene();
}

void Sweep::require_one_scene() {
  constexpr std::int64_t most_tries = 1000;
  const std::int64_t tries = std::min(grid_.size(), most_tries);
  // The step has no common divisor with the grid's size, so it returns to its start only after all
  // rows. For a large grid it is close to the golden section, so that few tries are spread evenly.
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
  std::vector<SceneField> values;
  for (std::size_t i = 0; i < indices.size(); ++i) {
    values.push_back({grid_.axes()[i].field, grid_.axes()[i].value(indices[i])});
  }
  return scene_.with(values);
}

std::vector<SweepColumn> Sweep::result_columns() const {
  const Model model = solver_of(model_);
  std::vector<SweepColumn> columns;
  if (!gamma_varied_) columns.push_back({"gamma"});
  for (const char* name : {"tip_x_m", "tip_y_m", "tip_z_m", "energy_J"}) columns.push_back({name});
  columns.push_back({model == Model::force ? "steps" : "evaluations"});
  if (model == Model::energy || model == Model::exact) columns.push_back({"terms"});
  if (compares(model_)) {
    for (const char* name : {"rms_over_length", "max_over_length", "tip_over_length",
                             "effective_modulus_ratio", "rms_at_effective_modulus_over_length"}) {
      columns.push_back({name});
    }
    columns.push_back({"optimum", CellKind::text});
    columns.push_back({"energy_evaluations"});
  }
  for (const Field<SolvedShape>& number : numbers_) columns.push_back({number.key()});
  columns.push_back({"status", CellKind::text});
  return columns;
}

std::vector<SweepColumn> Sweep::columns() const {
  std::vector<SweepColumn> columns = {{"row", CellKind::whole}};
  for (std::size_t i = 0; i < kinds_.size(); ++i) {
    columns.push_back({grid_.axes()[i].column(), kinds_[i]});
  }
  for (SweepColumn& column : result_columns()) columns.push_back(std::move(column));
  return columns;
}

std::string Sweep::header() const {
  std::string line;
  for (const SweepColumn& column : columns()) {
    line += (line.empty() ? "" : ",") + csv_field(column.name);
  }
  return line + "\n";
}

std::vector<SweepCell> Sweep::solved(const Scene& scene) const {
  const Model model = solver_of(model_);
  // A comparison and shape_numbers() need all points, the tip needs only the end of the rod.
  const bool is_whole = compares(model_) || !numbers_.empty();
  const std::vector<double> samples = is_whole ? std::vector<double>{} : std::vector{scene.length};
  const Solution solution = solve(scene, model, options_, samples);
  std::vector<SweepCell> cells;
  if (!gamma_varied_) cells.emplace_back(scene.gamma());
  const Eigen::Vector3d tip = solution.shape.points.rightCols<1>();
  for (const double number : {tip.x(), tip.y(), tip.z(), solution.energy.total()}) {
    cells.emplace_back(number);
  }
  const bool stepped = model == Model::force;
  cells.emplace_back(std::int64_t{stepped ? solution.steps : solution.evaluations});
  if (model == Model::energy || model == Model::exact) {
    cells.emplace_back(std::int64_t{solution.terms});
  }
  if (compares(model_)) compare_to_energy(scene, solution, cells);
  for (const Field<SolvedShape>& number : numbers_) {
    cells.push_back(cell_of(value_of(number, {scene, solution})));
  }
  return cells;
}

void Sweep::compare_to_energy(const Scene& scene, const Solution& solution,
                              std::vector<SweepCell>& cells) const {
  const energy_model::Equilibrium energy = solve_reference(scene, options_);
  const Deviation d = shape_deviation(scene, solution.shape, energy.sample);
  const EffectiveModulus modulus =
      fit_effective_modulus(scene, distance_from(solution.shape), energy, options_);
  for (const double number : {d.rms_over_length, d.max_m / scene.length, d.tip_m / scene.length,
                              modulus.ratio, modulus.rms_m / scene.length}) {
    cells.emplace_back(number);
  }
  cells.emplace_back(std::string(to_string(modulus.optimum)));
  cells.emplace_back(std::int64_t{energy.evaluations});
}

std::vector<SweepCell> Sweep::cells_with_status(const std::string& status) const {
  std::vector<SweepCell> cells(result_columns().size());
  cells.back() = display(status);
  return cells;
}

std::vector<SweepCell> Sweep::results(std::int64_t row) const {
  try {
    std::vector<SweepCell> cells = solved(scene(row));
    cells.emplace_back(std::string("ok"));
    return cells;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::system_error&) {
    throw;  // no threads available: a failure of the machine, not of the scene
  } catch (const ResultError& error) {
    return cells_with_status(error.what());
  } catch (const std::invalid_argument& error) {
    return cells_with_status(error.what());
  } catch (const std::exception& error) {
    return cells_with_status(std::string("internal error: ") + error.what());
  }
}

std::vector<SweepCell> Sweep::cells(std::int64_t row) const {
  std::vector<SweepCell> cells = {row};
  const std::vector<std::int64_t> indices = grid_.indices(row);
  for (std::size_t i = 0; i < indices.size(); ++i) {
    cells.push_back(field_cell(kinds_[i], grid_.axes()[i].number(indices[i])));
  }
  for (SweepCell& cell : results(row)) cells.push_back(std::move(cell));
  return cells;
}

std::string Sweep::line(const std::vector<SweepCell>& cells) const {
  const auto row = std::get<std::int64_t>(cells.front());
  const std::vector<std::int64_t> indices = grid_.indices(row);
  std::string line = fmt::format("{}", row);
  for (std::size_t i = 0; i < indices.size(); ++i) {
    line += "," + csv_field(grid_.axes()[i].number(indices[i]));
  }
  for (std::size_t i = 1 + indices.size(); i < cells.size(); ++i) {
    line += "," + std::visit(CsvCell(), cells[i]);
  }
  return line + "\n";
}

void Sweep::run(RowRange rows, int threads,
                const std::function<void(const std::vector<SweepCell>& cells)>& take) const {
  using Row = std::vector<SweepCell>;
  const int workers = threads > 0 ? threads : tbb::info::default_concurrency();
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(workers));
  tbb::task_arena arena(workers);
  const std::size_t window = rows_per_thread * static_cast<std::size_t>(workers);
  std::int64_t next = rows.first;
  const auto next_row = [&](tbb::flow_control& control) {
    const std::int64_t row = next;
    if (row >= rows.last) control.stop();
    next += rows.step;
    return row;
  };
  execute(arena, [&] {
    tbb::parallel_pipeline(
        window,
        tbb::make_filter<void, std::int64_t>(tbb::filter_mode::serial_in_order, next_row) &
            tbb::make_filter<std::int64_t, Row>(tbb::filter_mode::parallel,
                                                [this](std::int64_t row) { return cells(row); }) &
            tbb::make_filter<Row, void>(tbb::filter_mode::serial_in_order, take));
  });
}

}  // namespace dlo::compare
