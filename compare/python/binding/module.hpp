#pragma once

#include <pybind11/pybind11.h>

#include <string>

#include "dlo/compare/solution.hpp"

namespace dlo::python {

namespace py = pybind11;

// Functions that bind the parts of the module, by subject.
void bind_scene(py::module_& module);
void bind_result(py::module_& module);
void bind_solve(py::module_& module);
void bind_judge(py::module_& module);
void bind_studies(py::module_& module);
void bind_suite(py::module_& module);
void bind_track(py::module_& module);
void bind_force_model(py::module_& module);
void bind_batch(py::module_& module);

/// Raises dlo.ConvergenceError. @param result  result so far, or None
[[noreturn]] void raise_convergence(const std::string& message, const py::object& result);

/// Reads limits of the solvers, by the names of SolveOptions; for None or a missing key the default
/// is used. Shapes that are not verified are accepted, so that an error can contain them.
/// @throws compare::InputError for a number out of range or another name
[[nodiscard]] compare::SolveOptions solve_options(const py::dict& given);

/// Reads limits as solve_options() does, but a shape that is not verified is an error at once.
[[nodiscard]] compare::SolveOptions verified_options(const py::dict& given);

}  // namespace dlo::python
