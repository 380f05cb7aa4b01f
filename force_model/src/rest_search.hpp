#pragma once

#include <Eigen/Core>
#include <chrono>
#include <limits>

#include "dlo/force_model/relax.hpp"
#include "dlo/force_model/tangent_stiffness.hpp"
#include "step_control.hpp"

namespace dlo::force_model {

/// Present shape of a rod that approaches rest.
struct MovingShape {
  const Eigen::Matrix3Xd& points;  ///< [m]
  const Eigen::Matrix3Xd& forces;  ///< forces on free points, zero on rigidly held ones [N]
  double momentum = 0;             ///< RMS of the movements that the last movement still causes [m]
};

/// Decides when a rod is at rest, see Simulation::relax. Allocates.
class RestSearch {
 public:
  /// Begins a search. @param rod, estimate  must outlive this object
  RestSearch(const Rod& rod, const ModeEstimate& estimate, const RelaxOptions& options);

  /// Whether another step is to be made.
  [[nodiscard]] bool may_continue() const;

  /// Counts a step. @return whether check_rest() is due
  [[nodiscard]] bool count(const StepResult& step);

  /// Counts a step that took several linear solves.
  void count_newton_steps(const StepResult& step, long solves);

  /// Measures the shape and ends the search if it is at rest. @return as check_rest()
  [[nodiscard]] Eigen::Matrix3Xd end_if_at_rest(const MovingShape& shape);

  /// Ends the search, because no step changes the shape any more.
  void end_as_stalled() { result_.status = RelaxStatus::stalled; }

  /// Ends the search if the shape is at rest. @return for an unstable equilibrium its direction of
  /// negative curvature, see EquilibriumCheck; else empty, 3 x 0
  [[nodiscard]] Eigen::Matrix3Xd check_rest(const MovingShape& shape);

  /// Whether the last check_rest() found the rod close to an equilibrium after many steps, but
  /// still moving. A point that barely touches a wall may bounce on it forever, by an amount that
  /// matters for the forces but not for the shape. Steps without momentum (StepControl::descend)
  /// end this.
  [[nodiscard]] bool bounces() const { return bounces_; }

  /// Returns the stiffness of the slowest mode if the last check_rest() found the rod near a proven
  /// equilibrium but not at rest, or found the simple signs of rest wrong; else infinity [N/m].
  [[nodiscard]] double slowest_mode() const { return slowest_mode_; }

  /// Returns the result. Unless the search found rest or diverged, the final shape is measured,
  /// which may be at rest.
  [[nodiscard]] RelaxResult finish(const MovingShape& shape);

 private:
  void check_clock();
  EquilibriumCheck measure(const MovingShape& shape);
  /// Whether the last measured shape is at rest.
  [[nodiscard]] bool is_at_rest(const EquilibriumCheck& check) const;

  const Rod& rod_;
  const ModeEstimate& estimate_;
  RelaxOptions options_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  double target_ = 0;
  long next_check_ = 2 * block_steps;
  long next_measurement_ = 0;  // at the latest at this step
  bool bounces_ = false;
  /// Distance from rest before the last descent; infinite if the last check_rest() started none.
  double descended_from_ = std::numeric_limits<double>::infinity();
  bool measured_without_force_ = false;
  int neutral_modes_ = 0;
  double slowest_mode_ = std::numeric_limits<double>::infinity();
  RelaxResult result_;
};

}  // namespace dlo::force_model
