#include <fmt/format.h>
#include <pybind11/stl.h>

#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/quote.hpp"
#include "base/timer.hpp"
#include "batch/baseline.hpp"
#include "bind_scene.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/shape_file.hpp"
#include "foreign/foreign_program.hpp"
#include "format/json.hpp"
#include "long_call.hpp"
#include "module.hpp"
#include "result.hpp"
#include "series/study_output.hpp"
#include "suite/card.hpp"

namespace dlo::python {
namespace {

using compare::RunStatus;
using compare::SimulatorRun;

std::string one_line(const std::string& text) { return text.substr(0, text.find('\n')); }

/// Python function as a simulator. Only one call is made at a time, from any thread, because the
/// function need not be thread-safe.
class PythonSimulator {
 public:
  /// @param function  receives a scene's text, its file and the number of points; returns points,
  /// and arc lengths or None
  explicit PythonSimulator(py::object function) : function_(std::move(function)) {}

  [[nodiscard]] SimulatorRun run(const compare::Scene& scene, int points) {
    const std::string text = compare::builtin_scene_text(scene);
    const std::scoped_lock one_call(calling_);
    const py::gil_scoped_acquire python;
    const compare::Timer timer;
    SimulatorRun result = called(text, scene.file, points);
    result.seconds = timer.seconds();
    return result;
  }

 private:
  SimulatorRun called(const std::string& text, const std::string& file, int points) {
    SimulatorRun result;
    try {
      const auto made = function_(text, file, points).cast<std::pair<py::object, py::object>>();
      result.shape = measured_shape(made.first, made.second, "points");
      result.status = RunStatus::solved;
    } catch (py::error_already_set& error) {
      // An exception that is no Exception, such as KeyboardInterrupt, ends the call.
      if (!error.matches(PyExc_Exception)) throw;
      if (error.matches(PyExc_NotImplementedError)) result.status = RunStatus::not_supported;
      result.problem = one_line(error.what());
    } catch (const compare::InputError& error) {
      result.problem = error.what();
    }
    return result;
  }

  py::object function_;
  std::mutex calling_;
};

/// Reads the options of a results table. @throws compare::InputError if a value is out of range
compare::CardOptions card_options(const py::dict& what, const std::string& name) {
  compare::CardOptions options{.points = what["points"].cast<int>(),
                               .threads = what["threads"].cast<int>(),
                               .time_limit = what["time_limit"].cast<double>(),
                               .state = what["state"].cast<std::string>(),
                               .version = DLO_VERSION};
  if (options.points < 4 || options.points > 10000 || options.threads < 0 ||
      options.threads > 1024 || !(options.time_limit > 0)) {
    throw compare::InputError(
        "suite: out of range (allowed: points from 4 to 10000, threads from 0 to 1024, time_limit "
        "> 0)");
  }
  if (!options.state.empty() && !compare::is_program_name(name)) {
    throw compare::InputError(
        fmt::format("suite: name = {}: no folder of state (allowed: letters, digits and _.-+)",
                    compare::quoted_piece(name)));
  }
  return options;
}

/// Baseline with the tolerance of an error's growth.
struct Gate {
  std::string file;
  bool update;
  std::vector<compare::BaselineCase> baseline;
  compare::RegressionTolerance tolerance;
};

/// Reads the baseline and its tolerance; std::nullopt if no baseline is named.
/// @throws compare::InputError if a tolerance is out of range, or naming the baseline's file
std::optional<Gate> gate_of(const py::dict& what) {
  const auto file = what["baseline"].cast<std::string>();
  if (file.empty()) return std::nullopt;
  const compare::RegressionTolerance tolerance{.relative = what["relative"].cast<double>(),
                                               .absolute = what["absolute"].cast<double>()};
  if (!(tolerance.relative >= 0) || !(tolerance.absolute >= 0)) {
    throw compare::InputError("suite: out of range (allowed: relative and absolute >= 0)");
  }
  const bool update = what["update"].cast<bool>();
  return Gate{file, update,
              update ? compare::load_baseline_if_exists(file) : compare::load_baseline(file),
              tolerance};
}

/// Runs the benchmark set with a function.
/// @param what  scenes, points, threads, time_limit, state, baseline, update, relative, absolute
/// @param make_result  function of a result, Markdown, JUnit XML, HTML, changes, and whether it
/// passes
py::object suite(const py::object& function, const std::string& name, const py::dict& what,
                 const py::object& make_result) {
  compare::CardOptions options = card_options(what, name);
  // An unreadable baseline is reported before minutes of runs.
  const std::optional<Gate> gate = gate_of(what);
  PythonSimulator python(function);
  const compare::Simulator simulator{.name = name,
                                     .own = std::nullopt,
                                     .program = {},
                                     .function = [&](const compare::Scene& scene, int points) {
                                       return python.run(scene, points);
                                     }};
  const compare::Battery& battery = compare::builtin_battery();
  const auto scenes =
      compare::chosen_scenes(battery, what["scenes"].cast<std::vector<std::string>>());
  const std::vector<compare::Card> cards = run_long([&](Signals& signals) {
    options.progress = [&signals](auto, auto) { signals.throw_if_stopped(); };
    return compare::make_cards(battery.version, scenes, {simulator}, options);
  });
  std::string text = cli::cards_text(cards);
  std::optional<std::string> changed;
  std::optional<bool> passes;
  if (gate) {
    const compare::Regression found = compare::judge_cards(gate->baseline, cards, gate->tolerance);
    passes = gate->update ? found.solved() : found.passes();
    const bool written = gate->update && *passes;
    if (written) compare::replace_baseline(gate->file, gate->baseline, found.cases);
    changed =
        written ? gate->file + " written\n" : cli::regression_changes_text(found.results, "text");
    text += "\n" + *changed;
  }
  const AnyResult texts = std::make_shared<Texts>(text, cli::json_text(compare::cards_json(cards)));
  return make_result(texts, cli::cards_markdown(cards), cli::cards_junit(cards),
                     compare::page_html({cli::card_page(cards.front())}, "dlo suite", DLO_VERSION),
                     changed, passes);
}

}  // namespace

void bind_suite(py::module_& module) { module.def("suite", &suite); }

}  // namespace dlo::python
