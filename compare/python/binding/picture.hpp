#pragma once

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <string>

#include "figure/layout.hpp"
#include "figure/series.hpp"
#include "figure/shape_panels.hpp"

namespace dlo::python {

namespace py = pybind11;

/// What _plot.py draws of a panel.
[[nodiscard]] py::dict panel_dict(const compare::Panel& described);

/// A result with a shape. Never changed once it is made.
struct Result {
  virtual ~Result() = default;

  /// Returns the text of the command.
  [[nodiscard]] virtual std::string text() const = 0;
  /// Returns the document of the command with `--format json`.
  [[nodiscard]] virtual std::string json() const = 0;
  /// Returns the picture of the command.
  [[nodiscard]] virtual compare::Drawing drawing() const = 0;
};

}  // namespace dlo::python
