#include <memory>
#include <optional>

#include "array.hpp"
#include "module.hpp"
#include "result.hpp"

namespace dlo::python {
namespace {

/// Returns an axis as a dict, with the figure's tics; None: tics that the axes choose.
py::dict axis_dict(const compare::PlotAxis& laid_out, const compare::PlotAxis& described) {
  py::object tics = py::none();
  if (described.tics) {
    py::list list;
    for (const compare::Tic& tic : *described.tics) list.append(py::make_tuple(tic.at, tic.label));
    tics = list;
  }
  py::dict result;
  result["label"] = laid_out.label;
  result["limits"] = py::make_tuple(*laid_out.from, *laid_out.to);
  result["log"] = laid_out.logarithmic;
  result["tics"] = tics;
  return result;
}

py::dict curve_dict(const compare::PlottedCurve& curve) {
  const compare::Look& look = curve.look;
  py::dict result;
  result["title"] = curve.title;
  result["points"] = curve.z.empty() ? py::make_tuple(curve.x, curve.y)
                                     : py::make_tuple(curve.x, curve.y, curve.z);
  result["colour"] = look.colour;
  result["width"] = look.width;
  result["dashes"] = static_cast<int>(look.dashes);
  result["mark"] = static_cast<int>(look.mark);
  result["mark_size"] = look.mark_size;
  result["fill"] = look.fill;
  return result;
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
             const compare::Drawing drawn = result.drawing();
             return panel_dict(in_space.value_or(drawn.views.size() > 1)
                                   ? compare::spatial_panel(drawn)
                                   : compare::shape_panels(drawn).front());
           })
      .def("__str__", &Result::text)
      .def("__repr__", in_python("dlo._show", "line"))
      .def("_repr_html_", in_python("dlo._show", "html"))
      .def("_repr_svg_", in_python("dlo._show", "svg"));
}

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
  py::dict result;
  result["size"] = py::make_tuple(compare::figure_width, panel.full_height());
  result["upright"] = panel.upright;
  result["equal"] = panel.equal_aspect;
  result["axes"] = axes;
  result["curves"] = curves;
  result["texts"] = texts;
  return result;
}

}  // namespace dlo::python
