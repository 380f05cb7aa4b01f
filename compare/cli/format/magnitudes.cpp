#include "format/magnitudes.hpp"

#include <algorithm>

#include "base/number.hpp"

namespace dlo::cli {

Magnitudes magnitudes(const compare::Scene& scene) {
  const double l = scene.length;
  double force = scene.softer_bending_stiffness() / (l * l) + scene.weight_between(0, l).norm();
  for (const compare::PointLoad& load : scene.loads) force += load.force.norm();
  return {.length = l, .force = force, .torque = force * l, .energy = force * l};
}

Eigen::Vector3d shown(const Eigen::Vector3d& vector, double magnitude) {
  const double scale = std::max(magnitude, vector.norm());
  return {compare::shown(vector.x(), scale), compare::shown(vector.y(), scale),
          compare::shown(vector.z(), scale)};
}

}  // namespace dlo::cli
