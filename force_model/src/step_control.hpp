#pragma once

#include <Eigen/Core>

#include "dlo/force_model/stepper.hpp"
#include "mode_estimate.hpp"

namespace dlo::force_model {

/// Number of steps between two measurements of the modes.
inline constexpr long block_steps = 16;

/// Number of steps of a descent without momentum.
inline constexpr long descent_steps = 64 * block_steps;

/// Step constants, mode estimate and counters of one rod, without its points.
class StepControl {
 public:
  /// @throws std::invalid_argument if the options are out of range
  StepControl(const Rod& rod, const Eigen::Matrix3Xd& points, const StepOptions& options);

  /// Whether this step begins with a measurement of the modes.
  [[nodiscard]] bool measures_modes() const { return steps_ % block_steps == 0; }

  /// Updates the modes and, for the automatic policy, c_F and c_h. Arguments as ModeEstimate's.
  void update_modes(double inner_mode, double force_change, double point_change);

  /// Updates the bound of the modes after a change of the rod's walls; forces before and after it
  /// are not compared.
  void change_environment(const Rod& rod, const Eigen::Matrix3Xd& points);

  /// Requests that the next descent_steps steps have no momentum and c_F = 1/fastest, so that the
  /// potential energy decreases with each. Has an effect with the automatic policy only.
  void descend();

  /// Corrects the estimate of the slowest mode. @param slowest  stiffness of the slowest mode in
  /// the present shape; infinity: unknown [N/m]
  void correct_slowest_mode(double slowest);

  /// Determines the scaling of a proposed step.
  /// @param largest_squared  largest square of the movements that the limit compares [m^2]
  /// @param sum_squared      not finite if a movement is not [m^2]
  /// @param oscillating      number of points that reversed their direction in two consecutive
  /// steps
  /// @param[out] result      result of the step
  void decide(double largest_squared, double sum_squared, double oscillating, StepResult& result);

  /// Counts a step that was computed elsewhere. @param evaluations  number of its evaluations
  void count(const StepResult& result, long evaluations);

  /// Returns c_h, or 0 for policies without momentum.
  [[nodiscard]] double momentum_factor() const {
    return options_.policy.momentum ? options_.c_h : 0;
  }
  [[nodiscard]] bool relative() const { return options_.policy.limit == StepLimit::relative; }

  [[nodiscard]] const StepOptions& options() const { return options_; }
  [[nodiscard]] const ModeEstimate& estimate() const { return estimate_; }
  [[nodiscard]] long steps() const { return steps_; }
  [[nodiscard]] long damped_steps() const { return damped_steps_; }
  [[nodiscard]] long limited_steps() const { return limited_steps_; }

 private:
  void choose_constants();
  [[nodiscard]] bool descends() const { return steps_ < descends_until_; }

  StepOptions options_;
  ModeEstimate estimate_;
  long descends_until_ = 0;  // number of steps at which the descent ends
  double c_s_ = 1;
  long steps_ = 0;
  long damped_steps_ = 0;
  long limited_steps_ = 0;
};

}  // namespace dlo::force_model
