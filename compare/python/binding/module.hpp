#pragma once

#include <pybind11/pybind11.h>

#include <string>

#include "dlo/compare/solution.hpp"

namespace dlo::python {

namespace py = pybind11;

// What the module has, by subject.
void bind_errors(py::module_& module);
void bind_scene(py::module_& module);
void bind_result(py::module_& module);
void bind_solve(py::module_& module);
void bind_judge(py::module_& module);
void bind_studies(py::module_& module);
void bind_suite(py::module_& module);
void bind_track(py::module_& module);
void bind_force_model(py::module_& module);
void bind_batch(py::module_& module);

/// Raises dlo.ConvergenceError. @param result  so far, or None
[[noreturn]] void raise_convergence(const std::string& message, const py::object& result);

/// Limits of the solvers, by the names of SolveOptions; what is None or missing is as usual.
/// Shapes that are not verified are taken, to be part of an error.
/// @throws compare::InputError for a number out of range or another name
[[nodiscard]] compare::SolveOptions solve_options(const py::dict& given);

/// The same where a shape that is not verified is an error at once.
[[nodiscard]] compare::SolveOptions verified_options(const py::dict& given);

}  // namespace dlo::python
