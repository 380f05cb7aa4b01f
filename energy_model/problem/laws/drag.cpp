#include "dlo/energy_model/drag.hpp"

#include <cmath>

namespace dlo::energy_model {

Eigen::Vector3d Drag::force(const Eigen::Vector3d& tangent) const {
  const double along = velocity.dot(tangent);
  const Eigen::Vector3d across = velocity - along * tangent;
  return normal * across.norm() * across + tangential * std::abs(along) * along * tangent;
}

Eigen::Matrix3d Drag::by_tangent(const Eigen::Vector3d& tangent) const {
  // dv_n = -(v.dt) t - (v.t) dt, so that d|v_n| = v_n.dv_n / |v_n| = -(v.t) v_n.dt / |v_n|, and
  // d(|v_n| v_n) = |v_n| dv_n - (v.t) / |v_n| v_n v_n^T dt; v_n v_n^T / |v_n| has the limit 0.
  const double along = velocity.dot(tangent);
  const Eigen::Vector3d across = velocity - along * tangent;
  const double speed = across.norm();
  const Eigen::Matrix3d lengthened = tangent * velocity.transpose();  // maps dt to (v.dt) t
  const Eigen::Matrix3d turned = along * Eigen::Matrix3d::Identity();
  Eigen::Matrix3d result = std::abs(along) * tangential * (2 * lengthened + turned) -
                           normal * speed * (lengthened + turned);
  if (speed > 0) result -= normal * along / speed * across * across.transpose();
  return result;
}

double Drag::largest() const { return (normal + tangential) * velocity.squaredNorm(); }

}  // namespace dlo::energy_model
