#pragma once

#include <Eigen/Core>

#include "dlo/energy_model/problem.hpp"

namespace dlo::energy_model {

/// Reference tangent at which the potential of a load's couple T is zero. The potential is -T times
/// the sum of two rotations of the tangent: from `direction` to the tangent at `at`, in (-pi, pi],
/// and from there along the rod to the load.
struct CoupleZero {
  double at = 0;              ///< arc length of the reference tangent: a clamp, or 0 [m]
  Eigen::Vector3d direction;  ///< reference direction, unit vector
};

/// Returns arc length and direction of the last clamp at or before the load, or else of the first
/// clamp after it. Without a clamp the arc length is 0, and the direction is that from the first
/// grip to the next grip at another position. If all grips have the same position, it is any
/// direction across the couple.
/// @throws std::invalid_argument if the rod does not reach from grip to grip
[[nodiscard]] CoupleZero couple_zero(const Problem& problem, const Load& load);

}  // namespace dlo::energy_model
