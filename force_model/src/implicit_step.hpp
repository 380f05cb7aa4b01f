#pragma once

#include <Eigen/Core>
#include <vector>

#include "band_matrix.hpp"
#include "dlo/force_model/rod.hpp"
#include "dlo/force_model/stepper.hpp"
#include "retraction.hpp"

namespace dlo::force_model {

/// Computes the steps of Integration::implicit_euler, where the equations are stated. Only the
/// constructor allocates.
class ImplicitStep {
 public:
  /// Creates the stepper. @param rod  checked
  /// @throws std::invalid_argument if the rod is twisted, or the options require masses that it
  /// lacks
  ImplicitStep(const Rod& rod, const Eigen::Matrix3Xd& points, const StepOptions& options);

  /// Makes one step with the rod's present targets and walls. points() and newton_steps() return
  /// its results.
  /// @param rod  the constructor's rod, with any targets and walls
  [[nodiscard]] StepResult step(const Rod& rod);

  [[nodiscard]] const Eigen::Matrix3Xd& points() const { return points_; }  ///< [m]
  /// Moves the points without a step, for a small displacement from an unstable equilibrium.
  void set_points(const Eigen::Matrix3Xd& points) { points_ = points; }
  /// Returns the number of linear solves of the last step.
  [[nodiscard]] int newton_steps() const { return newton_steps_; }
  /// Whether the last step was a full Newton step with a positive definite stiffness.
  [[nodiscard]] bool was_full_newton_step() const { return was_full_newton_step_; }
  /// Returns the RMS movement of the points in the last step [m].
  [[nodiscard]] double movement() const { return movement_rms_; }
  /// Returns the RMS movement that the present velocities still cause [m]; infinite without
  /// damping, 0 without masses.
  [[nodiscard]] double momentum() const;

 private:
  void open_segments(const Rod& rod);
  /// Sets movement_: of held points to the present targets of their grips, of others to 0.
  void set_held_movements(const Rod& rod);
  /// Makes a Newton step into trial_. @return fraction of the Newton step that was made; 0 if none
  /// reduces the energy
  [[nodiscard]] double newton_step(const Rod& rod, bool gripper_moves);
  void assemble(const Rod& rod);
  [[nodiscard]] bool solve(const Rod& rod);
  [[nodiscard]] bool solve_linear();
  void add_wall_contribution(const Wall& wall, Eigen::Index i, double depth, double sign);
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
  /// Searches along the movement, into trial_. @return fraction of the movement; 0 if none reduces
  /// the energy enough
  [[nodiscard]] double search(const Rod& rod, bool gripper_moves);
  [[nodiscard]] double potential(const Rod& rod, const Eigen::Matrix3Xd& points) const;

  [[nodiscard]] bool is_dynamic() const { return inertia_.size() > 0; }

  std::vector<char> is_free_;
  bool in_plane_ = false;
  double unit_ = 0;         // approximate stiffness of the slowest mode [N/m]
  double energy_unit_ = 0;  // magnitude of energies: unit_ times l^2 plus the loads times l [J]
  double time_step_ = 0;
  double damping_rate_ = 0;
  Eigen::VectorXd inertia_;  // m (1 + c dt) / dt^2 [N/m]; empty without time
  Eigen::VectorXd masses_;   // masses divided by dt [kg/s]
  Eigen::Matrix3Xd points_;
  Eigen::Matrix3Xd start_;  // points at the beginning of this step
  Eigen::Matrix3Xd velocities_;
  Eigen::Matrix3Xd trial_;
  Eigen::Matrix3Xd forces_;  // forces on all points, of potential()
  Eigen::Matrix3Xd movement_;
  Eigen::Matrix3Xd product_;
  BandMatrix stiffness_;
  BandFactor factor_;
  Retraction retraction_;
  std::vector<char> touches_;  // 1 for points that touch a wall in the quadratic model
  // Energy of the walls in that model at zero movement, minus the present one [J].
  double walls_energy_ = 0;
  double shift_ = 0;   // [N/m]
  double energy_ = 0;  // energy of points_ [J]
  bool energy_known_ = false;
  int newton_steps_ = 0;
  bool was_full_newton_step_ = false;
  double movement_rms_ = 0;
};

}  // namespace dlo::force_model
