#pragma once

#include <Eigen/Core>
#include <memory>

#include "dlo/force_model/relax.hpp"
#include "dlo/force_model/rod.hpp"
#include "dlo/force_model/step_size.hpp"
#include "dlo/force_model/stepper.hpp"

namespace dlo::force_model {

class BatchBlock;

/// Rod whose points move in simulated time. Steps do not allocate. Implicit steps use total_forces.
/// Others run on a kernel that is vectorised over the points and agrees with it to rounding.
class Simulation {
 public:
  /// Creates a simulation. @param points  initial positions [m], 3 x rod.points(); rigidly held
  /// points are set to their targets
  /// @throws std::invalid_argument if rod, points or options are out of range
  Simulation(Rod rod, Eigen::Matrix3Xd points, const StepOptions& options);
  /// Copies the simulation with its time and counters.
  Simulation(const Simulation& other);
  /// Copies the simulation with its time and counters.
  Simulation& operator=(const Simulation& other);
  /// Leaves `other` without a rod: it may only be assigned to or destroyed.
  Simulation(Simulation&& other) noexcept;
  /// Leaves `other` as the move constructor does.
  Simulation& operator=(Simulation&& other) noexcept;
  ~Simulation();

  /// Makes one simulation step.
  [[nodiscard]] StepResult step();

  /// Runs the catch-up loop of Text 1: makes steps until the sum of c_m has grown by `steps`. A
  /// force thus corresponds to a displacement per second even while movements are scaled down.
  /// @param steps  nominal steps, > 0; @param max_steps  largest number of steps
  /// @return the result of the last step (c_m = 0 if none was due); `diverged` if one diverged,
  /// `behind` if max_steps did not suffice: remaining_steps() then remain for the next call
  [[nodiscard]] StepResult advance(double steps, long max_steps = 10'000'000);

  /// Returns the nominal steps that advance() has still to make: requested steps minus the sum of
  /// c_m. It is negative after an overshoot, which is less than a step.
  [[nodiscard]] double remaining_steps() const;

  /// Steps until the rod is at rest or a limit of the options is reached. A shape is at rest if
  /// check_equilibrium finds it stable and proven, and both its remaining_error and the remaining
  /// momentum are below the tolerance, or below EquilibriumCheck::rounding_error if that is larger.
  /// A small force or movement alone proves nothing, as the paper's creeping shapes show. A rod in
  /// an unstable equilibrium is displaced by 1e-6 of its length in a direction of negative
  /// curvature. Allocates.
  /// @throws std::invalid_argument if an option is out of range
  RelaxResult relax(const RelaxOptions& options = {});

  /// Moves a gripper; a frame that it holds follows by the smallest rotation of its segment.
  /// @throws std::invalid_argument if there is no such grip, if the targets are not one finite
  /// position per held point, if the reference is not finite, or if the targets move a rod with
  /// natural angles out of the plane z = 0
  void move_grip(std::size_t grip, const Eigen::Ref<const Eigen::Matrix3Xd>& targets,
                 const Eigen::Vector3d& reference);
  /// Moves and rotates a gripper that holds the rod's frame. Full rotations are counted from call
  /// to call, provided that there is a step between calls and each call rotates the frame by less
  /// than half a rotation.
  /// @param d1  see Grip::d1
  /// @throws std::invalid_argument as the function above, or if the grip holds no frame or d1 is
  /// parallel to its segment
  void move_grip(std::size_t grip, const Eigen::Ref<const Eigen::Matrix3Xd>& targets,
                 const Eigen::Vector3d& reference, const Eigen::Vector3d& d1);

  /// Replaces a wall, without a check of the resulting change of the rod. A wall that is to appear
  /// later has stiffness 0 until then. Automatic steps are adapted to it from the next step on.
  /// @throws std::invalid_argument if there is no such wall, if the new one is out of range, or if
  /// its normal leaves the plane z = 0 of a rod with natural angles
  void move_wall(std::size_t wall, const Wall& moved);

  /// Returns the rod with moved grips and walls, and the twist of the last step in Twist::angles.
  [[nodiscard]] const Rod& rod() const;
  [[nodiscard]] Eigen::Matrix3Xd points() const;  ///< positions now [m], a copy
  /// Copies the present positions without allocation. @param[out] points  3 x rod().points(),
  /// already of this size
  void copy_points(Eigen::Matrix3Xd& points) const;
  /// Returns the given options with automatic constants filled in.
  [[nodiscard]] const StepOptions& options() const;

  // Counters since construction (paper, Tables 2 to 4).
  /// Returns the number of model evaluations; of implicit steps the number of linear solves.
  [[nodiscard]] long steps() const;
  [[nodiscard]] long damped_steps() const;   ///< steps with c_s != 1
  [[nodiscard]] long limited_steps() const;  ///< steps with d_m > l_s, or StepResult::limited

 private:
  std::unique_ptr<BatchBlock> batch_block_;
  double remaining_steps_ = 0;  // expected minus reached sum of c_m (Text 1)
};

}  // namespace dlo::force_model
