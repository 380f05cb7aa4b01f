#pragma once

#include <optional>

#include "dlo/compare/shape.hpp"

namespace dlo::compare {

/// Two points of the rod's axis whose distance is at most the diameter of the rod. No model has
/// contact of the rod with itself.
struct SelfCrossing {
  double first = 0;     ///< arc length [m]
  double second = 0;    ///< arc length [m], > first
  double distance = 0;  ///< distance between the axes there [m]
};

/// Finds the nearest two points of the polygon through a shape's points that are at most a diameter
/// apart; std::nullopt if there are none. Points closer along the rod than three diameters, or on
/// neighbouring segments, are not compared.
[[nodiscard]] std::optional<SelfCrossing> self_crossing(const Shape& shape, double diameter);

}  // namespace dlo::compare
