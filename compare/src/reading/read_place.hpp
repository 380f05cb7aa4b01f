#pragma once

#include <Eigen/Core>
#include <string_view>

#include "dlo/compare/trajectory.hpp"
#include "toml/strict_table.hpp"

namespace dlo::compare {

/// An arc length of the rod. @throws InputError naming file, line, key, value and what is allowed,
///                                   as the others
[[nodiscard]] double read_arc_length(StrictTable& table, std::string_view key, double length);

/// A direction of any length, made unit.
[[nodiscard]] Eigen::Vector3d unit_vector(StrictTable& table, std::string_view key);

/// Where something is whose poses, if it has any, say so too: the first of them is where it is.
[[nodiscard]] Eigen::Vector3d read_place(StrictTable& table, const char* key,
                                         const Trajectory& trajectory);

}  // namespace dlo::compare
