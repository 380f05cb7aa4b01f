#include <fmt/format.h>
#include <pybind11/stl.h>

#include <string>
#include <utility>
#include <vector>

#include "dlo/compare/error.hpp"
#include "errors.hpp"
#include "long_call.hpp"
#include "module.hpp"
#include "report/folder.hpp"
#include "report/report.hpp"
#include "report/verdict.hpp"

namespace dlo::python {
namespace {

using Names = std::vector<std::string>;

struct Made {
  compare::Report report;
  compare::WrittenReport written;
};

/// A report's calls of its progress come from all of its threads: those of others never stop it.
Made make(const Names& scenes, const std::string& folder, const compare::ReportOptions& options,
          const std::string& call) {
  return run_long([&](Signals& signals) {
    compare::refuse_scenes_inside(folder, scenes);
    compare::check_report_folder(folder);
    Made made;
    made.report = compare::make_report(
        compare::load_scene_files(scenes), options,
        [&signals](const std::string& /*what*/) { signals.throw_if_stopped(); });
    made.written =
        compare::write_report(made.report, {.version = DLO_VERSION, .command = call}, folder);
    return made;
  });
}

/// @param scenes, folder  names  @param call  what Python was asked for
/// @param make_result  of the page's path, verdict, failures, figures that are missing, why,
/// seconds
py::object report(const Names& scenes, const std::string& folder, const py::dict& what,
                  const std::string& call, const py::object& make_result) {
  compare::ReportOptions options =
      what["quick"].cast<bool>() ? compare::quick_report_options() : compare::ReportOptions{};
  options.tolerance = what["tolerance"].cast<double>();
  options.threads = what["threads"].cast<int>();
  if (!(options.tolerance > 0 && options.tolerance < 1) || options.threads < 0 ||
      options.threads > 1024) {
    throw compare::InputError(
        "report: out of range (allowed: 0 < tolerance < 1, threads from 0 to 1024)");
  }
  const Made made = make(scenes, folder, options, call);
  py::object result =
      make_result(made.written.page, compare::report_verdict(made.report), made.report.failures,
                  made.written.figures_missing, made.written.why_missing, made.report.seconds);
  if (!made.report.failures.empty()) {
    raise_convergence(fmt::format("{}: {}", made.written.page, made.report.failures.front()),
                      result);
  }
  return result;
}

}  // namespace

void bind_report(py::module_& module) {
  module.def("report", &report, py::arg("scenes"), py::arg("folder"), py::arg("what"),
             py::arg("call"), py::arg("make_result"));
}

}  // namespace dlo::python
