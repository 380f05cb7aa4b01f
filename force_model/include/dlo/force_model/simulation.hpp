#pragma once

#include <Eigen/Core>
#include <string>

#include "dlo/force_model/rod.hpp"
#include "dlo/force_model/step_size.hpp"
#include "dlo/force_model/stepper.hpp"

namespace dlo::force_model {

struct RelaxOptions {
  /// Stop when the estimated distance to the rest shape falls below this share of the rod's length
  /// [-], > 0; or below what rounding of stiff segments' forces leaves, if that is more.
  double tolerance = 1e-7;
  long max_steps = 2'000'000;
};

enum class RelaxStatus { diverged, step_limit, at_rest };

[[nodiscard]] const char* to_string(RelaxStatus status);

/// Outcome of a simulation that was to come to rest.
struct [[nodiscard]] RelaxResult {
  RelaxStatus status = RelaxStatus::diverged;
  std::string message = "never ran";
  long steps = 0;
  double residual_force = -1;   ///< largest force on a free point [N]
  double remaining_error = -1;  ///< estimated RMS distance of the points to rest [m]
};

/// A rod and its points in simulated time. Steps allocate nothing.
class Simulation {
 public:
  /// @param points  start [m], 3 x rod.points(); rigidly held points are set to their targets
  /// @throws std::invalid_argument if rod, points or options are out of range
  Simulation(Rod rod, Eigen::Matrix3Xd points, const StepOptions& options);

  /// One simulation step.
  [[nodiscard]] StepResult step();

  /// The catch-up loop of Text 1: steps until the sum of c_m has grown by `steps`, so that a force
  /// goes on meaning a displacement per second while movements are scaled down.
  /// @param steps  nominal steps, > 0; @param max_steps  gives up after so many evaluations
  /// @return the last step's result (c_m = 0 if none was owed); `diverged` if one diverged
  [[nodiscard]] StepResult advance(double steps, long max_steps = 10'000'000);

  /// Steps until the rod rests. A shape is at rest when its tangent stiffness is positive definite
  /// and both Newton's step to the equilibrium and the momentum that is left are below the
  /// tolerance: a small force or movement alone proves nothing, as the paper's creeping shapes
  /// show. A rod that balances in an unstable equilibrium is nudged by 1e-6 of its length.
  /// Allocates.
  RelaxResult relax(const RelaxOptions& options = {});

  /// Moves a gripper. @throws std::invalid_argument if the grip or the shape does not exist
  void move_grip(std::size_t grip, const Eigen::Ref<const Eigen::Matrix3Xd>& targets,
                 const Eigen::Vector3d& reference);

  /// Replaces a wall, whatever it does to the rod: a wall that is not there yet has stiffness 0.
  /// Automatic steps suit it from the next step on.
  /// @throws std::invalid_argument if there is no such wall or the new one is out of range
  void move_wall(std::size_t wall, const Wall& moved);

  [[nodiscard]] const Rod& rod() const { return rod_; }
  [[nodiscard]] const Eigen::Matrix3Xd& points() const { return points_; }
  [[nodiscard]] const StepOptions& options() const { return options_; }

  // Counters since construction (paper, Tables 2 to 4).
  [[nodiscard]] long steps() const { return steps_; }
  [[nodiscard]] long damped_steps() const { return damped_steps_; }    ///< c_s was not 1
  [[nodiscard]] long limited_steps() const { return limited_steps_; }  ///< d_m was above l_s

 private:
  void compute_forces();
  void choose_step();
  [[nodiscard]] double largest_movement() const;
  void update_damping();
  void nudge();

  Rod rod_;
  StepOptions options_;
  Eigen::Matrix3Xd points_;
  Eigen::Matrix3Xd forces_;
  Eigen::Matrix3Xd movement_;  // of the last step, the dP of Formula 19
  Eigen::Matrix3Xd proposed_;  // of this step, before scaling
  Eigen::ArrayXd free_;        // 1 for points that move, 0 for rigidly held ones
  Eigen::ArrayX<bool> turned_back_;
  double c_s_ = 1;
  double rounding_ = 0;    // smallest movement that counts as oscillation [m]
  double owed_steps_ = 0;  // expected minus reached sum of c_m (Text 1)
  long steps_ = 0;
  long damped_steps_ = 0;
  long limited_steps_ = 0;

  // Estimate of the slowest mode that still moves: -dF.dP / dP.dP over blocks of steps, older
  // blocks fading out.
  ModeBounds modes_;
  double slowest_expected_ = 0;  // before anything moved
  Eigen::Matrix3Xd block_points_;
  Eigen::Matrix3Xd block_forces_;
  double force_change_ = 0;
  double point_change_ = 0;
  bool block_open_ = false;
};

}  // namespace dlo::force_model
