#pragma once

#include <Eigen/Eigenvalues>
#include <cmath>

#include "../helpers.hpp"
#include "dlo/force_model/simulation.hpp"
#include "dlo/force_model/tangent_stiffness.hpp"
#include "rods.hpp"

namespace dlo::test {

/// A nearly straight rod of few points that is released under a load so small that it stays linear:
/// each mode is a damped oscillator, whose way is known.
struct Oscillation {
  force_model::Rod rod;
  Eigen::Matrix3Xd straight;
  double damping_rate = 0;
  double time = 0;  ///< about half a period of the first mode [s]
  Eigen::Matrix3Xd exact;

  Oscillation() {
    SteelRod steel;
    steel.points = 6;
    steel.weight_per_length *= 1e-6;
    rod = steel.rod({force_model::BendingLaw::hooke, steel.EI}, 2000);
    straight = steel.straight();
    rod.masses = Eigen::VectorXd::LinSpaced(steel.points, 0.8e-3, 1.4e-3);
    const force_model::StiffnessMatrix K = force_model::tangent_stiffness(rod, straight);
    const auto size = K.entries.rows();
    Eigen::MatrixXd M = Eigen::MatrixXd::Zero(size, size);
    Eigen::VectorXd load(size);
    for (std::size_t k = 0; k < K.points.size(); ++k) {
      const auto row = static_cast<Eigen::Index>(3 * k);
      M.diagonal().segment<3>(row).setConstant(rod.masses[K.points[k]]);
      load.segment<3>(row) = rod.loads.col(K.points[k]);
    }
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> modes(K.entries, M);
    const Eigen::VectorXd& squares = modes.eigenvalues();
    damping_rate = 0.4 * std::sqrt(squares[0]);
    time = 3 / std::sqrt(squares[0]);
    Eigen::VectorXd amplitudes = modes.eigenvectors().transpose() * load;
    for (Eigen::Index k = 0; k < size; ++k) {
      // q'' + c q' + w^2 q = f from rest, underdamped
      const double decay = damping_rate / 2;
      const double w = std::sqrt(squares[k] - decay * decay);
      amplitudes[k] *=
          (1 - std::exp(-decay * time) * (std::cos(w * time) + decay / w * std::sin(w * time))) /
          squares[k];
    }
    const Eigen::VectorXd way = modes.eigenvectors() * amplitudes;
    exact = straight;
    for (std::size_t k = 0; k < K.points.size(); ++k) {
      exact.col(K.points[k]) += way.segment<3>(static_cast<Eigen::Index>(3 * k));
    }
  }

  /// Returns the distance of a stepper's shape at `time` from `exact`, divided by the movement
  /// until then [-]; infinite if a step fails.
  [[nodiscard]] double error(force_model::Stepper stepper, int steps) const {
    force_model::StepOptions options;
    options.policy = force_model::policy(stepper);
    options.time_step = time / steps;
    options.damping_rate = damping_rate;
    force_model::Simulation simulation(rod, straight, options);
    for (int i = 0; i < steps; ++i) {
      if (simulation.step().status != force_model::StepStatus::good) return INFINITY;
    }
    return (simulation.points() - exact).norm() / (exact - straight).norm();
  }
};

}  // namespace dlo::test
