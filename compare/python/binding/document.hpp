#pragma once

#include <pybind11/pybind11.h>
#include <toml++/toml.h>

#include <string>

namespace dlo::python {

namespace py = pybind11;

/// Converts a scene's document to TOML. Keys whose value is None are omitted; arrays of NumPy
/// become lists.
/// @param path  path of the table, for messages. @throws compare::InputError for values that TOML
/// cannot represent
[[nodiscard]] toml::table to_toml(const py::dict& document, const std::string& path);

/// Converts a TOML table to a dict.
[[nodiscard]] py::dict to_python(const toml::table& table);

}  // namespace dlo::python
