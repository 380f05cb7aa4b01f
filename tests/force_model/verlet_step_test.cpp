// Tests of steps with velocities and real masses.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "dlo/force_model/batch.hpp"
#include "dlo/force_model/simulation.hpp"
#include "oscillation.hpp"
#include "rods.hpp"

namespace dlo::force_model {
namespace {

/// The paper's rod with its masses and a hundredth of its bending stiffness, and steps of a share
/// of the largest stable one.
struct Swinging {
  SteelRod steel;
  Rod rod;
  StepOptions options;

  explicit Swinging(double share = 0.5, double damping_rate = 0) {
    steel.EI /= 100;
    rod = steel.rod({BendingLaw::hooke, steel.EI}, 660);
    rod.masses = -rod.loads.row(1).transpose() / 9.81;
    const double fastest = mode_bounds(rod, steel.straight()).fastest;
    options.policy = policy(Stepper::verlet);
    options.time_step = share * 2 * std::sqrt(rod.masses[steel.points - 1] / fastest);
    options.damping_rate = damping_rate;
  }
};

TEST(VerletStepper, GoesThroughTimeWithSecondOrder) {
  const test::Oscillation oscillation;
  const double coarse = oscillation.error(Stepper::verlet, 800);
  const double fine = oscillation.error(Stepper::verlet, 1600);
  EXPECT_LT(coarse, 1e-2);
  EXPECT_NEAR(coarse / fine, 4, 0.2);
}

/// Returns the sum of kinetic and potential energy after each step but the last; velocities by
/// central differences.
std::vector<double> energies(const Swinging& swinging, int steps) {
  Simulation simulation(swinging.rod, swinging.steel.straight(), swinging.options);
  std::vector<double> result;
  Eigen::Matrix3Xd before = simulation.points();
  Eigen::Matrix3Xd now = before;
  for (int i = 0; i < steps; ++i) {
    EXPECT_EQ(simulation.step().status, StepStatus::good);
    const Eigen::Matrix3Xd next = simulation.points();
    if (i > 0) {
      const Eigen::VectorXd squares =
          ((next - before) / (2 * swinging.options.time_step)).colwise().squaredNorm();
      result.push_back(energy(swinging.rod, now).total() + swinging.rod.masses.dot(squares) / 2);
    }
    before = now;
    now = next;
  }
  return result;
}

TEST(VerletStepper, KeepsTheEnergyOfAFreelySwingingRod) {
  const Swinging swinging;
  const double start = energy(swinging.rod, swinging.steel.straight()).total();
  // Scale of the energies: the weight times a tenth of the length.
  const double size = swinging.steel.weight_per_length * std::pow(swinging.steel.length, 2) / 10;
  const auto largest_error = [&](const std::vector<double>& all) {
    double result = 0;
    for (const double one : all) result = std::max(result, std::abs(one - start));
    return result / size;
  };
  const double coarse = largest_error(energies(swinging, 20'000));
  const double fine = largest_error(energies(Swinging(0.25), 40'000));
  EXPECT_LT(coarse, 1e-4);
  EXPECT_LT(fine, coarse / 2);
}

TEST(VerletStepper, BlowsUpBeyondTheLargestStableStepAndSaysSo) {
  const Swinging wild(20);
  Simulation simulation(wild.rod, wild.steel.straight(), wild.options);
  bool diverged = false;
  for (int i = 0; i < 2000 && !diverged; ++i) {
    diverged = simulation.step().status == StepStatus::diverged;
  }
  EXPECT_TRUE(diverged);
  EXPECT_TRUE(simulation.points().allFinite());
}

TEST(VerletStepper, RestsWhereTheAutomaticStepperDoes) {
  Swinging damped(0.5, 20);
  damped.rod.walls = {{.point = {0, -0.2, 0}, .normal = {0, 1, 0}, .stiffness = 100}};
  Simulation simulation(damped.rod, damped.steel.straight(), damped.options);
  Simulation automatic(damped.rod, damped.steel.straight(), {});
  const RelaxResult result = simulation.relax({.tolerance = 1e-6});
  ASSERT_EQ(result.status, RelaxStatus::at_rest);
  ASSERT_EQ(automatic.relax({.tolerance = 1e-6}).status, RelaxStatus::at_rest);
  EXPECT_LT((simulation.points() - automatic.points()).norm() / 4, 2e-6 * damped.steel.length);
}

TEST(VerletStepper, IsNeverAtRestWithoutDamping) {
  const Swinging swinging;
  Simulation simulation(swinging.rod, swinging.steel.straight(), swinging.options);
  EXPECT_EQ(simulation.relax({.max_steps = 5000}).status, RelaxStatus::step_limit);
}

TEST(VerletStepper, RefusesWhatItCannotDo) {
  const Swinging swinging;
  const Eigen::Matrix3Xd straight = swinging.steel.straight();
  EXPECT_THROW(Batch({{swinging.rod, straight, swinging.options}}), std::invalid_argument);
  Rod weightless = swinging.rod;
  weightless.masses[7] = 0;
  EXPECT_THROW(Simulation(weightless, straight, swinging.options), std::invalid_argument);
  weightless.masses.resize(3);
  EXPECT_THROW(Simulation(weightless, straight, swinging.options), std::invalid_argument);
  StepOptions timeless = swinging.options;
  timeless.time_step = INFINITY;
  EXPECT_THROW(Simulation(swinging.rod, straight, timeless), std::invalid_argument);
}

}  // namespace
}  // namespace dlo::force_model
