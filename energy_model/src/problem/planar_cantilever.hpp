#pragma once

#include <Eigen/Core>
#include <vector>

namespace dlo::energy_model {

/// A rod clamped at one end, in its plane and in its own units: lengths in l, forces in EI/l^2,
/// energies in EI/l. The clamp is the origin and the rod leaves it along +x; s is the distance from
/// the clamp along the rod.
struct PlanarCantilever {
  /// A force and a couple at a point.
  struct Load {
    double at = 0;                                    ///< s, 0 < s <= 1
    Eigen::Vector2d force = Eigen::Vector2d::Zero();  ///< in EI/l^2
    double couple = 0;                                ///< in EI/l
  };
  Eigen::Vector2d weight = Eigen::Vector2d::Zero();  ///< its norm is Gamma = w l^3 / (EI)
  std::vector<Load> loads;                           ///< sorted by `at`
};

}  // namespace dlo::energy_model
