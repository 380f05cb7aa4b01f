#include "dlo/force_model/rod.hpp"

#include <gtest/gtest.h>

#include "dlo/force_model/contraction.hpp"
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
  rod.grips.front().hold = GripHold::spring;
  rod.grips.front().stiffness = 7;
  const Eigen::Matrix3Xd points = random_polygon(10, 15, steel.segment(), 0.1);
  Eigen::Matrix3Xd forces(3, 16);
  total_forces(rod, points, forces);
  const Eigen::Matrix3Xd expected = difference_forces(
      [&](const Eigen::Matrix3Xd& p) { return energy(rod, p).total(); }, points, 1e-7);
  EXPECT_LT((forces - expected).cwiseAbs().maxCoeff(), 1e-6 * forces.cwiseAbs().maxCoeff());
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
}

}  // namespace
}  // namespace dlo::force_model
