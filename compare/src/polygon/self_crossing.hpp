#pragma once

#include <optional>

#include "dlo/compare/shape.hpp"

namespace dlo::compare {

/// Where two parts of a rod come nearer to each other than the rod is thick. No model knows contact
/// of the rod with itself.
struct SelfCrossing {
  double first = 0;     ///< arc length [m]
  double second = 0;    ///< arc length [m], > first
  double distance = 0;  ///< of the axis there [m]
};

/// The nearest two places of the polygon through a shape's points that are less than a diameter
/// apart, if there are any; places that are nearer along the rod than three diameters, or on
/// neighbouring segments, are one.
[[nodiscard]] std::optional<SelfCrossing> self_crossing(const Shape& shape, double diameter);

}  // namespace dlo::compare
