#pragma once

#include <Eigen/Core>

#include "dlo/force_model/stepper.hpp"
#include "mode_estimate.hpp"

namespace dlo::force_model {

/// Steps between two looks at the modes.
inline constexpr long block_steps = 16;

/// Steps of a descent without momentum.
inline constexpr long descent_steps = 64 * block_steps;

/// What one rod's steps decide on and count: everything about them but the points.
class StepControl {
 public:
  /// @throws std::invalid_argument if the options are out of range
  StepControl(const Rod& rod, const Eigen::Matrix3Xd& points, const StepOptions& options);

  /// Whether this step begins with a look at the modes.
  [[nodiscard]] bool looks_at_modes() const { return steps_ % block_steps == 0; }

  /// Updates the modes and, for the automatic policy, c_F and c_h. Arguments as ModeEstimate's.
  void update_modes(double inner_mode, double force_change, double point_change);

  /// After a change of the rod's walls: the modes' bound is that of the new ones, and forces before
  /// and after are not compared.
  void change_environment(const Rod& rod, const Eigen::Matrix3Xd& points);

  /// With the automatic policy, makes the next descent_steps without momentum and with c_F =
  /// 1/fastest, so that the potential energy falls with each.
  void descend();

  /// @param slowest  stiffness of the slowest mode where the rod is; infinity: not known [N/m]
  void correct_slowest_mode(double slowest);

  /// Scaling of a proposed step.
  /// @param largest_squared  of the movements that the limit compares [m^2]
  /// @param sum_squared      not finite if a movement is not [m^2]
  /// @param oscillating      points that turned back in two consecutive steps
  /// @param[out] result      of the step
  void decide(double largest_squared, double sum_squared, double oscillating, StepResult& result);

  /// Takes note of a step that was decided elsewhere. @param evaluations  that it took
  void count(const StepResult& result, long evaluations);

  /// c_h, or 0 for policies without momentum.
  [[nodiscard]] double kept() const { return options_.policy.momentum ? options_.c_h : 0; }
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
  long descends_until_ = 0;  // in steps
  double c_s_ = 1;
  long steps_ = 0;
  long damped_steps_ = 0;
  long limited_steps_ = 0;
};

}  // namespace dlo::force_model
