#include "dlo/force_model/simulation.hpp"

#include <span>
#include <utility>

#include "lockstep.hpp"
#include "require.hpp"

namespace dlo::force_model {
namespace {

/// The sum of c_m reaches whole numbers only up to rounding. A difference below this needs no
/// further step [steps].
constexpr double rounding_of_sum = 5e-7;

}  // namespace

Simulation::Simulation(Rod rod, Eigen::Matrix3Xd points, const StepOptions& options) {
  const BatchRod start{std::move(rod), std::move(points), options};
  batch_block_ = std::make_unique<BatchBlock>(std::span(&start, 1), false);
}

Simulation::Simulation(const Simulation& other)
    : batch_block_(std::make_unique<BatchBlock>(*other.batch_block_)),
      remaining_steps_(other.remaining_steps_) {}

Simulation& Simulation::operator=(const Simulation& other) {
  if (this != &other) *this = Simulation(other);
  return *this;
}

Simulation::Simulation(Simulation&& other) noexcept = default;
Simulation& Simulation::operator=(Simulation&& other) noexcept = default;
Simulation::~Simulation() = default;

StepResult Simulation::step() {
  StepResult result;
  batch_block_->step(std::span(&result, 1));
  return result;
}

StepResult Simulation::advance(double steps, long max_steps) {
  require_positive("Simulation::advance", "steps", steps);
  remaining_steps_ += steps;
  StepResult result{.status = StepStatus::good};
  // Text 1 makes a step even when none is due. Calls for less than one step would then run ahead.
  for (long i = 0; i < max_steps && remaining_steps_ > rounding_of_sum; ++i) {
    result = step();
    if (result.status == StepStatus::diverged) break;
    remaining_steps_ -= result.c_m;
  }
  if (result.status == StepStatus::good && remaining_steps_ > rounding_of_sum)
    result.status = StepStatus::behind;
  return result;
}

RelaxResult Simulation::relax(const RelaxOptions& options) {
  return batch_block_->relax(options).front();
}

void Simulation::move_grip(std::size_t grip, const Eigen::Ref<const Eigen::Matrix3Xd>& targets,
                           const Eigen::Vector3d& reference) {
  batch_block_->move_grip(0, grip, targets, reference);
}

void Simulation::move_grip(std::size_t grip, const Eigen::Ref<const Eigen::Matrix3Xd>& targets,
                           const Eigen::Vector3d& reference, const Eigen::Vector3d& d1) {
  batch_block_->move_grip(0, grip, targets, reference, &d1);
}

void Simulation::move_wall(std::size_t wall, const Wall& moved) {
  batch_block_->move_wall(0, wall, moved);
}

double Simulation::remaining_steps() const { return remaining_steps_; }

const Rod& Simulation::rod() const { return batch_block_->rod(0); }
Eigen::Matrix3Xd Simulation::points() const { return batch_block_->points(0); }
void Simulation::copy_points(Eigen::Matrix3Xd& points) const {
  batch_block_->copy_points(0, points);
}
const StepOptions& Simulation::options() const { return batch_block_->control(0).options(); }
long Simulation::steps() const { return batch_block_->control(0).steps(); }
long Simulation::damped_steps() const { return batch_block_->control(0).damped_steps(); }
long Simulation::limited_steps() const { return batch_block_->control(0).limited_steps(); }

}  // namespace dlo::force_model
