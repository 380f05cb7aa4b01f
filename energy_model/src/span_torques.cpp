#include <Eigen/Geometry>
#include <cmath>

#include "span_energy.hpp"

namespace dlo::energy_model {

Eigen::Vector3d SpanEnergy::end_torque(const Eigen::VectorXd& multipliers) const {
  if (!span_.end_direction) return Eigen::Vector3d::Zero();
  if (span_.planar) return {0, 0, multipliers[constraints_ - 1]};
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();
  for (Eigen::Index component = 0; component < end_rows_; ++component) {
    torque += multipliers[constraints_ - end_rows_ + component] * end_miss(component).couple;
  }
  return torque;
}

Eigen::Vector3d SpanEnergy::start_torque(const Eigen::VectorXd& multipliers) const {
  if (!span_.start_direction) return Eigen::Vector3d::Zero();
  Eigen::Vector3d moment = end_torque(multipliers);
  for (Eigen::Index j = 0; j < reach_.cols(); ++j) {
    Eigen::Vector3d force = Eigen::Vector3d::Zero();
    force.head(axes_) = multipliers.segment(j * axes_, axes_);
    moment += span_.holds[static_cast<std::size_t>(j)].offset.cross(force);
  }
  const Eigen::VectorXd beyond = weights_.array() * (span_.length - s_.array());
  const Eigen::Vector3d first_moment = t_.transpose() * beyond;
  moment += first_moment.cross(span_.weight);
  for (const Span::Load& load : span_.loads) {
    const Eigen::VectorXd before =
        (s_.array() < load.at).select(weights_, Eigen::VectorXd::Zero(weights_.size()));
    const Eigen::Vector3d point = t_.transpose() * before;
    moment += point.cross(load.force);
  }
  return -(moment + walls_.moment(t_));
}

}  // namespace dlo::energy_model
