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

/// A scene as the reader has it, and never changed: a call that works on it without the GIL has it
/// to itself.
struct SceneData {
  compare::Scene scene;
  /// By which each obstacle's body is larger than what its point says: the rod's radius, or 0 where
  /// the axis touches [m].
  std::vector<double> obstacle_offsets;
  /// Rod that the scene has in the place of its own, whose damping counts for a rod in motion.
  compare::CalibratedRod calibrated = {};
};

using SharedScene = std::shared_ptr<SceneData>;

/// Text and name of a file of materials; none: the built-in one.
using MaterialsFile = std::optional<std::pair<std::string, std::string>>;

/// What it has. @throws compare::InputError
[[nodiscard]] std::vector<compare::Material> materials_of(const MaterialsFile& file);
/// Copies.
[[nodiscard]] std::vector<compare::Scene> scenes_of(const std::vector<SharedScene>& shared);
/// A shape from an array of points or, as bytes, the name of a file.
/// @param arc_length  of the points, or none;  @param name  what messages call the points
/// @throws compare::InputError
[[nodiscard]] compare::MeasuredShape measured_shape(const pybind11::object& points,
                                                    const pybind11::object& arc_length,
                                                    const std::string& name);

}  // namespace dlo::python
