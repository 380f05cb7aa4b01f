#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>

#include "dlo/energy_model/problem.hpp"

namespace dlo::energy_model {

/// Returns the normal that d2 is where the first clamp of a rod with material directors does not
/// say otherwise: that of the plane of grips, weight and obstacles, on the side of +z (+y, +x). For
/// a rod without natural strains loads choose the plane too; a line lies in the plane that holds x,
/// or y. For one with natural strains they do not. Empty: there is no such plane. With natural
/// strains also: there is more than one, as along a line that is not in x-y; or a load has a
/// component across it that moves the rod by more than about 1e-6 of its length.
[[nodiscard]] std::optional<Eigen::Vector3d> natural_normal(const Problem& problem);

/// Index of the first clamp along the rod in Problem::grips. None: there are but pins.
[[nodiscard]] std::optional<std::size_t> first_clamp(const Problem& problem);

/// Frame (columns d1, d2, t) that the first clamp holds a rod with material directors in.
/// @throws std::invalid_argument if it does not say where d1 is and there is no plane that does
[[nodiscard]] Eigen::Matrix3d first_frame(const Problem& problem);

}  // namespace dlo::energy_model
