#include <pybind11/stl.h>

#include <string>
#include <vector>

#include "batch/baseline.hpp"
#include "batch/regression_run.hpp"
#include "bind_scene.hpp"
#include "errors.hpp"
#include "format/json.hpp"
#include "format/regression_output.hpp"
#include "long_call.hpp"
#include "module.hpp"
#include "option/share.hpp"
#include "solve_options.hpp"

namespace dlo::python {
namespace {

/// @param what  model, programs, relative, absolute, tolerance  @param make_result  of text, JSON,
/// JUnit XML
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
    // An unreadable baseline is told before minutes of solving.
    const auto baseline = update ? compare::present_baseline(file) : compare::load_baseline(file);
    compare::Regression measured = compare::regress(
        scenes_of(scenes), baseline, request, [&](auto, auto) { signals.throw_if_stopped(); });
    written = update && measured.solved();
    if (written) compare::replace_baseline(file, baseline, measured.cases);
    return measured;
  });
  const bool good = update ? found.solved() : found.passes();
  py::object result = make_result(written ? cli::baseline_update_text(found.results)
                                          : cli::regression_text(found.results, "text"),
                                  cli::json_text(cli::regression_json(found.results, good)),
                                  compare::junit_xml(found.results));
  if (update && !written) {
    raise_convergence("regress: a scene was not solved, the baseline is left as it was", result);
  }
  return result;
}

}  // namespace

void bind_regress(py::module_& module) { module.def("regress", &regress); }

}  // namespace dlo::python
