#include "dlo/force_model/rod.hpp"

#include <gtest/gtest.h>

#include "dlo/force_model/contraction.hpp"
#include "dlo/force_model/simulation.hpp"
#include "polygons.hpp"
#include "rods.hpp"

namespace dlo::force_model {
namespace {

using test::difference_forces;
using test::random_polygon;
using test::SteelRod;

TEST(TotalForces, AreTheSumOfTheirParts) {
  SteelRod steel;
  Rod rod = steel.rod({BendingLaw::paper, 3574.96}, 660);
  rod.walls = {{.point = {0, 0.01, 0}, .normal = {0, 1, 0}, .stiffness = 50}};
  Grip spring = rod.grips.front();
  spring.first_point = 5;
  spring.hold = GripHold::spring;
  spring.stiffness = 7;
  rod.grips = {spring};
  const Eigen::Matrix3Xd points = random_polygon(9, 15, steel.segment(), 0.1);
  Eigen::Matrix3Xd forces(3, 16);
  total_forces(rod, points, forces);

  Eigen::Matrix3Xd expected = rod.loads;
  add_contraction_forces(points, rod.rest_lengths, rod.c_c, expected);
  add_bending_forces(points, rod.rest_lengths, rod.bending, expected);
  for (Eigen::Index i = 0; i < 16; ++i) expected.col(i) += wall_force(rod.walls[0], points.col(i));
  for (Eigen::Index k = 0; k < 2; ++k) {
    expected.col(5 + k) += spring_force(7, spring.targets.col(k), points.col(5 + k));
  }
  EXPECT_EQ((forces - expected).cwiseAbs().maxCoeff(), 0);
}

TEST(TotalForces, AreTheGradientOfTheEnergyForHooke) {
  SteelRod steel;
  Rod rod = steel.rod({BendingLaw::hooke, steel.EI}, 660);
  rod.walls = {{.point = {0, 0.02, 0}, .normal = {0, 1, 0}, .stiffness = 50}};
  rod.solids = {{obstacle::Body::sphere({0.1, 0.05, 0.02}, 0.2), 40, 3}};
  rod.grips.front().hold = GripHold::spring;
  rod.grips.front().stiffness = 7;
  const Eigen::Matrix3Xd points = random_polygon(10, 15, steel.segment(), 0.1);
  Eigen::Matrix3Xd forces(3, 16);
  total_forces(rod, points, forces);
  const Eigen::Matrix3Xd expected = difference_forces(
      [&](const Eigen::Matrix3Xd& p) { return energy(rod, p).total(); }, points, 1e-7);
  EXPECT_LT((forces - expected).cwiseAbs().maxCoeff(), 1e-6 * forces.cwiseAbs().maxCoeff());
}

// A point within a segment is pushed as a lever would be: no net force or torque is added to or
// lost from what the solid does there.
TEST(Solid, PushesWithinSegmentsAsALeverDoes) {
  const Solid ball{obstacle::Body::sphere({0.5, -0.9, 0}, 1), 40, 4};
  Eigen::Matrix3Xd points(3, 2);
  points << 0, 1, 0.2, -0.1, 0, 0;
  Eigen::Matrix3Xd forces = Eigen::Matrix3Xd::Zero(3, 2);
  add_solid_forces(ball, points, forces);
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();
  double potential = 0;
  const auto push = [&](const Eigen::Vector3d& at) {
    const double depth = 1 - (at - Eigen::Vector3d(0.5, -0.9, 0)).norm();
    if (depth <= 0) return;
    const Eigen::Vector3d f = 10 * depth * (at - Eigen::Vector3d(0.5, -0.9, 0)).normalized();
    force += f;
    torque += at.cross(f);
    potential += 10 * depth * depth / 2;
  };
  for (const double share : {0.0, 0.25, 0.5, 0.75, 1.0}) {
    push((1 - share) * points.col(0) + share * points.col(1));
  }
  EXPECT_GT(force.norm(), 0.1);
  EXPECT_LT((forces.rowwise().sum() - force).norm(), 1e-14);
  const Eigen::Vector3d balance = Eigen::Vector3d(points.col(0)).cross(forces.col(0)) +
                                  Eigen::Vector3d(points.col(1)).cross(forces.col(1));
  EXPECT_LT((balance - torque).norm(), 1e-14);
  EXPECT_NEAR(solid_energy(ball, points), potential, 1e-14);
}

TEST(GripReaction, RigidHoldBalancesEverythingElseInEquilibrium) {
  // A straight rod that hangs down and is stretched by its weight is in equilibrium.
  SteelRod steel;
  steel.angle = -1.5707963267948966;
  const double c_c = 660;
  const Rod rod = steel.rod({BendingLaw::hooke, steel.EI}, c_c);
  Eigen::Matrix3Xd points = steel.straight();
  double tension = 0;
  Eigen::VectorXd lengths = rod.rest_lengths;
  for (Eigen::Index i = 14; i >= 1; --i) {
    tension += -rod.loads(1, i + 1);
    lengths[i] *= 1 + tension / c_c;
  }
  for (Eigen::Index i = 1; i < 15; ++i) {
    points.col(i + 1) = points.col(i) + lengths[i] * steel.direction();
  }
  const GripReaction reaction = grip_reactions(rod, points).front();
  EXPECT_NEAR(reaction.force.y(), steel.weight_per_length * steel.length, 1e-12);
  EXPECT_LT(std::abs(reaction.force.x()), 1e-12);
  EXPECT_LT(reaction.torque.norm(), 1e-12);
}

TEST(GripReaction, SpringHandsBackForceAndTorqueOfItsTwoPoints) {
  SteelRod steel;
  Rod rod = steel.rod({BendingLaw::hooke, steel.EI}, 660);
  rod.grips.front().hold = GripHold::spring;
  rod.grips.front().stiffness = 10;
  Eigen::Matrix3Xd points = steel.straight();
  points(1, 0) -= 0.001;  // first point 1 mm below its target, second 2 mm above
  points(1, 1) += 0.002;
  const GripReaction reaction = grip_reactions(rod, points).front();
  EXPECT_NEAR(reaction.force.y(), 10 * 0.001 - 10 * 0.002, 1e-15);
  const double half = steel.segment() / 2;
  EXPECT_NEAR(reaction.torque.z(), -half * 0.01 - half * 0.02, 1e-15);
}

/// What the loads do about a point, with the opposite sign: a rod at rest under them, held by one
/// gripper, is balanced by it.
GripReaction balancing(const Rod& rod, const Eigen::Matrix3Xd& points,
                       const Eigen::Vector3d& about) {
  GripReaction result;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const Eigen::Vector3d load = rod.loads.col(i);
    const Eigen::Vector3d arm = points.col(i) - about;
    result.force -= load;
    result.torque -= arm.cross(load);
  }
  return result;
}

/// A wire held far from the origin, pointing anywhere.
struct FarWire {
  Eigen::Vector3d gripper = {3, -2, 1.5};
  SteelRod steel;
  Rod rod = steel.rod({BendingLaw::hooke, steel.EI}, 660);
  Eigen::Matrix3Xd points;

  explicit FarWire(GripHold hold) {
    const Eigen::Vector3d direction = Eigen::Vector3d(1, 0.5, -0.7).normalized();
    const double L = steel.segment();
    rod.loads(0, 15) = 0.02;
    rod.loads(2, 9) = -0.01;
    rod.grips.front().targets = grip_targets(gripper, direction, L, L / 2);
    rod.grips.front().reference = gripper;
    rod.grips.front().hold = hold;
    rod.grips.front().stiffness = 500;
    points.resize(3, 16);
    for (int i = 0; i < 16; ++i) points.col(i) = gripper + (i - 0.5) * L * direction;
  }
};

TEST(GripReaction, BalancesTheLoadsAboutAGripperFarFromTheOriginAndAfterItMoved) {
  for (const GripHold hold : {GripHold::rigid, GripHold::spring}) {
    FarWire wire(hold);
    Simulation simulation(wire.rod, wire.points, {});
    const auto expect_balance = [&](const Eigen::Vector3d& about) {
      ASSERT_EQ(simulation.relax({.tolerance = 1e-9}).status, RelaxStatus::at_rest);
      const Eigen::Matrix3Xd points = simulation.points();
      const GripReaction reaction = grip_reactions(simulation.rod(), points).front();
      const GripReaction expected = balancing(simulation.rod(), points, about);
      EXPECT_GT(expected.torque.norm(), 0.01);  // of 0.12 N on 0.5 m
      EXPECT_LT((reaction.force - expected.force).norm(), 1e-7);
      EXPECT_LT((reaction.torque - expected.torque).norm(), 1e-7);
    };
    expect_balance(wire.gripper);
    const Eigen::Vector3d moved(-4, 0.3, 7);
    const Eigen::Matrix3Xd targets =
        wire.rod.grips.front().targets.colwise() + (moved - wire.gripper);
    simulation.move_grip(0, targets, moved);
    expect_balance(moved);
  }
}

TEST(GripReaction, OfTwoGripsIsNotCountedTwice) {
  FarWire wire(GripHold::rigid);
  Grip second = wire.rod.grips.front();
  second.first_point = 1;  // which the first one holds too
  wire.rod.grips.push_back(second);
  EXPECT_THROW(check(wire.rod), std::invalid_argument);
  EXPECT_THROW((void)grip_reactions(wire.rod, wire.points), std::invalid_argument);
  EXPECT_THROW(Simulation(wire.rod, wire.points, {}), std::invalid_argument);
  // Springs may pull at the same point: each exerts its own force, a rigid grip what is left.
  for (const GripHold first : {GripHold::spring, GripHold::rigid}) {
    wire.rod.grips[0].hold = first;
    wire.rod.grips[1].hold = GripHold::spring;
    EXPECT_NO_THROW(check(wire.rod));
    Simulation simulation(wire.rod, wire.points, {});
    ASSERT_EQ(simulation.relax({.tolerance = 1e-9}).status, RelaxStatus::at_rest);
    Eigen::Vector3d sum = wire.rod.loads.rowwise().sum();
    for (const GripReaction& one : grip_reactions(wire.rod, simulation.points())) sum += one.force;
    EXPECT_LT(sum.norm(), 1e-7);
  }
}

TEST(GripReaction, IsTheSameWithoutAnAllocation) {
  const SteelRod steel;
  Rod rod = steel.rod({BendingLaw::hooke, steel.EI}, 660);
  Grip end;  // the last point on a spring
  end.first_point = steel.points - 1;
  end.targets = Eigen::Vector3d(0.4, 0.1, 0.05);
  end.hold = GripHold::spring;
  end.stiffness = 3;
  rod.grips.push_back(end);
  const std::vector<GripReaction> expected = grip_reactions(rod, steel.straight());
  Eigen::Matrix3Xd forces(3, steel.points);
  std::vector<GripReaction> reactions(2);
  grip_reactions(rod, steel.straight(), forces, reactions);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(reactions[i].force, expected[i].force);
    EXPECT_EQ(reactions[i].torque, expected[i].torque);
  }
  EXPECT_GT(reactions[1].force.norm(), 0);
  Eigen::Matrix3Xd total(3, steel.points);
  total_forces(rod, steel.straight(), total);
  EXPECT_EQ(forces, total);
  reactions.resize(1);
  EXPECT_THROW(grip_reactions(rod, steel.straight(), forces, reactions), std::invalid_argument);
}

TEST(Rod, RefusesWhatIsOutOfRange) {
  const SteelRod steel;
  const Rod good = steel.rod({BendingLaw::hooke, steel.EI}, 660);
  EXPECT_NO_THROW(check(good));
  Rod rod = good;
  rod.c_c = NAN;
  EXPECT_THROW(check(rod), std::invalid_argument);
  rod = good;
  rod.rest_lengths[3] = 0;
  EXPECT_THROW(check(rod), std::invalid_argument);
  rod = good;
  rod.loads.resize(3, 4);
  EXPECT_THROW(check(rod), std::invalid_argument);
  rod = good;
  rod.grips.front().first_point = 15;
  EXPECT_THROW(check(rod), std::invalid_argument);
  rod = good;
  rod.grips.front().hold = GripHold::spring;
  EXPECT_THROW(check(rod), std::invalid_argument);
  rod = good;
  rod.walls = {{.normal = {0, 2, 0}, .stiffness = 1}};
  EXPECT_THROW(check(rod), std::invalid_argument);
  rod = good;
  rod.solids = {{obstacle::Body::sphere({0, 0, 0}, 1), 1, 0}};
  EXPECT_THROW(check(rod), std::invalid_argument);
}

}  // namespace
}  // namespace dlo::force_model
