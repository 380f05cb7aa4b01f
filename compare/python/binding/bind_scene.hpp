#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "dlo/compare/calibrated_rod.hpp"
#include "dlo/compare/material.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape_file.hpp"

namespace dlo::python {

/// Scene as read, which never changes. Calls that use it without the GIL therefore need no lock.
struct SceneData {
  compare::Scene scene;
  /// Difference between each obstacle's body and the surface that its point defines [m]: the rod's
  /// radius, or 0 if the axis touches.
  std::vector<double> obstacle_offsets;
  /// Rod that replaces the scene's own, and whose damping applies to a rod in motion.
  compare::CalibratedRod calibrated = {};
};

using SharedScene = std::shared_ptr<SceneData>;

/// Text and name of a file of materials; empty: the built-in file.
using MaterialsFile = std::optional<std::pair<std::string, std::string>>;

/// Returns the materials of the file. @throws compare::InputError
[[nodiscard]] std::vector<compare::Material> materials_of(const MaterialsFile& file);
/// Returns copies of the scenes.
[[nodiscard]] std::vector<compare::Scene> scenes_of(const std::vector<SharedScene>& shared);
/// Reads a shape from an array of points or, given as bytes, from the name of a file.
/// @param arc_length  arc lengths of the points, or None;  @param name  name of the points in
/// messages
/// @throws compare::InputError
[[nodiscard]] compare::MeasuredShape measured_shape(const pybind11::object& points,
                                                    const pybind11::object& arc_length,
                                                    const std::string& name);

}  // namespace dlo::python
