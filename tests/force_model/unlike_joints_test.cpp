// Tests of joints with different stiffnesses, and of joints with rest angles.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "dlo/force_model/batch.hpp"
#include "dlo/force_model/simulation.hpp"
#include "dlo/force_model/step_size.hpp"
#include "dlo/force_model/tangent_stiffness.hpp"
#include "plain_simulation.hpp"
#include "polygons.hpp"
#include "random_rods.hpp"
#include "rods.hpp"

namespace dlo::force_model {
namespace {

/// Stiffnesses that differ by up to a factor of three along the rod.
Eigen::VectorXd varying_stiffnesses(double stiffness, Eigen::Index joints) {
  Eigen::VectorXd result(joints);
  for (Eigen::Index i = 0; i < joints; ++i) {
    result[i] = stiffness * (2 + std::sin(1.7 * static_cast<double>(i)));
  }
  return result;
}

Eigen::VectorXd turns(double size, Eigen::Index joints) {
  Eigen::VectorXd result(joints);
  for (Eigen::Index i = 0; i < joints; ++i) {
    result[i] = size * (0.5 + std::sin(2.3 * static_cast<double>(i)));
  }
  return result;
}

TEST(UnlikeJoints, ForcesAreTheGradientOfTheEnergyAndBalance) {
  constexpr Eigen::Index n = 15;
  const Eigen::VectorXd rest = Eigen::VectorXd::Constant(n, 0.04);
  for (const bool natural : {false, true}) {
    Bending bending{BendingLaw::hooke, 0.2, varying_stiffnesses(0.2, n - 1)};
    if (natural) bending.natural_turns = turns(0.6, n - 1);
    Eigen::Matrix3Xd points = random_polygon(5, n, 0.04, 0.1);
    if (natural) points.row(2).setZero();
    Eigen::Matrix3Xd forces = Eigen::Matrix3Xd::Zero(3, n + 1);
    add_bending_forces(points, rest, bending, forces);
    Eigen::Matrix3Xd expected = difference_forces(
        [&](const Eigen::Matrix3Xd& p) { return bending_energy(p, rest, bending); }, points, 1e-7);
    if (natural) expected.row(2).setZero();  // natural angles are not defined across the plane
    const double size = forces.cwiseAbs().maxCoeff();
    EXPECT_LT((forces - expected).cwiseAbs().maxCoeff(), 1e-6 * size) << natural;
    EXPECT_LT(forces.rowwise().sum().norm(), 1e-13 * size);
    EXPECT_LT(net_torque(points, forces).norm(), 1e-13 * size);
  }
}

/// Returns the points of a polygon in the plane z = 0 with the given angles at its joints [rad].
Eigen::Matrix3Xd turned_polygon(const Eigen::VectorXd& rest, const Eigen::VectorXd& at_joints) {
  Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Zero(3, rest.size() + 1);
  double angle = 0.3;
  for (Eigen::Index i = 0; i < rest.size(); ++i) {
    if (i > 0) angle += at_joints[i - 1];
    points.col(i + 1) =
        points.col(i) + rest[i] * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0);
  }
  return points;
}

TEST(NaturalTurns, AreThoseOfTheStressFreeShapeWithoutForceAndEnergy) {
  constexpr Eigen::Index n = 12;
  const Eigen::VectorXd rest = Eigen::VectorXd::LinSpaced(n, 0.03, 0.06);
  const Bending bending{BendingLaw::hooke, 0.2, varying_stiffnesses(0.2, n - 1), turns(1.2, n - 1)};
  const Eigen::Matrix3Xd points = turned_polygon(rest, bending.natural_turns);
  Eigen::Matrix3Xd forces = Eigen::Matrix3Xd::Zero(3, n + 1);
  add_bending_forces(points, rest, bending, forces);
  // The forces are the rounding error of couples that cancel: eps times the largest couple, divided
  // by the length of the shortest segment. 36 eps are allowed.
  double couple = 0;
  for (Eigen::Index i = 1; i < n; ++i) {
    const double L = (rest[i - 1] + rest[i]) / 2;
    couple = std::max(couple, std::abs(natural_moment(bending, i, L)));
  }
  EXPECT_LT(forces.cwiseAbs().maxCoeff(), 1e-15 * 8 * couple / rest.minCoeff());
  EXPECT_NEAR(bending_energy(points, rest, bending), 0, 1e-14);
  // The mirror image of the free shape is not free, because the natural angles of its joints have
  // the opposite sign.
  const Eigen::Matrix3Xd mirrored = Eigen::Vector3d(1, -1, 1).asDiagonal() * points;
  EXPECT_GT(bending_energy(mirrored, rest, bending), 1);
}

TEST(NaturalTurns, AreRefusedWhereTheyHaveNoSign) {
  SteelRod steel;
  const Bending bent{BendingLaw::hooke, steel.EI, {}, turns(0.1, steel.points - 2)};
  const Rod rod = steel.rod(bent, 660);
  EXPECT_NO_THROW(Simulation(rod, steel.straight(), {}));
  Eigen::Matrix3Xd lifted = steel.straight();
  lifted(2, 7) = 1e-9;
  EXPECT_THROW(Simulation(rod, lifted, {}), std::invalid_argument);
  Rod pulled = rod;
  pulled.loads(2, 5) = 1e-3;
  EXPECT_THROW(Simulation(pulled, steel.straight(), {}), std::invalid_argument);
  Rod paper = rod;
  paper.bending.law = BendingLaw::paper;
  EXPECT_THROW(check(paper), std::invalid_argument);
  Rod folded = rod;
  folded.bending.natural_turns[3] = 3.1;
  EXPECT_THROW(check(folded), std::invalid_argument);
  Rod short_of_one = rod;
  short_of_one.bending.natural_turns = turns(0.1, steel.points - 3);
  EXPECT_THROW(check(short_of_one), std::invalid_argument);
  Simulation simulation(rod, steel.straight(), {});
  Eigen::Matrix3Xd targets = rod.grips.front().targets;
  targets(2, 0) = 0.01;
  EXPECT_THROW(simulation.move_grip(0, targets, Eigen::Vector3d::Zero()), std::invalid_argument);
}

TEST(NaturalTurns, StepsAgreeWithPlainForcesOnEveryInstructionSet) {
  for (const InstructionSet set : available_instruction_sets()) {
    for (const Eigen::Index points : {4, 7, 8, 9, 16, 17, 40, 200}) {
      const auto seed = static_cast<unsigned>(points);
      Rod rod = random_rod(
          seed, points,
          {BendingLaw::hooke, Stepper::dynamic, GripHold::rigid, Walls::two, Space::plane});
      rod.bending.stiffnesses = varying_stiffnesses(rod.bending.stiffness, points - 2);
      rod.bending.natural_turns = turns(0.7, points - 2);
      StepOptions options = options_for(Stepper::dynamic, rod);
      options.instruction_set = set;
      const Eigen::Matrix3Xd start = random_points(seed, points, Space::plane);
      test::PlainSimulation plain(rod, start, options);
      Simulation simulation(rod, start, options);
      Batch batch({{rod, start, options}, {rod, start, options}});
      for (int i = 0; i < 20; ++i) {
        (void)plain.step();
        ASSERT_EQ(simulation.step().status, StepStatus::good);
      }
      batch.step_block(0, 20);
      const double allowed = 1e-11 * test::length;
      EXPECT_LT((simulation.points() - plain.points()).cwiseAbs().maxCoeff(), allowed) << points;
      EXPECT_LT((batch.points(1) - plain.points()).cwiseAbs().maxCoeff(), allowed) << points;
    }
  }
}

TEST(NaturalTurns, TheStiffnessIsTheForcesDerivativeInThePlane) {
  SteelRod steel;
  Rod rod = steel.rod({BendingLaw::hooke, steel.EI}, 660);
  rod.bending.stiffnesses = varying_stiffnesses(steel.EI, steel.points - 2);
  rod.bending.natural_turns = turns(0.4, steel.points - 2);
  Simulation simulation(rod, steel.straight(), {});
  ASSERT_EQ(simulation.relax().status, RelaxStatus::at_rest);
  // Newton's step reverses a small displacement, up to an error of second order.
  const Eigen::Matrix3Xd rest =
      simulation.points() + check_equilibrium(rod, simulation.points()).step;
  Eigen::Matrix3Xd moved = rest;
  for (Eigen::Index i = 2; i < moved.cols(); ++i) {
    const auto s = static_cast<double>(i);
    moved.col(i) += 1e-6 * Eigen::Vector3d(std::sin(s), std::cos(2 * s), 0);
  }
  const EquilibriumCheck check = check_equilibrium(rod, moved);
  ASSERT_TRUE(check.stable);
  EXPECT_EQ(check.neutral_modes, 0);
  EXPECT_LT((check.step - (rest - moved)).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(NaturalTurns, TheFastestModeIsBounded) {
  // Twice the inverse of the bound is a stable step for any rest angles of the joints.
  SteelRod steel;
  Rod rod = steel.rod({BendingLaw::hooke, steel.EI}, 66);
  rod.bending.natural_turns = Eigen::VectorXd::Constant(steel.points - 2, 2.5);
  const Eigen::Matrix3Xd points = steel.straight();
  const double fastest = mode_bounds(rod, points).fastest;
  const double size = 1e-7;
  for (int seed = 0; seed < 20; ++seed) {
    Eigen::Matrix3Xd direction = random_points(static_cast<unsigned>(seed), 16, Space::plane);
    direction.leftCols<2>().setZero();
    direction *= size / direction.norm();
    Eigen::Matrix3Xd ahead(3, 16);
    Eigen::Matrix3Xd back(3, 16);
    total_forces(rod, points + direction, ahead);
    total_forces(rod, points - direction, back);
    EXPECT_LT((back - ahead).norm() / (2 * size), fastest);
  }
}

}  // namespace
}  // namespace dlo::force_model
