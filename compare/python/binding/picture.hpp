#pragma once

#include <pybind11/pybind11.h>

#include <Eigen/Core>
#include <vector>

#include "figure/series.hpp"

namespace dlo::python {

namespace py = pybind11;

/// Pairs of the axes to the right and up, by number.
[[nodiscard]] py::list view_list(const std::vector<compare::View>& views);

/// The points of several results, at least one: what their picture has to hold.
template <typename Results>
[[nodiscard]] Eigen::Matrix3Xd all_points(const Results& results) {
  std::vector<Eigen::Vector3d> points;
  for (const auto& result : results) {
    for (const auto& point : result.shape.points.colwise()) points.emplace_back(point);
  }
  if (points.empty()) points.emplace_back(Eigen::Vector3d::Zero());
  return Eigen::Map<const Eigen::Matrix3Xd>(points.front().data(), 3,
                                            static_cast<Eigen::Index>(points.size()));
}

/// How results with a shape show themselves.
/// @param views  of a result, as the command draws it
template <typename Type, typename... Options, typename Views>
void bind_picture(py::class_<Type, Options...>& bound, const Views& views) {
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
      .def_property_readonly("_views",
                             [views](const Type& result) { return view_list(views(result)); })
      .def("__repr__", shown("line"))
      .def("_repr_html_", shown("html"))
      .def("_repr_svg_", shown("svg"));
}

}  // namespace dlo::python
