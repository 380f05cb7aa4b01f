#pragma once

#include <Eigen/Core>

#include "dlo/force_model/rod.hpp"
#include "dlo/force_model/stepper.hpp"

namespace dlo::force_model {

/// Computes the steps of Integration::verlet. Only the constructor allocates.
class VerletStep {
 public:
  /// @throws std::invalid_argument unless there is a mass per point, > 0 for each free point
  VerletStep(const Rod& rod, const StepOptions& options);

  /// Makes a step. @param forces  forces on the free points, 0 on rigidly held ones [N]
  /// @param[in,out] points  unchanged if the step diverges [m]; both 3 x N
  void step(const Eigen::Matrix3Xd& forces, Eigen::Matrix3Xd& points, StepResult& result);

  /// Returns the RMS of the movements that the velocities still cause, v/c [m]; infinite without
  /// damping.
  [[nodiscard]] double momentum() const;

 private:
  double time_step_ = 0;
  double damping_rate_ = 0;
  bool started_ = false;
  Eigen::VectorXd inverse_masses_;  // 0 of rigidly held points [1/kg]
  Eigen::Matrix3Xd velocities_;     // velocities half a step before the time of the points [m/s]
  Eigen::Matrix3Xd next_;
};

}  // namespace dlo::force_model
