#include "verlet_step.hpp"

#include <cmath>

#include "point_masses.hpp"

namespace dlo::force_model {

VerletStep::VerletStep(const Rod& rod, const StepOptions& options)
    : time_step_(options.time_step),
      damping_rate_(options.damping_rate),
      inverse_masses_(rod.points()),
      velocities_(Eigen::Matrix3Xd::Zero(3, rod.points())),
      next_(velocities_) {
  const std::vector<char> is_free = free_points(rod);
  require_masses(rod, is_free);
  for (Eigen::Index i = 0; i < rod.points(); ++i) {
    inverse_masses_[i] = is_free[static_cast<std::size_t>(i)] != 0 ? 1 / rod.masses[i] : 0;
  }
}

void VerletStep::step(const Eigen::Matrix3Xd& forces, Eigen::Matrix3Xd& points,
                      StepResult& result) {
  const double lost = damping_rate_ * time_step_ / 2;
  const double momentum_factor = started_ ? (1 - lost) / (1 + lost) : 0;
  const double share = started_ ? time_step_ / (1 + lost) : time_step_ / 2;
  next_ = momentum_factor * velocities_ + share * (forces * inverse_masses_.asDiagonal());
  result.movement = time_step_ * std::sqrt(next_.colwise().squaredNorm().maxCoeff());
  if (!next_.allFinite() || !std::isfinite(result.movement)) return;
  velocities_.swap(next_);
  points += time_step_ * velocities_;
  started_ = true;
  result.status = StepStatus::good;
  result.c_m = 1;
}

double VerletStep::momentum() const {
  const double speed = velocities_.norm() / std::sqrt(static_cast<double>(velocities_.cols()));
  return speed > 0 ? speed / damping_rate_ : 0;
}

}  // namespace dlo::force_model
