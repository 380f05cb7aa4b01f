#pragma once

#include <Eigen/Core>

#include "dlo/energy_model/problem.hpp"

namespace dlo::energy_model {

/// Zero of the potential of a load's couple T. The potential is -T times two rotations of the
/// tangent: from `direction` to the tangent at `at`, in (-pi, pi], and on along the rod to the
/// load.
struct CoupleZero {
  double at = 0;              ///< arc length [m]
  Eigen::Vector3d direction;  ///< unit
};

/// Returns arc length and direction of the clamp at or before the load, or else of the next one
/// after it. Without a clamp the arc length is 0 and the direction is that from the first grip to
/// the next one; if the rod is held at one place, it is any direction across the couple.
[[nodiscard]] CoupleZero couple_zero(const Problem& problem, const Load& load);

}  // namespace dlo::energy_model
