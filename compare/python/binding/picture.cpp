#include <memory>
#include <optional>

#include "array.hpp"
#include "module.hpp"
#include "result.hpp"

namespace dlo::python {
namespace {

using namespace py::literals;  // NOLINT(google-build-using-namespace): of names alone

/// Returns an axis as a dict, with the figure's tics; None: tics that the axes choose.
py::dict axis_dict(const compare::PlotAxis& axis, const compare::PlotAxis& described) {
  py::object tics = py::none();
  if (described.tics) {
    py::list list;
    for (const compare::Tic& tic : *described.tics) list.append(py::make_tuple(tic.at, tic.label));
    tics = list;
  }
  return py::dict("label"_a = axis.label, "tics"_a = tics, "log"_a = py::bool_(axis.logarithmic),
                  "limits"_a = py::make_tuple(*axis.from, *axis.to));
}

py::dict curve_dict(const compare::PlottedCurve& curve) {
  const compare::CurveStyle& look = curve.look;
  return py::dict("title"_a = curve.title,
                  "points"_a = curve.z.empty() ? py::make_tuple(curve.x, curve.y)
                                               : py::make_tuple(curve.x, curve.y, curve.z),
                  "colour"_a = look.colour, "width"_a = look.width, "fill"_a = look.fill,
                  "dashes"_a = py::int_(static_cast<int>(look.dashes)),
                  "mark"_a = py::int_(static_cast<int>(look.mark)), "mark_size"_a = look.mark_size);
}

/// Returns a panel as _plot.py draws it.
py::dict panel_dict(const compare::Panel& described) {
  const compare::Panel panel = compare::laid_out(described);
  py::list axes;
  axes.append(axis_dict(panel.x, described.x));
  axes.append(axis_dict(panel.y, described.y));
  if (panel.z) axes.append(axis_dict(*panel.z, *described.z));
  py::list curves;
  for (const compare::PlottedCurve& curve : panel.curves) curves.append(curve_dict(curve));
  py::list texts;
  for (const compare::Text& text : panel.texts) {
    texts.append(py::make_tuple(text.words, text.x, text.y, text.dx, text.dy));
  }
  return py::dict("size"_a = py::make_tuple(compare::figure_width, panel.full_height()),
                  "upright"_a = py::int_(panel.upright), "equal"_a = py::bool_(panel.equal_aspect),
                  "axes"_a = axes, "curves"_a = curves, "texts"_a = texts);
}

/// Returns a function that calls a Python function with the result and further arguments.
auto in_python(const char* module, const char* function) {
  return [module, function](const py::args& arguments) {
    return py::module_::import(module).attr(function)(*arguments);
  };
}

}  // namespace

void bind_result(py::module_& module) {
  py::class_<Result, std::shared_ptr<Result>> bound(module, "Result");
  refuse_pickle(bound, "pickled", "its to_json(), its arrays");
  refuse_new(bound, "the functions of dlo");
  bound
      // A result never changes, so a copy is the object itself.
      .def("__copy__", [](const py::object& self) { return self; })
      .def("__deepcopy__", [](const py::object& self, const py::dict& /*memo*/) { return self; })
      .def("to_json", &Result::json, "The command's document, as text.")
      .def_property_readonly(
          "json", [](const py::object& self) -> Typed<py::dict, "dict[str, Any]"> {
            return py::module_::import("json").attr("loads")(self.attr("to_json")());
          },
          "The command's document, as a dict.")
      .def(
          "plot",
          [](const py::object& self, const py::object& ax) {
            return py::module_::import("dlo._plot").attr("plot")(self, ax);
          },
          py::arg("ax") = py::none(),
          "Draws the shape with matplotlib, at equal aspect. ax: the axes to draw into, new ones\n"
          "for None; returned.")
      .def("_panel",
           [](const Result& result, std::optional<bool> in_space) {
             return panel_dict(result.panel(in_space));
           })
      .def("__str__", &Result::text)
      .def("__repr__", in_python("dlo._show", "line"))
      .def("_repr_html_", in_python("dlo._show", "html"))
      .def("_repr_svg_", in_python("dlo._show", "svg"));
}

compare::Panel Result::panel(std::optional<bool> in_space) const {
  const compare::Drawing drawn = drawing();
  return in_space.value_or(drawn.views.size() > 1) ? compare::spatial_panel(drawn)
                                                   : compare::shape_panels(drawn).front();
}

}  // namespace dlo::python
