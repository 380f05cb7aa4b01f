#include <Eigen/Geometry>
#include <cmath>

#include "strain/span_energy.hpp"

namespace dlo::energy_model {

Eigen::Vector3d SpanEnergy::hold_torque(Eigen::Index hold,
                                        const Eigen::VectorXd& multipliers) const {
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();
  Eigen::Index row = first_director_row();
  for (const DirectorRow& held : director_rows_) {
    const double mu = multipliers[row++];
    if (held.hold != hold) continue;
    torque +=
        span_.planar ? Eigen::Vector3d(0, 0, mu) : Eigen::Vector3d(mu * residual_of(held).couple);
  }
  return torque;
}

Eigen::Vector3d SpanEnergy::start_torque(const Eigen::VectorXd& multipliers) const {
  if (!span_.start_direction) return Eigen::Vector3d::Zero();
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  for (Eigen::Index j = 0; j < reach_.cols(); ++j) moment += hold_torque(j, multipliers);
  for (Eigen::Index j = 0; j < reach_.cols(); ++j) {
    Eigen::Vector3d force = Eigen::Vector3d::Zero();
    force.head(axes_) = multipliers.segment(j * axes_, axes_);
    moment += span_.holds[static_cast<std::size_t>(j)].offset.cross(force);
  }
  // Of weight and loads, which the nodes carry: sum t x force.
  const auto carried = [this](Eigen::Index a, Eigen::Index b) {
    return t_.col(a).dot(force_.col(b)) - t_.col(b).dot(force_.col(a));
  };
  moment.z() += carried(0, 1);
  for (const Span::Load& load : span_.loads) moment.z() += load.couple;
  if (!span_.planar) moment.head<2>() += Eigen::Vector2d(carried(1, 2), carried(2, 0));
  if (contacts_.count() > 0) {
    moment += contacts_.moment(multipliers.segment(first_contact_row(), contacts_.count()), t_);
  }
  return -(moment + soft_contact_.moment(t_));
}

}  // namespace dlo::energy_model
