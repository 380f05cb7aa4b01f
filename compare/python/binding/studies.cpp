#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "batch/baseline.hpp"
#include "batch/regression.hpp"
#include "batch/sweep.hpp"
#include "bind_scene.hpp"
#include "dlo/compare/error.hpp"
#include "format/json.hpp"
#include "long_call.hpp"
#include "module.hpp"
#include "motion/scene_modes.hpp"
#include "option/share.hpp"
#include "result.hpp"
#include "series/series_output.hpp"
#include "series/study_output.hpp"
#include "study/benchmark.hpp"
#include "study/hard_case.hpp"
#include "study/stability.hpp"
#include "study/stability_map.hpp"

namespace dlo::python {
namespace {

using compare::CellKind;

/// Column of a sweep's table: its numbers (NaN if empty), or its texts ("" if empty).
struct Column {
  compare::SweepColumn is;
  std::vector<double> numbers = {};
  std::vector<std::string> words = {};

  void add(const compare::SweepCell& cell) {
    const auto* count = std::get_if<std::int64_t>(&cell);
    const auto* number = std::get_if<double>(&cell);
    const auto* text = std::get_if<std::string>(&cell);
    if (is.kind == CellKind::text) {
      words.push_back(text != nullptr ? *text : std::string());
    } else if (count != nullptr) {
      numbers.push_back(static_cast<double>(*count));
    } else {
      numbers.push_back(number != nullptr ? *number : std::numeric_limits<double>::quiet_NaN());
    }
  }

  /// Returns an array: int64 for integers, float64 for numbers, str for text. Requires the GIL.
  [[nodiscard]] py::object array() const {
    if (is.kind == CellKind::text) return py::array(py::cast(words));
    const py::array_t<double> all(static_cast<py::ssize_t>(numbers.size()), numbers.data());
    return is.kind == CellKind::whole ? all.attr("astype")("int64") : py::object(all);
  }
};

/// Largest number of rows of a table, which is stored in memory: about half a gigabyte.
constexpr std::int64_t largest_table = 1'000'000;

/// Varied fields and their values.
using Axes =
    std::vector<std::pair<std::string, std::variant<std::vector<std::string>, std::string>>>;

/// Makes the grid of a sweep. @param fields  for each axis the field, and either its values as a
/// scene file spells them or a range of --vary
compare::Grid grid_of(const Axes& fields) {
  std::vector<compare::Axis> axes;
  for (const auto& [field, values] : fields) {
    if (const auto* text = std::get_if<std::string>(&values)) {
      axes.push_back(compare::parse_axis(field + "=" + *text));
      continue;
    }
    const auto& list = std::get<std::vector<std::string>>(values);
    if (list.empty()) throw compare::InputError(field + ": no values (allowed: one or more)");
    compare::Axis axis{.field = field, .values = list};
    axis.count = static_cast<std::int64_t>(list.size());
    axes.push_back(std::move(axis));
  }
  return compare::Grid(std::move(axes));
}

py::dict sweep(const std::string& text, const std::string& file, const MaterialsFile& materials,
               const Axes& fields, const py::dict& what, const py::dict& limits) {
  const auto model = compare::from_name<compare::SweepModel>(what["model"].cast<std::string>());
  const auto threads = what["threads"].cast<int>();
  const compare::SolveOptions options = verified_options(limits);
  const std::vector<Column> table = run_long([&](Signals& signals) {
    const compare::Sweep sweep(compare::SceneTemplate(text, file, materials_of(materials)),
                               grid_of(fields), model, options);
    if (sweep.grid().size() > largest_table) {
      throw compare::InputError(
          fmt::format("sweep: {} combinations (allowed: {} in a table; more in parts, or by the "
                      "command dlo sweep)",
                      sweep.grid().size(), largest_table));
    }
    std::vector<Column> columns;
    for (const compare::SweepColumn& column : sweep.columns()) columns.push_back({column});
    sweep.run({0, sweep.grid().size()}, threads, [&](const auto& cells) {
      signals.throw_if_stopped();
      for (std::size_t i = 0; i < columns.size(); ++i) columns[i].add(cells.at(i));
    });
    return columns;
  });
  py::dict arrays;
  for (const Column& column : table) arrays[py::str(column.is.name)] = column.array();
  return arrays;
}

AnyResult hard_cases(const std::string& name_contains, const std::vector<std::string>& steppers,
                     std::optional<long> max_steps, int threads) {
  compare::StabilityOptions options;
  options.name_contains = name_contains;
  options.threads = threads;
  if (max_steps) {
    options.max_steps = *max_steps;
    options.max_steps_auto = *max_steps;
    options.steps_at_rest = *max_steps;
  }
  if (!steppers.empty()) options.steppers.clear();
  for (const std::string& name : steppers) {
    options.steppers.push_back(compare::from_name<compare::Stepper>(name));
  }
  return run_long([&](Signals& signals) {
    options.progress = [&signals](auto, auto) { signals.throw_if_stopped(); };
    return std::make_shared<Texts>(cli::hard_cases_document(compare::stability(options)));
  });
}

AnyResult stability_map(const std::optional<SharedScene>& scene, const std::string& axis,
                        int columns, int rows, long steps, int threads) {
  if (axis != "cF-cc" && axis != "cF-ch") compare::refuse_choice(axis, {"cF-cc", "cF-ch"});
  compare::StabilityMapOptions options{
      .axis = axis == "cF-cc" ? compare::MapAxis::c_c : compare::MapAxis::c_h,
      .columns = columns,
      .rows = rows,
      .steps = steps,
      .threads = threads};
  return run_long([&](Signals& signals) {
    options.progress = [&signals](auto, auto) { signals.throw_if_stopped(); };
    return std::make_shared<Texts>(cli::stability_map_document(
        compare::stability_map(scene ? (*scene)->scene : compare::hard_case_scene(), options)));
  });
}

AnyResult bench(const std::vector<SharedScene>& shared, double seconds, int repeats) {
  return run_long([&](Signals& signals) {
    return std::make_shared<Texts>(cli::benchmark_document(
        compare::run_benchmark(scenes_of(shared), {.budget_s = seconds, .repeats = repeats},
                               [&signals](const auto&) { signals.throw_if_stopped(); })));
  });
}

py::object modes(const SharedScene& scene, const py::dict& what, const py::object& make_result,
                 const py::dict& limits) {
  const auto count = what["count"].cast<int>();
  const auto rate = what["rate"].cast<double>();
  const auto damping = what["damping"].cast<double>();
  const auto samples = what["samples"].cast<int>();
  if (count < 1 || !(rate > 0) || !(damping > 0 && damping <= 1) || samples < 2) {
    throw compare::InputError(
        "modes: out of range (allowed: count >= 1, rate > 0, 0 < damping <= 1, samples >= 2)");
  }
  const compare::ModeOptions options{
      .count = count, .rate = rate, .damping = damping, .solve = solve_options(limits)};
  const compare::SceneModes found =
      run_long([&](Signals& /*signals*/) { return compare::scene_modes(scene->scene, options); });
  py::object result = make_result(
      AnyResult(std::make_shared<Texts>(cli::modes_document(found, scene->scene, rate, samples))));
  if (!succeeded(found.status)) {
    raise_convergence(scene->scene.file + ": " + found.message, result);
  }
  return result;
}

/// Compares scenes with a baseline. @param what  model, programs, relative, absolute, tolerance
/// @param make_result  function of a result and JUnit XML
py::object regress(const std::vector<SharedScene>& scenes, const std::string& file, bool update,
                   const py::dict& what, const py::object& make_result, const py::dict& limits) {
  const auto model = what["model"].cast<std::string>();
  if (model != "force" && model != "chain") compare::refuse_choice(model, {"force", "chain"});
  compare::RegressRequest request{.model = compare::from_name<compare::Model>(model),
                                  .programs = compare::parse_foreign_programs(
                                      what["programs"].cast<std::vector<std::string>>()),
                                  .tolerance = {.relative = what["relative"].cast<double>(),
                                                .absolute = what["absolute"].cast<double>()},
                                  .solve = verified_options(limits)};
  if (const auto growth = what["tolerance"].cast<std::optional<std::string>>()) {
    cli::set_growth("tolerance", *growth, request.tolerance);
  }
  bool written = false;
  const compare::Regression found = run_long([&](Signals& signals) {
    // An unreadable baseline is reported before minutes of solving.
    const auto baseline =
        update ? compare::load_baseline_if_exists(file) : compare::load_baseline(file);
    compare::Regression measured = compare::regress(
        scenes_of(scenes), baseline, request, [&](auto, auto) { signals.throw_if_stopped(); });
    written = update && measured.solved();
    if (written) compare::replace_baseline(file, baseline, measured.cases);
    return measured;
  });
  const bool good = update ? found.solved() : found.passes();
  const AnyResult texts =
      std::make_shared<Texts>(written ? cli::baseline_update_text(found.results)
                                      : cli::regression_text(found.results, "text"),
                              cli::json_text(cli::regression_json(found.results, good)));
  py::object result = make_result(texts, compare::junit_xml(found.results));
  if (update && !written) {
    raise_convergence("regress: a scene was not solved, the baseline is left as it was", result);
  }
  return result;
}

}  // namespace

void bind_studies(py::module_& module) {
  module.attr("largest_table") = largest_table;
  module.def("sweep", &sweep);
  module.def("hard_cases", &hard_cases);
  module.def("stability_map", &stability_map);
  module.def("bench", &bench);
  module.def("modes", &modes);
  module.def("regress", &regress);
}

}  // namespace dlo::python
