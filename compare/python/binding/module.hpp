#pragma once

#include <pybind11/pybind11.h>

namespace dlo::python {

namespace py = pybind11;

// What the module has, by subject.
void bind_errors(py::module_& module);
void bind_scene(py::module_& module);
void bind_result(py::module_& module);
void bind_solve(py::module_& module);
void bind_judge(py::module_& module);
void bind_studies(py::module_& module);
void bind_regress(py::module_& module);
void bind_suite(py::module_& module);
void bind_track(py::module_& module);
void bind_force_model(py::module_& module);
void bind_batch(py::module_& module);

}  // namespace dlo::python
