#pragma once

#include <pybind11/pybind11.h>

#include <string>

namespace dlo::python {

namespace py = pybind11;

/// Raises dlo.ConvergenceError. @param result  so far, or None
[[noreturn]] void raise_convergence(const std::string& message, const py::object& result);

}  // namespace dlo::python
