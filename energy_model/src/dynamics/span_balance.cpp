// What of a moving span is neither motion nor force within: energies, what grips exert, power.

#include <Eigen/Geometry>

#include "dynamics/span_dynamics.hpp"

namespace dlo::energy_model {

SpanEnergies SpanDynamics::energies() const {
  SpanEnergies result;
  const Eigen::Index Q = nodes_of_piece();
  result.bending = x_.cwiseProduct(elastic_).squaredNorm() / 2;
  result.obstacles = obstacle_energy_;
  for (const Touch& touch : touches_) result.obstacles += touch.kept;
  for (std::size_t e = 0; e < pieces_.size(); ++e) {
    const Eigen::Index row = static_cast<Eigen::Index>(e) * Q;
    const double length = pieces_[e].length;
    const Eigen::VectorXd squares = velocity_.middleRows(row, Q).rowwise().squaredNorm();
    result.kinetic += inertia_.per_length[e] * length * table_->weights.dot(squares) / 2;
    const Eigen::Vector3d middle = position_.middleRows(row, Q).transpose() * table_->weights;
    result.gravity -=
        middle.dot(drive_.turn * span_.weight_between(pieces_[e].begin, pieces_[e].end()));
  }
  for (std::size_t k = 0; k < stations_.size(); ++k) {
    result.kinetic += inertia_.at_stations[k] * stations_[k].rate.squaredNorm() / 2;
    result.load -= stations_[k].value.dot(drive_.turn * station_loads_[k]);
  }
  return result;
}

SpanReactions SpanDynamics::reactions(const Eigen::Ref<const Eigen::VectorXd>& multipliers) const {
  SpanReactions result;
  const Eigen::Vector3d anchor = drive_.anchor.value;
  const auto add = [&](const Eigen::Vector3d& at, const Eigen::Vector3d& needed) {
    result.anchor_force += needed;
    result.anchor_torque += (at - anchor).cross(needed);
  };
  for (Eigen::Index node = 0; node < s_.size(); ++node) {
    add(position_.row(node).transpose(), forces_.row(node).transpose());
  }
  for (std::size_t k = 0; k < stations_.size(); ++k) add(stations_[k].value, station_forces_[k]);
  for (const Touch& touch : touches_) add(touch.at, -touch.push * touch.normal);
  for (std::size_t k = 0; k < hold_stations_.size(); ++k) {
    result.hold_forces.push_back(multiplier_force(multipliers, k));
    add(stations_[hold_stations_[k]].value, -result.hold_forces.back());
  }
  const Eigen::Index first = axes_ * static_cast<Eigen::Index>(hold_stations_.size());
  for (std::size_t i = 0; i < drive_.across_end.size(); ++i) {
    result.end_torque += multipliers[first + static_cast<Eigen::Index>(i)] *
                         end_tangent_.value.cross(drive_.across_end[i].value);
  }
  result.anchor_torque -= result.end_torque;
  return result;
}

SpanPower SpanDynamics::power(const SpanReactions& reactions) const {
  SpanPower result;
  result.work = obstacle_work_ + reactions.anchor_force.dot(drive_.anchor.rate) +
                reactions.anchor_torque.dot(drive_.spin) +
                reactions.end_torque.dot(drive_.end_spin);
  for (std::size_t k = 0; k < reactions.hold_forces.size(); ++k) {
    result.work += reactions.hold_forces[k].dot(drive_.holds[k].rate);
  }
  for (const Touch& touch : touches_) {
    result.work += touch.push * touch.normal.dot(touch.velocity);
    result.lost += touch.lost;
  }
  const Eigen::VectorXd strains = v_.cwiseProduct(elastic_);
  result.dissipated = inertia_.material_damping * strains.squaredNorm();
  const Eigen::Index Q = nodes_of_piece();
  for (std::size_t e = 0; e < pieces_.size(); ++e) {
    const Eigen::VectorXd squares =
        velocity_.middleRows(static_cast<Eigen::Index>(e) * Q, Q).rowwise().squaredNorm();
    result.dissipated += inertia_.drag * pieces_[e].length * table_->weights.dot(squares);
  }
  return result;
}

}  // namespace dlo::energy_model
