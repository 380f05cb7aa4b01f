#pragma once

#include <pybind11/pybind11.h>
#include <toml++/toml.h>

#include <string>

namespace dlo::python {

namespace py = pybind11;

/// A scene's document as TOML. Keys that are None are left out; arrays of NumPy are lists.
/// @param path  of the table, for messages. @throws compare::InputError for values that TOML has
/// not
[[nodiscard]] toml::table to_toml(const py::dict& document, const std::string& path);

/// The same the other way round.
[[nodiscard]] py::dict to_python(const toml::table& table);

}  // namespace dlo::python
