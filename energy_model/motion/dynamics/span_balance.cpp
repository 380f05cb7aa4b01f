// Energies, reactions and powers of a moving span.

#include <Eigen/Geometry>

#include "dynamics/span_dynamics.hpp"

namespace dlo::energy_model {

void add(const EnergyBalance& of, double times, EnergyBalance& to) {
  for (double EnergyBalance::*entry :
       {&EnergyBalance::kinetic, &EnergyBalance::bending, &EnergyBalance::twisting,
        &EnergyBalance::gravity, &EnergyBalance::load, &EnergyBalance::obstacles,
        &EnergyBalance::dissipated, &EnergyBalance::lost, &EnergyBalance::work}) {
    to.*entry += times * of.*entry;
  }
}

EnergyBalance SpanDynamics::energies() const {
  EnergyBalance result;
  result.kinetic = masses_.dot(velocity_.rowwise().squaredNorm()) / 2;
  const Eigen::VectorXd strains = x_.cwiseProduct(elastic_);
  result.bending = strains.squaredNorm() / 2;
  if (has_twist()) {
    result.kinetic += twist_inertia_.dot(v_.cwiseAbs2()) / 2;
    result.twisting = strains.tail(frames_.columns()).squaredNorm() / 2;
    result.bending -= result.twisting;
  }
  const Eigen::MatrixX3d along_span = position_ * drive_.turn;
  result.gravity = -gravity_.cwiseProduct(along_span).sum();
  result.load = -loads_.cwiseProduct(along_span).sum();
  for (const ContactPoint& touch : soft_contact_points_) result.obstacles += touch.kept;
  for (const ContactPoint& touch : contact_points_) result.obstacles += touch.kept;
  return result;
}

std::vector<Reaction> SpanDynamics::reactions(
    const Eigen::Ref<const Eigen::VectorXd>& multipliers) const {
  std::vector<Reaction> result(drive_.grips.size());
  Reaction& anchor = result.front();
  const auto add = [&](const Eigen::Vector3d& at, const Eigen::Vector3d& needed) {
    anchor.force += needed;
    anchor.torque += (at - drive_.grips.front().value).cross(needed);
  };
  for (Eigen::Index point = 0; point < points_.points(); ++point) {
    add(position_.row(point).transpose(), forces_.row(point).transpose());
  }
  for (const ContactPoint& touch : contact_points_) add(touch.at, -touch.force());
  for (std::size_t k = 0; k < grip_points_.size(); ++k) {
    result[k + 1].force = multiplier_force(multipliers, k);
    add(position_.row(grip_points_[k]).transpose(), -result[k + 1].force);
  }
  // The clamp at the end is the last grip.
  const Eigen::Vector3d end_torque = -couples(multipliers).back();
  result.back().torque += end_torque;
  anchor.torque -= end_torque;
  return result;
}

EnergyBalance SpanDynamics::power(const std::vector<Reaction>& reactions) const {
  EnergyBalance result;
  result.work =
      reactions.front().torque.dot(drive_.spin) + reactions.back().torque.dot(drive_.end_spin);
  for (std::size_t k = 0; k < reactions.size(); ++k) {
    result.work += reactions[k].force.dot(drive_.grips[k].rate);
  }
  for (const std::vector<ContactPoint>* touches : {&soft_contact_points_, &contact_points_}) {
    for (const ContactPoint& touch : *touches) {
      result.work += touch.force().dot(touch.velocity);
      result.lost += touch.lost;
    }
  }
  result.dissipated = inertia_.material_damping * v_.cwiseProduct(elastic_).squaredNorm() +
                      inertia_.drag * points_.weights().dot(velocity_.rowwise().squaredNorm());
  if (quadratic_drag_.size() > 0) {
    result.dissipated += quadratic_drag_.cwiseProduct(velocity_).sum();
  }
  return result;
}

}  // namespace dlo::energy_model
