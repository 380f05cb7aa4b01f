#include "dlo/force_model/rod.hpp"

#include <gtest/gtest.h>

#include "dlo/force_model/simulation.hpp"
#include "polygons.hpp"
#include "rods.hpp"

namespace dlo::force_model {
namespace {

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
TEST(Solid, DistributesForcesWithinSegmentsByTheLeverRule) {
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

/// Returns the force and the moment about a point that balance the loads. For a rod at rest with a
/// single gripper these are the gripper's force and moment.
GripReaction reaction_for_balance(const Rod& rod, const Eigen::Matrix3Xd& points,
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
      const GripReaction expected = reaction_for_balance(simulation.rod(), points, about);
      EXPECT_GT(expected.torque.norm(), 0.01);  // a weight of 0.12 N acts at about 0.2 m
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
  second.first_point = 1;  // the first grip holds this point too
  wire.rod.grips.push_back(second);
  EXPECT_THROW(check(wire.rod), std::invalid_argument);
  EXPECT_THROW((void)grip_reactions(wire.rod, wire.points), std::invalid_argument);
  EXPECT_THROW(Simulation(wire.rod, wire.points, {}), std::invalid_argument);
  // Several spring grips may hold the same point: each exerts its own force, and a rigid grip the
  // remaining force.
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

TEST(GripReaction, ComesWithTheForcesWithoutAnAllocation) {
  const SteelRod steel;
  const Rod rod = steel.rod({BendingLaw::hooke, steel.EI}, 660);
  Eigen::Matrix3Xd forces(3, steel.points);
  Eigen::Matrix3Xd total = forces;
  std::vector<GripReaction> reactions(1);
  grip_reactions(rod, steel.straight(), forces, reactions);
  total_forces(rod, steel.straight(), total);
  EXPECT_EQ(forces, total);
  reactions.clear();
  EXPECT_THROW(grip_reactions(rod, steel.straight(), forces, reactions), std::invalid_argument);
}

TEST(Rod, RefusesWhatIsOutOfRange) {
  const SteelRod steel;
  const Rod good = steel.rod({BendingLaw::hooke, steel.EI}, 660);
  EXPECT_NO_THROW(check(good));
  const auto refused = [&](const auto& invalidate) {
    Rod rod = good;
    invalidate(rod);
    EXPECT_THROW(check(rod), std::invalid_argument);
  };
  refused([](Rod& rod) { rod.c_c = NAN; });
  refused([](Rod& rod) { rod.rest_lengths[3] = 0; });
  refused([](Rod& rod) { rod.loads.resize(3, 4); });
  refused([](Rod& rod) { rod.grips.front().first_point = 15; });
  refused([](Rod& rod) { rod.grips.front().hold = GripHold::spring; });
  refused([](Rod& rod) { rod.walls = {{.normal = {0, 2, 0}, .stiffness = 1}}; });
  refused([](Rod& rod) { rod.solids = {{obstacle::Body::sphere({0, 0, 0}, 1), 1, 0}}; });
}

}  // namespace
}  // namespace dlo::force_model
