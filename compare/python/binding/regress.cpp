#include <pybind11/stl.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "batch/regression.hpp"
#include "dlo/compare/error.hpp"
#include "errors.hpp"
#include "format/json.hpp"
#include "format/regression.hpp"
#include "long_call.hpp"
#include "module.hpp"
#include "scene.hpp"
#include "solve_options.hpp"

namespace dlo::python {
namespace {

using compare::MeasuredCase;
using compare::RegressionResult;

/// What is measured of every scene.
struct Measured {
  compare::Model model;
  std::vector<compare::ForeignProgram> programs;
  compare::SolveOptions solve;
};

/// A case without errors where a solver does not converge. @param measure  gives one with
template <typename Measure>
MeasuredCase solved(compare::BaselineCase entry, const Measure& measure) {
  try {
    return measure();
  } catch (const compare::ConvergenceError& error) {
    return {std::move(entry), error.what()};
  }
}

std::vector<MeasuredCase> measure_all(const std::vector<SharedScene>& scenes, const Measured& what,
                                      Signals& signals) {
  std::vector<MeasuredCase> measured;
  for (const SharedScene& shared : scenes) {
    const compare::Scene& scene = shared->scene;
    measured.push_back(solved(compare::case_of(scene, what.model), [&] {
      return MeasuredCase{compare::measure_case(scene, what.model, what.solve), ""};
    }));
    for (const compare::ForeignProgram& program : what.programs) {
      signals.throw_if_stopped();
      compare::BaselineCase entry = compare::case_of(scene, compare::Model::force);
      entry.program = program.name;
      measured.push_back(solved(
          std::move(entry), [&] { return compare::measure_program(scene, program, what.solve); }));
    }
    signals.throw_if_stopped();
  }
  return measured;
}

bool is_good(const std::vector<RegressionResult>& results) {
  return std::none_of(results.begin(), results.end(), [](const RegressionResult& result) {
    return compare::failed(result.verdict);
  });
}

bool is_solved(const std::vector<RegressionResult>& results) {
  return std::none_of(results.begin(), results.end(), [](const RegressionResult& result) {
    return result.verdict == compare::RegressionVerdict::not_solved;
  });
}

void write(const std::string& file, const std::vector<compare::BaselineCase>& read,
           const std::vector<MeasuredCase>& measured) {
  std::vector<compare::BaselineCase> cases;
  cases.reserve(measured.size());
  for (const MeasuredCase& entry : measured) cases.push_back(entry.entry);
  compare::replace_baseline(file, read, cases);
}

/// @param what  model, programs, relative, absolute  @param make_result  of text, JSON, JUnit XML
py::object regress(const std::vector<SharedScene>& scenes, const std::string& file, bool update,
                   const py::dict& what, const py::object& make_result, const py::dict& limits) {
  const auto model = what["model"].cast<std::string>();
  if (model != "force" && model != "chain") compare::refuse_choice(model, {"force", "chain"});
  Measured measured{
      compare::from_name<compare::Model>(model),
      compare::parse_foreign_programs(what["programs"].cast<std::vector<std::string>>()),
      solve_options(limits)};
  measured.solve.accept_unverified = false;
  const compare::RegressionTolerance tolerance{.relative = what["relative"].cast<double>(),
                                               .absolute = what["absolute"].cast<double>()};
  bool written = false;
  const std::vector<RegressionResult> results = run_long([&](Signals& signals) {
    // An unreadable baseline is told before minutes of solving.
    const auto read = update ? compare::present_baseline(file) : compare::load_baseline(file);
    const std::vector<MeasuredCase> cases = measure_all(scenes, measured, signals);
    std::vector<RegressionResult> judged = compare::judge_regression(read, cases, tolerance);
    written = update && is_solved(judged);
    if (written) write(file, read, cases);
    return judged;
  });
  const bool good = update ? is_solved(results) : is_good(results);
  py::object result = make_result(
      written ? cli::baseline_update_text(results) : cli::regression_text(results, "text"),
      cli::json_text(cli::regression_json(results, good)), compare::junit_xml(results));
  if (update && !written) {
    raise_convergence("regress: a scene was not solved, the baseline is left as it was", result);
  }
  return result;
}

}  // namespace

void bind_regress(py::module_& module) {
  module.def("regress", &regress, py::arg("scenes"), py::arg("file"), py::arg("update"),
             py::arg("what"), py::arg("make_result"), py::arg("limits"));
}

}  // namespace dlo::python
