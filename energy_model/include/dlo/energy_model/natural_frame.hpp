#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>

#include "dlo/energy_model/problem.hpp"

namespace dlo::energy_model {

/// Returns the direction of d2 at the first clamp of a rod with material directors if that clamp
/// has no d1, before its roll. It is the normal of the plane that contains grips, weight and the
/// normals of half-spaces, on the side of +z (+y, +x). Without natural strains loads and the
/// velocity of drag determine the plane too, and a straight line lies in the plane that contains x,
/// or y. With natural strains loads do not determine the plane. Returns std::nullopt if there is no
/// such plane, or if an obstacle is not symmetric to it. With natural strains it also does so if
/// these directions determine only a line, in a plane that contains z, or if a load or drag moves
/// the rod out of the plane noticeably.
[[nodiscard]] std::optional<Eigen::Vector3d> natural_normal(const Problem& problem);

/// Returns the index in Problem::grips of the first clamp along the rod; std::nullopt if there are
/// only pins.
[[nodiscard]] std::optional<std::size_t> first_clamp(const Problem& problem);

/// Returns the frame (columns d1, d2, t) in which the first clamp holds a rod with material
/// directors, its roll included. The problem has to have a clamp.
/// @throws std::invalid_argument if the clamp has no d1 and no plane determines it
/// (natural_normal())
[[nodiscard]] Eigen::Matrix3d first_frame(const Problem& problem);

}  // namespace dlo::energy_model
