#include <fmt/format.h>
#include <pybind11/stl.h>

#include <cstddef>
#include <optional>
#include <utility>

#include "array.hpp"
#include "base/display.hpp"
#include "base/input_file.hpp"
#include "bind_scene.hpp"
#include "dlo/compare/check.hpp"
#include "dlo/compare/comparison.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/force_model_fit.hpp"
#include "dlo/compare/material_fit.hpp"
#include "dlo/compare/result_text.hpp"
#include "dlo/compare/shape_file.hpp"
#include "errors.hpp"
#include "fields.hpp"
#include "format/force_model_fit_output.hpp"
#include "format/json.hpp"
#include "format/material_fit_output.hpp"
#include "format/plan_output.hpp"
#include "long_call.hpp"
#include "module.hpp"
#include "option/share.hpp"
#include "picture.hpp"
#include "picture/check_figure.hpp"
#include "picture/comparison_figure.hpp"
#include "record/solution_fields.hpp"
#include "result.hpp"
#include "solve_options.hpp"

namespace dlo::python {
namespace {

using compare::CheckResult;

/// With the scene, for its picture.
struct Comparison : compare::Comparison {
  SharedScene of;
};

std::shared_ptr<CheckResult> check(const SharedScene& scene, const py::object& points,
                                   const py::object& arc_length, const py::dict& what,
                                   const py::dict& limits) {
  const compare::MeasuredShape shape = measured_shape(points, arc_length, "points");
  compare::CheckRequest request{
      .explaining =
          what["explain"].cast<bool>() ? compare::Explaining::yes : compare::Explaining::no,
      .shape = {.pose = compare::from_name<compare::PoseFreedom>(what["pose"].cast<std::string>()),
                .arc_lengths = compare::from_name<compare::ArcLengths>(
                    what["arc_lengths"].cast<std::string>()),
                .modulus = what["modulus"].cast<bool>() ? compare::ModulusSearch::yes
                                                        : compare::ModulusSearch::no,
                .solve = verified_options(limits)}};
  request.tolerance = cli::shape_tolerance(
      "tolerance",
      {what["tolerance"].cast<std::optional<std::string>>(), what["measure"].cast<std::string>(),
       what["min_seen"].cast<std::optional<double>>()},
      scene->scene.length);
  return std::make_shared<CheckResult>(
      run_long([&](Signals& /*signals*/) { return compare::check(scene->scene, shape, request); }));
}

py::object compare_scene(const SharedScene& scene, bool modulus, bool plan,
                         const py::dict& limits) {
  const compare::SolveOptions options = solve_options(limits);
  auto comparison = std::make_shared<Comparison>();
  comparison->of = scene;
  static_cast<compare::Comparison&>(*comparison) = run_long([&](Signals& /*signals*/) {
    return compare::compare(scene->scene, options,
                            plan ? std::optional(compare::PlanOptions{}) : std::nullopt,
                            modulus ? compare::ModulusSearch::yes : compare::ModulusSearch::no);
  });
  py::object result = py::cast(comparison);
  if (!comparison->unverified.empty()) {
    raise_convergence(
        fmt::format("{}: the energy model: {}", scene->scene.file, comparison->unverified), result);
  }
  return result;
}

using FitDocuments = std::tuple<std::string, std::string, std::string>;  // text, JSON, TOML

/// @param pairs  of points, or a file's name, and arc lengths;  @param name  of the argument
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
      .pose = compare::from_name<compare::PoseFreedom>(what["pose"].cast<std::string>()),
      .arc_lengths =
          compare::from_name<compare::ArcLengths>(what["arc_lengths"].cast<std::string>()),
      .density = what["density"].cast<bool>(),
      .torsional_stiffness = what["torsional_stiffness"].cast<bool>(),
      .natural_curvature_terms = what["natural_curvature_terms"].cast<int>(),
      .direction_tolerance = what["clamp_angles"].cast<double>(),
      .position_tolerance = what["clamp_positions"].cast<double>(),
      .roll_tolerance = what["clamp_rolls"].cast<double>(),
      .shared_clamps = what["same_clamps"].cast<bool>(),
      .direction_scatter = what["clamp_scatter"].cast<double>(),
      .camera_tilt = what["camera_tilt"].cast<double>(),
      .predict = what["predict"].cast<bool>(),
      .choose_options = chosen ? std::optional(*chosen == "auto") : std::nullopt,
      .chain_segments = what["segments"].cast<int>(),
      .chain_segment_lengths = what["segment_lengths"].cast<std::vector<double>>(),
      .noise = what["noise"].cast<std::optional<double>>(),
      .solve = verified_options(limits)};
  const compare::Calibration found = run_long([&](Signals& /*signals*/) {
    return compare::calibrate(scenes_of(scenes), measured_shapes, options, held_out);
  });
  std::string toml;
  try {
    toml = cli::material_toml(found);
  } catch (const compare::InputError&) {
    // The rest of the fit is worth having without it.
  }
  return {compare::to_text(found), compare::to_json(found), std::move(toml)};
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
  return {cli::force_model_text(fit, target.has_value()),
          cli::json_text(cli::force_model_json(fit)), cli::force_model_toml(fit)};
}

/// The properties of a Check that state the verdict.
template <typename Bound>
void bind_verdict(Bound& bound) {
  const auto of = [](auto get) { return [get](const CheckResult& r) { return get(r); }; };
  using Report = CheckResult;
  bound
      .def_property_readonly(
          "passed", of([](const Report& r) { return r.passes(); }),
          "Whether the shape is within the tolerance, 1 % of the length if none was given.")
      .def_property_readonly(
          "verdict",
          of([](const Report& r) { return std::string(compare::to_string(r.judgement.verdict)); }),
          "\"pass\", \"fail\", or \"undetermined\": within the tolerance, but the points do not "
          "determine the rod.")
      .def_property_readonly("significant",
                             of([](const Report& r) { return r.judgement.significant; }),
                             "Of a pass: whether the rod without weight and loads would not pass "
                             "too; None where neither acts or its shape was not found.")
      .def_property_readonly("deflection", of([](const Report& r) { return r.deflection_m; }),
                             "Largest distance between the rod with and without weight and loads "
                             "[m]; NaN where neither a pass nor the tolerance needs it.");
}

void bind_check(py::module_& module) {
  const auto of = [](auto get) { return [get](const CheckResult& r) { return get(r); }; };
  using Report = CheckResult;
  py::class_<Report, std::shared_ptr<Report>> bound(
      module, "Check", "A shape against its scene's energy model; of check(). Arrays are views.");
  bind_result(bound);
  bind_array(
      bound, "arc_length",
      [](const Report& r) -> const auto& { return r.check.reference.arc_length; },
      "Where the points are along the rod [m], shape (M,), read only.");
  bind_array(
      bound, "points",
      [](const Report& r) -> const auto& { return r.check.alignment.shape.points; },
      "The points as laid on the rod, by arc length [m], shape (M, 3), read only.");
  bind_array(
      bound, "reference", [](const Report& r) -> const auto& { return r.check.reference.points; },
      "The energy model there [m], shape (M, 3), read only.");
  bind_picture(bound, of([](const Report& r) { return compare::check_drawing(r.scene, r.check); }));
  bind_verdict(bound);
  bound
      .def_property_readonly("reason", of([](const Report& r) { return r.judgement.reason; }),
                             "Why, in words.")
      .def_property_readonly("rms", of([](const Report& r) { return r.check.deviation.rms_m; }),
                             "RMS distance of the points from the rod [m].")
      .def_property_readonly("largest", of([](const Report& r) { return r.check.deviation.max_m; }),
                             "Largest distance of a point [m].")
      .def_property_readonly(
          "energy_above_lowest",
          of([](const Report& r) { return r.check.state.energy_above_lowest_J(); }),
          "Energy of the equilibrium compared minus that of the lowest stable one known [J].")
      .def_property_readonly("worst_point", of([](const Report& r) { return r.check.worst_point; }),
                             "Number of that point, from 1.")
      .def_property_readonly(
          "deviation", of([](const Report& r) {
            return dict_of(compare::numbers_of(compare::deviation_fields(), r.check.deviation));
          }),
          "All deviations by name, in the names' units.")
      .def_property_readonly(
          "modulus_ratio", of([](const Report& r) { return r.check.effective_modulus.ratio; }),
          "E*/E at which the energy model comes nearest to the points; NaN without one.")
      .def_property_readonly(
          "explanations", of([](const Report& r) {
            std::vector<std::pair<std::string, double>> list;
            for (const compare::Explanation& e : r.explanations)
              list.emplace_back(e.cause, e.rms_m);
            return list;
          }),
          "Of a shape that fails: (cause, RMS distance were it so [m]), the best first.")
      .def("to_json", of([](const Report& r) { return compare::to_json(r); }),
           "The document of `dlo check --format json`, as text.")
      .def("__str__", of([](const Report& r) { return compare::to_text(r); }));
}

void bind_comparison(py::module_& module) {
  py::class_<Comparison, std::shared_ptr<Comparison>> bound(
      module, "Comparison", "Force model and energy model of a scene; of compare().");
  bind_result(bound);
  bind_array(
      bound, "arc_length",
      [](const Comparison& r) -> const auto& { return r.reference.arc_length; },
      "Arc lengths of the force model's points [m], shape (N,), read only.");
  bind_array(
      bound, "force_points",
      [](const Comparison& r) -> const auto& { return r.force.shape.points; },
      "The force model at rest [m], shape (N, 3), read only.");
  bind_array(
      bound, "energy_points", [](const Comparison& r) -> const auto& { return r.reference.points; },
      "The energy model there [m], shape (N, 3), read only.");
  bind_picture(bound,
               [](const Comparison& c) { return compare::comparison_drawing(c.of->scene, c); });
  bound
      .def_property_readonly(
          "deviation",
          [](const Comparison& c) {
            return dict_of(compare::numbers_of(compare::deviation_fields(), c.deviation));
          },
          "Deviations by name, in the names' units.")
      .def_property_readonly(
          "modulus_ratio", [](const Comparison& c) { return c.effective_modulus.ratio; },
          "E*/E; NaN without one.")
      .def(
          "to_json", [](const Comparison& c) { return compare::to_json(c); },
          "The document of `dlo compare --format json`, as text.")
      .def("__str__", [](const Comparison& c) {
        return (c.plan ? cli::plan_text(*c.plan, c.of->scene) : "") + compare::to_text(c);
      });
}

}  // namespace

void bind_judge(py::module_& module) {
  bind_check(module);
  bind_comparison(module);
  module.def("check", &check, py::arg("scene"), py::arg("points"), py::arg("arc_length"),
             py::arg("what"), py::arg("limits"));
  module.def("compare", &compare_scene, py::arg("scene"), py::arg("modulus"), py::arg("plan"),
             py::arg("limits"));
  module.def("calibrate_material", &calibrate_material, py::arg("scenes"), py::arg("shapes"),
             py::arg("what"), py::arg("limits"));
  module.def("calibrate_force_model", &calibrate_force_model, py::arg("scenes"),
             py::arg("holdouts"), py::arg("points"), py::arg("target"), py::arg("limits"));
}

}  // namespace dlo::python
