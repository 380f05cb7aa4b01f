#pragma once

#include <Eigen/Core>
#include <vector>

#include "band_matrix.hpp"
#include "dlo/force_model/rod.hpp"
#include "dlo/force_model/stepper.hpp"
#include "retraction.hpp"

namespace dlo::force_model {

/// The steps of Integration::implicit_euler, which says what they solve. Only the constructor
/// allocates.
class ImplicitStep {
 public:
  /// @param rod  checked
  /// @throws std::invalid_argument if it is twisted, or the options ask for masses that it lacks
  ImplicitStep(const Rod& rod, const Eigen::Matrix3Xd& points, const StepOptions& options);

  /// One step to the rod's targets. Its points, and how many Newton steps it took, are
  /// points() and newton_steps().
  /// @param rod  the constructor's, with whatever targets and walls it has now
  [[nodiscard]] StepResult step(const Rod& rod);

  [[nodiscard]] const Eigen::Matrix3Xd& points() const { return points_; }  ///< [m]
  /// Moves the points without a step, as a nudge does.
  void set_points(const Eigen::Matrix3Xd& points) { points_ = points; }
  /// Linear solves of the last step.
  [[nodiscard]] int newton_steps() const { return newton_steps_; }
  /// Whether the last step was Newton's own, of a positive definite stiffness and in full length.
  [[nodiscard]] bool pure() const { return pure_; }
  /// RMS of the last step's movements [m].
  [[nodiscard]] double movement() const { return movement_rms_; }
  /// RMS of what the velocities still bring about [m]; infinite without damping.
  [[nodiscard]] double momentum() const;

 private:
  void open_segments(const Rod& rod);
  /// movement_ of the held points: to where the grips are now; 0 of the others.
  void lead_held_points(const Rod& rod);
  /// Into trial_. @return the share of Newton's movement that was made; 0: none, nothing helps
  [[nodiscard]] double newton_step(const Rod& rod, bool gripper_moves);
  void assemble(const Rod& rod);
  [[nodiscard]] bool solve(const Rod& rod);
  [[nodiscard]] bool solve_linear();
  void press(const Wall& wall, Eigen::Index i, double depth, double sign);
  /// Calls action(wall, point, touches) for each free point and wall.
  template <typename Action>
  void for_each_wall_point(const Rod& rod, const Action& action) {
    auto touches = touches_.begin();
    for (const Wall& wall : rod.walls) {
      for (Eigen::Index i = 0; i < points_.cols(); ++i, ++touches) {
        if (is_free_[static_cast<std::size_t>(i)] != 0) action(wall, i, *touches);
      }
    }
  }
  /// As far along the movement as it is worth, into trial_. @return the share; 0: not at all
  [[nodiscard]] double search(const Rod& rod, bool gripper_moves);
  [[nodiscard]] double potential(const Rod& rod, const Eigen::Matrix3Xd& points) const;

  [[nodiscard]] bool in_time() const { return inertia_.size() > 0; }

  std::vector<char> is_free_;
  bool in_plane_ = false;
  double unit_ = 0;         // stiffness of the slowest mode, about [N/m]
  double energy_unit_ = 0;  // EI / l and what the loads do over l, about [J]
  double time_step_ = 0;
  double damping_rate_ = 0;
  Eigen::VectorXd inertia_;  // m (1 + c dt) / dt^2 [N/m]; empty without time
  Eigen::VectorXd masses_;   // over dt [kg/s]
  Eigen::Matrix3Xd points_;
  Eigen::Matrix3Xd start_;  // of this step
  Eigen::Matrix3Xd velocities_;
  Eigen::Matrix3Xd trial_;
  Eigen::Matrix3Xd forces_;  // of potential(), on all points
  Eigen::Matrix3Xd movement_;
  Eigen::Matrix3Xd product_;
  BandMatrix stiffness_;
  BandFactor factor_;
  Retraction retraction_;
  std::vector<char> touches_;  // 1 for points that a wall presses in the quadratic model
  double walls_energy_ = 0;    // of that model at no movement, less what it is [J]
  double shift_ = 0;           // [N/m]
  double energy_ = 0;          // of points_
  bool energy_known_ = false;
  int newton_steps_ = 0;
  bool pure_ = false;
  double movement_rms_ = 0;
};

}  // namespace dlo::force_model
