#pragma once

#include <Eigen/Core>
#include <memory>

#include "dlo/force_model/relax.hpp"
#include "dlo/force_model/rod.hpp"
#include "dlo/force_model/step_size.hpp"
#include "dlo/force_model/stepper.hpp"

namespace dlo::force_model {

class Lockstep;

/// A rod and its points in simulated time. Steps allocate nothing; they run on a kernel that is
/// vectorised over the points and agrees with total_forces to rounding.
class Simulation {
 public:
  /// @param points  start [m], 3 x rod.points(); rigidly held points are set to their targets
  /// @throws std::invalid_argument if rod, points or options are out of range
  Simulation(Rod rod, Eigen::Matrix3Xd points, const StepOptions& options);
  /// Copies time and counters as well.
  Simulation(const Simulation& other);
  Simulation& operator=(const Simulation& other);  ///< Copies time and counters as well.
  /// Leaves the other without a rod: assign to it or destroy it.
  Simulation(Simulation&& other) noexcept;
  Simulation& operator=(Simulation&& other) noexcept;  ///< As the constructor.
  ~Simulation();

  /// One simulation step.
  [[nodiscard]] StepResult step();

  /// The catch-up loop of Text 1: steps until the sum of c_m has grown by `steps`, so that a force
  /// goes on meaning a displacement per second while movements are scaled down.
  /// @param steps  nominal steps, > 0; @param max_steps  gives up after so many evaluations
  /// @return the last step's result (c_m = 0 if none was owed); `diverged` if one diverged,
  ///         `behind` if max_steps were not enough: owed_steps() are left to the next call
  [[nodiscard]] StepResult advance(double steps, long max_steps = 10'000'000);

  /// What advance() still owes: nominal steps asked for minus the sum of c_m; below 0 after an
  /// overshoot, which is less than a step.
  [[nodiscard]] double owed_steps() const;

  /// Steps until the rod rests. A shape is at rest when its tangent stiffness is positive definite
  /// and both Newton's step to the equilibrium and the momentum that is left are below the
  /// tolerance: a small force or movement alone proves nothing, as the paper's creeping shapes
  /// show. A rod that balances in an unstable equilibrium is nudged by 1e-6 of
  /// its length in the direction in which it gives way.
  /// Allocates.
  RelaxResult relax(const RelaxOptions& options = {});

  /// Moves a gripper; a frame that it holds comes along by the shortest turn of its segment.
  /// @throws std::invalid_argument if the grip or the shape does not exist
  void move_grip(std::size_t grip, const Eigen::Ref<const Eigen::Matrix3Xd>& targets,
                 const Eigen::Vector3d& reference);
  /// Moves and turns a gripper that holds the rod's frame. Whole turns are counted from call to
  /// call where a step lies between them and each turns it by less than half a turn.
  /// @param d1  Grip::d1
  /// @throws std::invalid_argument as above, or if the grip holds no frame or d1 points along it
  void move_grip(std::size_t grip, const Eigen::Ref<const Eigen::Matrix3Xd>& targets,
                 const Eigen::Vector3d& reference, const Eigen::Vector3d& d1);

  /// Replaces a wall, whatever it does to the rod: a wall that is not there yet has stiffness 0.
  /// Automatic steps suit it from the next step on.
  /// @throws std::invalid_argument if there is no such wall or the new one is out of range
  void move_wall(std::size_t wall, const Wall& moved);

  /// As moved, with the twist of the last step in Twist::angles.
  [[nodiscard]] const Rod& rod() const;
  [[nodiscard]] Eigen::Matrix3Xd points() const;  ///< positions now [m], a copy
  /// The same without an allocation. @param[out] points  3 x rod().points(), as it is
  void copy_points(Eigen::Matrix3Xd& points) const;
  /// As given; automatic constants filled in.
  [[nodiscard]] const StepOptions& options() const;

  // Counters since construction (paper, Tables 2 to 4).
  /// Model evaluations; of implicit steps linear solves.
  [[nodiscard]] long steps() const;
  [[nodiscard]] long damped_steps() const;   ///< c_s was not 1
  [[nodiscard]] long limited_steps() const;  ///< d_m was above l_s, or StepResult::limited

 private:
  std::unique_ptr<Lockstep> lockstep_;
  double owed_steps_ = 0;  // expected minus reached sum of c_m (Text 1)
};

}  // namespace dlo::force_model
