#pragma once

#include <Eigen/Core>
#include <chrono>
#include <limits>

#include "dlo/force_model/relax.hpp"
#include "dlo/force_model/tangent_stiffness.hpp"
#include "step_control.hpp"

namespace dlo::force_model {

/// A shape on its way to rest.
struct MovingShape {
  const Eigen::Matrix3Xd& points;  ///< [m]
  const Eigen::Matrix3Xd& forces;  ///< on the free points, zero on rigidly held ones [N]
  double momentum = 0;  ///< RMS of the movements that the last one still brings about [m]
};

/// Decides when a rod rests, see Simulation::relax. Allocates.
class RestSearch {
 public:
  /// @param rod, estimate  outlive this
  RestSearch(const Rod& rod, const ModeEstimate& estimate, const RelaxOptions& options);

  /// Whether another step is to be made.
  [[nodiscard]] bool open() const;

  /// Takes note of a step. @return whether look() is due
  [[nodiscard]] bool count(const StepResult& step);

  /// Takes note of a step that took so many solves.
  void count_newton_steps(const StepResult& step, long solves);

  /// Measures the shape and ends the search if it rests. @return as look()
  [[nodiscard]] Eigen::Matrix3Xd judge(const MovingShape& shape);

  /// Ends the search: no step changes anything any more.
  void stall() { result_.status = RelaxStatus::stalled; }

  /// Ends the search if the shape rests. @return for an equilibrium that does not hold the movement
  /// in which it gives way, see EquilibriumCheck; else nothing, 3 x 0
  [[nodiscard]] Eigen::Matrix3Xd look(const MovingShape& shape);

  /// Whether the last look found the rod at an equilibrium after many steps, yet moving on: a point
  /// that barely touches a wall may bounce on it forever by less than matters for the shape, but
  /// not for the forces. Steps without momentum (StepControl::descend) end that.
  [[nodiscard]] bool bounces() const { return bounces_; }

  /// Stiffness of the slowest mode, if the last look found the rod on its way to a proven
  /// equilibrium but not there, or its cheap signs of rest wrong; else infinity [N/m].
  [[nodiscard]] double slowest_mode() const { return slowest_mode_; }

  /// The outcome; a shape that has used up its steps is measured.
  [[nodiscard]] RelaxResult finish(const MovingShape& shape);

 private:
  void look_at_clock();
  EquilibriumCheck measure(const MovingShape& shape);
  /// Of the shape that was measured last.
  [[nodiscard]] bool rests(const EquilibriumCheck& check) const;

  const Rod& rod_;
  const ModeEstimate& estimate_;
  RelaxOptions options_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  double target_ = 0;
  long next_check_ = 2 * block_steps;
  long next_measurement_ = 0;  // at the latest
  bool bounces_ = false;
  /// Distance to rest before the last descent; infinite if the last look led to none.
  double descended_from_ = std::numeric_limits<double>::infinity();
  bool looked_without_force_ = false;
  int neutral_modes_ = 0;
  double slowest_mode_ = std::numeric_limits<double>::infinity();
  RelaxResult result_;
};

}  // namespace dlo::force_model
