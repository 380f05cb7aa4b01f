#pragma once

#include <Eigen/Core>

#include "dlo/compare/scene.hpp"

namespace dlo::cli {

/// How large a scene's results are: what is far below is rounding (compare::shown).
struct Magnitudes {
  double length = 0;  ///< l [m]
  double force = 0;   ///< its weight, its loads and EI/l^2 [N]
  double torque = 0;  ///< that force times l [N m]
  double energy = 0;  ///< likewise [J]
};

[[nodiscard]] Magnitudes magnitudes(const compare::Scene& scene);

/// compare::shown() of each component, beside the vector's own norm.
[[nodiscard]] Eigen::Vector3d shown(const Eigen::Vector3d& vector, double magnitude);

}  // namespace dlo::cli
