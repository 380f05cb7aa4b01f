#pragma once

#include <pybind11/pybind11.h>

#include "dlo/compare/solution.hpp"

namespace dlo::python {

namespace py = pybind11;

/// Limits of the solvers, by the names of SolveOptions; what is None or missing is as usual.
/// Shapes that are not verified are taken, to be part of an error.
/// @throws compare::InputError for a number out of range or another name
[[nodiscard]] compare::SolveOptions solve_options(const py::dict& given);

/// The same where a shape that is not verified is an error at once.
[[nodiscard]] compare::SolveOptions verified_options(const py::dict& given);

}  // namespace dlo::python
