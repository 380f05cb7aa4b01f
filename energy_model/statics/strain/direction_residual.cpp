#include "strain/direction_residual.hpp"

#include <Eigen/Geometry>

#include "base/spin.hpp"

namespace dlo::energy_model {

DirectionResidual direction_residual(const Eigen::Vector3d& p, const Eigen::Vector3d& to,
                                     const Eigen::Vector3d& across) {
  const double n = across.dot(p);
  const double d = 1 + to.dot(p);
  const Eigen::Vector3d gradient = 2 * (across / d - n / (d * d) * to);
  const Eigen::Matrix3d second =
      -2 / (d * d) * (across * to.transpose() + to * across.transpose()) +
      4 * n / (d * d * d) * to * to.transpose();
  const Eigen::Matrix3d turn = cross_matrix(p);
  return {2 * n / d, p.cross(gradient),
          spin_curvature(p, gradient) + turn.transpose() * second * turn};
}

}  // namespace dlo::energy_model
