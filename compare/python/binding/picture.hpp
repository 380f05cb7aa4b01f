#pragma once

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <optional>
#include <vector>

#include "figure/layout.hpp"
#include "figure/series.hpp"
#include "figure/shape_panels.hpp"

namespace dlo::python {

namespace py = pybind11;

/// What _plot.py draws of a panel.
[[nodiscard]] py::dict panel_dict(const compare::Panel& panel);

/// How results with a shape show themselves.
/// @param views   of a result, as the command draws it
/// @param series  what the command's picture shows of it, in these views
template <typename Type, typename... Options, typename Views, typename SeriesOf>
void bind_picture(py::class_<Type, Options...>& bound, const Views& views, const SeriesOf& series) {
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
           [views, series](const Type& result, std::optional<bool> in_space) {
             const std::vector<compare::View> seen = views(result);
             const std::vector<compare::Series> all = series(result, seen);
             return panel_dict(in_space.value_or(seen.size() > 1)
                                   ? compare::spatial_panel(all, seen.front().up)
                                   : compare::shape_panels(all, seen).front());
           })
      .def("__repr__", shown("line"))
      .def("_repr_html_", shown("html"))
      .def("_repr_svg_", shown("svg"));
}

}  // namespace dlo::python
