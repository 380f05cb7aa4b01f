// Tests that a rod on a stiff floor comes to rest for any rounding of its start and steps.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "dlo/force_model/simulation.hpp"
#include "rods.hpp"

namespace dlo::force_model {
namespace {

struct FloorStart {
  Rod rod;
  Eigen::Matrix3Xd points;
};

/// Returns a metre of the paper's spring steel between two clamps that hold the middle of its end
/// segments, one on the floor and one above it, Gamma = 30. The floor is as stiff as a segment.
/// @param height  of the second clamp [m]
Rod rod_over_floor(Eigen::Index points, double height) {
  const test::SteelRod steel;
  const double L = 1.0 / static_cast<double>(points - 2);
  Rod rod;
  rod.rest_lengths.setConstant(points - 1, L);
  rod.c_c = steel.AE;
  rod.bending = {BendingLaw::hooke, steel.EI};
  rod.loads.setZero(3, points);
  rod.loads.row(1).segment(1, points - 2).setConstant(-30 * steel.EI * L);
  rod.walls = {{.stiffness = rod.c_c / L}};
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX();
  rod.grips = {{.first_point = 0, .targets = grip_targets({0, 0, 0}, x, L, L / 2)},
               {.first_point = points - 2, .targets = grip_targets({0.9, height, 0}, x, L, L / 2)}};
  return rod;
}

/// Returns points that sag between the clamps and are a little out of the plane.
Eigen::Matrix3Xd sagging(const Rod& rod, double sag) {
  const Eigen::Index points = rod.points();
  const double height = rod.grips.back().targets(1, 0);
  Eigen::Matrix3Xd shape(3, points);
  for (Eigen::Index i = 0; i < points; ++i) {
    const double t = (static_cast<double>(i) - 0.5) / static_cast<double>(points - 2);
    const double bump = t * (1 - t);
    const double chord = height * t * t * (3 - 2 * t);
    shape.col(i) << 0.9 * t, chord - sag * bump * bump, 1e-6 * bump;
  }
  for (const Grip& grip : rod.grips) {
    shape.middleCols(grip.first_point, grip.targets.cols()) = grip.targets;
  }
  return shape;
}

/// Returns an initial shape whose sag is such that the polygon has its unstretched length.
FloorStart over_floor(Eigen::Index points, double height = 0.2) {
  FloorStart start;
  start.rod = rod_over_floor(points, height);
  double low = 0;
  double high = 8;
  for (int halving = 0; halving < 60; ++halving) {
    const double sag = (low + high) / 2;
    start.points = sagging(start.rod, sag);
    const auto inner = points - 1;
    const double current_length =
        (start.points.rightCols(inner) - start.points.leftCols(inner)).colwise().norm().sum();
    (current_length < start.rod.length() ? low : high) = sag;
  }
  return start;
}

RelaxResult relax(Simulation& simulation) { return simulation.relax({.max_steps = 1'000'000}); }

/// The slowest mode of a rod on a stiff floor has 1e-8 of the fastest's stiffness: where it was
/// estimated wrongly once, steps moved it by rounding only, and the estimate was never mended.
TEST(RigidFloor, RodsOnItComeToRestFromEveryRoundingOfTheirStart) {
  constexpr int first = 37;
  constexpr int numbers = 7;
  constexpr int least = 200;
  const std::vector<InstructionSet> sets = available_instruction_sets();
  const int starts = least / (numbers * static_cast<int>(sets.size())) + 1;
  std::mt19937 engine(23);
  std::uniform_real_distribution<double> rounding(-1e-15, 1e-15);
  long most = 0;
  for (int points = first; points < first + numbers; ++points) {
    const FloorStart start = over_floor(points);
    Eigen::Matrix3Xd rest;
    for (const InstructionSet set : sets) {
      for (int i = 0; i < starts; ++i) {
        Eigen::Matrix3Xd rounded = start.points;
        for (double& coordinate : rounded.reshaped()) coordinate *= 1 + rounding(engine);
        Simulation simulation(start.rod, rounded, {.instruction_set = set});
        const RelaxResult result = relax(simulation);
        ASSERT_EQ(result.status, RelaxStatus::at_rest)
            << to_string(set) << ", " << points << " points, start " << i << ": "
            << result.remaining_error;
        most = std::max(most, result.steps);
        if (rest.cols() == 0) rest = simulation.points();
        // Both shapes are within 1e-7 of the length of the same equilibrium.
        EXPECT_LT((simulation.points() - rest).norm() / std::sqrt(points),
                  2e-7 * start.rod.length());
      }
    }
  }
  RecordProperty("most_steps", static_cast<int>(most));
}

/// At a certain height of the clamp one point changes between contact and no contact. It is then on
/// the floor without a force, and rounding determines whether it is pressed.
TEST(RigidFloor, APointThatBarelyTouchesItDoesNotPreventRest) {
  constexpr Eigen::Index points = 24;
  const auto touching_at = [](double height) {
    const FloorStart start = over_floor(points, height);
    Simulation simulation(start.rod, start.points, {});
    const RelaxResult result = relax(simulation);
    EXPECT_EQ(result.status, RelaxStatus::at_rest) << height << ": " << result.remaining_error;
    return (simulation.points().row(1).array() < 0).count();
  };
  double low = 0.1;
  double high = 0.2;
  const Eigen::Index most = touching_at(low);
  ASSERT_GT(most, touching_at(high));
  while (high - low > 1e-15) {
    const double height = (low + high) / 2;
    (touching_at(height) == most ? low : high) = height;
  }
}

}  // namespace
}  // namespace dlo::force_model
