#pragma once

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <optional>

#include "figure/layout.hpp"
#include "figure/series.hpp"
#include "figure/shape_panels.hpp"

namespace dlo::python {

namespace py = pybind11;

/// What _plot.py draws of a panel.
[[nodiscard]] py::dict panel_dict(const compare::Panel& described);

/// How results with a shape show themselves.
/// @param drawing  of a result, as the command has it
template <typename Type, typename... Options, typename DrawingOf>
void bind_picture(py::class_<Type, Options...>& bound, const DrawingOf& drawing) {
  const auto shown = [](const char* how) {
    return
        [how](const py::object& self) { return py::module_::import("dlo._show").attr(how)(self); };
  };
  bound
      .def(
          "plot",
          [](const py::object& self, const py::object& ax) {
            return py::module_::import("dlo._plot").attr("plot")(self, ax);
          },
          py::arg("ax") = py::none(),
          "Draws the shape with matplotlib, at equal aspect. ax: the axes to draw into, new ones\n"
          "for None; returned.")
      .def("_panel",
           [drawing](const Type& result, std::optional<bool> in_space) {
             const compare::Drawing drawn = drawing(result);
             return panel_dict(in_space.value_or(drawn.views.size() > 1)
                                   ? compare::spatial_panel(drawn)
                                   : compare::shape_panels(drawn).front());
           })
      .def("__repr__", shown("line"))
      .def("_repr_html_", shown("html"))
      .def("_repr_svg_", shown("svg"));
}

}  // namespace dlo::python
