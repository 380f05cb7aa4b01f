#pragma once

#include <pybind11/pybind11.h>

namespace dlo::python {

namespace py = pybind11;

/// What all results have besides to_json(): the same as a dict, and a picture.
template <typename Class>
void bind_result(Class& bound) {
  bound
      .def_property_readonly(
          "json",
          [](const py::object& self) {
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
          "for None; returned.");
}

}  // namespace dlo::python
