#include <fmt/format.h>
#include <pybind11/stl.h>

#include <cstddef>
#include <optional>
#include <utility>

#include "base/input_file.hpp"
#include "base/text.hpp"
#include "bind_scene.hpp"
#include "dlo/compare/check.hpp"
#include "dlo/compare/comparison.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/force_model_fit.hpp"
#include "dlo/compare/material_fit.hpp"
#include "dlo/compare/result_text.hpp"
#include "dlo/compare/shape_file.hpp"
#include "format/json.hpp"
#include "format/result_output.hpp"
#include "long_call.hpp"
#include "module.hpp"
#include "option/share.hpp"
#include "picture/figures.hpp"
#include "result.hpp"

namespace dlo::python {
namespace {

struct Check : Result {
  explicit Check(compare::CheckResult found) : result(std::move(found)) {}

  [[nodiscard]] std::string text() const override { return compare::to_text(result); }
  [[nodiscard]] std::string json() const override { return compare::to_json(result); }
  [[nodiscard]] compare::Drawing drawing() const override {
    return compare::check_drawing(result.scene, result.check);
  }

  compare::CheckResult result;
};

/// Comparison with its scene, which its picture needs.
struct Comparison : Result {
  Comparison(compare::Comparison found, SharedScene from)
      : result(std::move(found)), of(std::move(from)) {}

  [[nodiscard]] std::string text() const override {
    return (result.plan ? cli::plan_text(*result.plan, of->scene) : "") + compare::to_text(result);
  }
  [[nodiscard]] std::string json() const override { return compare::to_json(result); }
  [[nodiscard]] compare::Drawing drawing() const override {
    return compare::comparison_drawing(of->scene, result);
  }

  compare::Comparison result;
  SharedScene of;
};

AnyResult check(const SharedScene& scene, const py::object& points, const py::object& arc_length,
                const py::dict& what, const py::dict& limits) {
  const compare::MeasuredShape shape = measured_shape(points, arc_length, "points");
  compare::CheckRequest request{
      .explaining =
          what["explain"].cast<bool>() ? compare::Explaining::yes : compare::Explaining::no,
      .shape = {
          .pose = compare::from_name<compare::PoseFreedom>(what["register"].cast<std::string>()),
          .arc_lengths =
              compare::from_name<compare::ArcLengths>(what["arc_lengths"].cast<std::string>()),
          .modulus = what["modulus"].cast<bool>() ? compare::ModulusSearch::yes
                                                  : compare::ModulusSearch::no,
          .solve = verified_options(limits)}};
  request.tolerance = cli::shape_tolerance(
      "tolerance",
      {what["tolerance"].cast<std::optional<std::string>>(), what["measure"].cast<std::string>(),
       what["min_seen"].cast<std::optional<double>>()},
      scene->scene.length);
  return std::make_shared<Check>(
      run_long([&](Signals& /*signals*/) { return compare::check(scene->scene, shape, request); }));
}

/// @param make_result  function of a result
py::object compare_scene(const SharedScene& scene, bool modulus, bool plan,
                         const py::object& make_result, const py::dict& limits) {
  const compare::SolveOptions options = solve_options(limits);
  compare::Comparison found = run_long([&](Signals& /*signals*/) {
    return compare::compare(scene->scene, options,
                            plan ? std::optional(compare::PlanOptions{}) : std::nullopt,
                            modulus ? compare::ModulusSearch::yes : compare::ModulusSearch::no);
  });
  const std::string unverified = found.unverified;
  py::object comparison =
      make_result(AnyResult(std::make_shared<Comparison>(std::move(found), scene)));
  if (!unverified.empty()) {
    raise_convergence(fmt::format("{}: the energy model: {}", scene->scene.file, unverified),
                      comparison);
  }
  return comparison;
}

using FitDocuments = std::pair<AnyResult, std::string>;  // text and JSON, TOML

/// Reads shapes. @param pairs  points or a file's name, and arc lengths;  @param name  name of the
/// argument
std::vector<compare::MeasuredShape> shapes_of(const py::list& pairs, const char* name) {
  std::vector<compare::MeasuredShape> shapes;
  for (const py::handle& entry : pairs) {
    const auto pair = entry.cast<py::tuple>();
    const bool file = py::isinstance<py::bytes>(pair[0]);
    shapes.push_back(measured_shape(pair[0], pair[1],
                                    file ? compare::valid_utf8(pair[0].cast<std::string>())
                                         : fmt::format("{}[{}]", name, shapes.size())));
  }
  return shapes;
}

FitDocuments calibrate_material(const std::vector<SharedScene>& scenes, const py::list& shapes,
                                const py::dict& what, const py::dict& limits) {
  const std::vector<compare::MeasuredShape> measured_shapes = shapes_of(shapes, "shapes");
  const std::vector<compare::MeasuredShape> held_out =
      shapes_of(what["holdout"].cast<py::list>(), "holdout");
  const auto chosen = what["options"].cast<std::optional<std::string>>();
  if (chosen && *chosen != "given" && *chosen != "auto") {
    throw compare::InputError(
        fmt::format("calibrate: options = '{}': unknown (allowed: given, auto)", *chosen));
  }
  const compare::MaterialFitOptions options{
      .pose = compare::from_name<compare::PoseFreedom>(what["register"].cast<std::string>()),
      .arc_lengths =
          compare::from_name<compare::ArcLengths>(what["arc_lengths"].cast<std::string>()),
      .density = what["density"].cast<bool>(),
      .torsional_stiffness = what["torsional_stiffness"].cast<bool>(),
      .natural_curvature_terms = what["natural_curvature"].cast<int>(),
      .direction_tolerance = what["clamp_angles"].cast<double>(),
      .position_tolerance = what["clamp_positions"].cast<double>(),
      .roll_tolerance = what["clamp_rolls"].cast<double>(),
      .shared_clamps = what["same_clamps"].cast<bool>(),
      .direction_scatter = what["clamp_scatter"].cast<double>(),
      .camera_tilt = what["camera_tilt"].cast<double>(),
      .predict = what["predict"].cast<bool>(),
      .choose_options = chosen ? std::optional(*chosen == "auto") : std::nullopt,
      .chain_segments = what["segments"].cast<int>(),
      .chain_segment_lengths =
          what["segment_lengths"].cast<std::optional<std::vector<double>>>().value_or(
              std::vector<double>{}),
      .noise = what["noise"].cast<std::optional<double>>(),
      .solve = verified_options(limits)};
  const compare::Calibration found = run_long([&](Signals& /*signals*/) {
    return compare::calibrate(scenes_of(scenes), measured_shapes, options, held_out);
  });
  std::string toml;
  try {
    toml = cli::material_toml(found);
  } catch (const compare::InputError&) {
    // The rest of the fit is useful without the document.
  }
  return {std::make_shared<Texts>(compare::to_text(found), compare::to_json(found)),
          std::move(toml)};
}

FitDocuments calibrate_force_model(const std::vector<SharedScene>& scenes,
                                   const std::vector<SharedScene>& holdouts,
                                   std::optional<int> points, std::optional<double> target,
                                   const py::dict& limits) {
  compare::ForceModelFitOptions options;
  options.points = points;
  options.target = target.value_or(options.target);
  options.solve = verified_options(limits);
  const compare::ForceModelFit fit = run_long([&](Signals& signals) {
    options.progress = [&signals](auto, auto) { signals.throw_if_stopped(); };
    return compare::fit_force_model(scenes_of(scenes), scenes_of(holdouts), options);
  });
  return {std::make_shared<Texts>(cli::force_model_document(fit, target.has_value())),
          cli::force_model_toml(fit)};
}

}  // namespace

void bind_judge(py::module_& module) {
  module.def("check", &check)
      .def("compare", &compare_scene)
      .def("calibrate_material", &calibrate_material)
      .def("calibrate_force_model", &calibrate_force_model);
}

}  // namespace dlo::python
