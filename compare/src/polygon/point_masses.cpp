#include "polygon/point_masses.hpp"

#include "dlo/compare/discretise.hpp"

namespace dlo::compare {

PointMasses point_masses(const Scene& scene, const ForceModelSettings& settings) {
  // Forces of points under an acceleration of 1 along -y, in which only masses have any.
  Scene weighed = scene;
  weighed.gravity = {0, -1, 0};
  for (PointLoad& load : weighed.loads) load.force = load.mass * weighed.gravity;
  weighed.distributed_loads.clear();
  const Discretisation polygon = discretise(weighed, settings);
  PointMasses masses;
  for (Eigen::Index i = 0; i < polygon.weights.cols(); ++i) {
    masses.rod.push_back(-polygon.weights(1, i));
    masses.hanging.push_back(polygon.weights(1, i) - polygon.rod.loads(1, i));
  }
  return masses;
}

}  // namespace dlo::compare
