// Turns: writhe against closed forms, where a roll counts from, and twist and
// writhe of what the solvers return against the turns that the grips hold.

#include "dlo/energy_model/turns.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>

#include "dlo/energy_model/energy.hpp"
#include "dlo/energy_model/exact.hpp"
#include "rolled_clamps.hpp"
#include "solved.hpp"

namespace dlo::energy_model {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

/// `turns` of a helix of a radius and a pitch [m] about the x axis, and its tangents at the ends.
struct HelixShape {
  Eigen::Matrix3Xd points;
  Eigen::Vector3d first;
  Eigen::Vector3d last;
};

HelixShape helix_of(double turns, double radius, double pitch, int points) {
  HelixShape helix;
  helix.points.resize(3, points);
  const auto tangent = [&](double phi) {
    return Eigen::Vector3d(pitch / (2 * pi), -radius * std::sin(phi), radius * std::cos(phi))
        .normalized();
  };
  for (int i = 0; i < points; ++i) {
    const double phi = 2 * pi * turns * i / (points - 1);
    helix.points.col(i) << pitch * phi / (2 * pi), radius * std::cos(phi), radius * std::sin(phi);
  }
  helix.first = tangent(0);
  helix.last = tangent(2 * pi * turns);
  return helix;
}

/// Fuller: a curve that can be laid straight without its tangent passing the opposite direction has
/// the area on the unit sphere between its tangents and the axis as its writhe. Of the two steeper
/// ones some tangents are beyond the half of the sphere about the ends', so that crossings are
/// summed.
TEST(Writhe, OfAHelixIsTheAreaOfItsTangents) {
  for (const double pitch : {0.5, 1.0, -1.0}) {
    const HelixShape helix = helix_of(4, 0.1, std::abs(pitch), 2000);
    Eigen::Matrix3Xd points = helix.points;
    Eigen::Vector3d first = helix.first;
    Eigen::Vector3d last = helix.last;
    if (pitch < 0) {  // the mirror image
      points.row(2) *= -1;
      first.z() *= -1;
      last.z() *= -1;
    }
    const double cosine = 1 / std::hypot(1, 2 * pi * 0.1 / pitch);
    const double expected = 4 * (1 - cosine) * (pitch < 0 ? -1 : 1);
    EXPECT_NEAR(writhe(points, first, last).value(), expected, 1e-4);
  }
}

TEST(Writhe, IsNoneInAPlane) {
  Eigen::Matrix3Xd points(3, 50);
  for (int i = 0; i < 50; ++i) points.col(i) << i * 0.02, 0.1 * std::sin(0.2 * i), 0;
  EXPECT_NEAR(writhe(points, {1, 1, 0}, {1, 0, 0}).value(), 0, 1e-12);
}

TEST(Writhe, IsUndefinedWhereAnEndsLinePassesThroughTheCurve) {
  Eigen::Matrix3Xd points(3, 5);
  points << 0, 1, 1, -1, -1,  //
      0, 0, 1, 1, -1,         //
      0, 0, 0.2, 0.2, -0.2;
  EXPECT_FALSE(writhe(points, {1, 0, 0}, {0, -1, 0}));
  EXPECT_TRUE(writhe(points, Eigen::Vector3d(1, 0, 0.1).normalized(), {0, -1, 0}));
}

Problem rolled(const Vector3d& position, const Vector3d& direction, double roll) {
  return test::rolled_clamps(position, direction, 0.8, roll);
}

TEST(Roll, CountsFromTheFrameThatTheShortestRotationBrings) {
  Problem problem = rolled({0.6, 0.2, 0.1}, {0.8, 0.3, -0.5}, 1.5);
  problem.grips[0].frame->d1 = Vector3d(0, 1, 1);
  const Vector3d d1 = held_d1(problem, problem.grips[1]);
  const Vector3d first = held_d1(problem, problem.grips[0]);
  const Vector3d to = problem.grips[1].direction->normalized();
  EXPECT_NEAR(d1.dot(to), 0, 1e-15);
  // About the axis of that rotation both frames stand alike.
  const Vector3d axis = Vector3d::UnitX().cross(to).normalized();
  EXPECT_NEAR(d1.dot(axis), first.dot(axis), 1e-15);
  EXPECT_NEAR(held_turns(problem, problem.grips[0], problem.grips[1]).value(), 1.5 / (2 * pi),
              1e-15);
  problem.grips[1].frame->d1 = Eigen::AngleAxisd(-0.5, to) * d1;
  EXPECT_NEAR(held_turns(problem, problem.grips[0], problem.grips[1]).value(), 1 / (2 * pi), 1e-15);
}

TEST(Roll, OfAClampThatTurnsRightBackKeepsThePlanesNormal) {
  Problem problem = rolled({0, 0.3, 0}, {-1, 0, 0}, 0);
  problem.grips[0].frame->d1 = Vector3d(0, 0, 1);
  EXPECT_LT((held_d1(problem, problem.grips[1]) - Vector3d::UnitZ()).norm(), 1e-12);
  const Equilibrium u = test::converged(solve_energy(problem));
  EXPECT_NEAR(u.twists.at(0).torque, 0, 1e-9);
  problem.grips[1].position = {0.3, 0, 0};
  EXPECT_THROW((void)solve_energy(problem), std::invalid_argument);
  problem.grips[1].frame->d1 = Vector3d::UnitZ();
  EXPECT_FALSE(held_turns(problem, problem.grips[0], problem.grips[1]));
  EXPECT_TRUE(succeeded(solve_energy(problem).status));
}

/// Calugareanu, White and Fuller. Less than a turn, of a rod that is not slack enough for a loop to
/// pass through itself.
TEST(Turns, OfTheGripsAreTwistAndWritheOfBothSolversShapes) {
  std::mt19937 random(12);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto any = [&] { return Vector3d(uniform(random), uniform(random), uniform(random)); };
  int compared = 0;
  for (int i = 0; i < 12; ++i) {
    Problem problem = rolled(Vector3d(0.75, 0, 0) + 0.15 * any(), Vector3d::UnitX() + 0.6 * any(),
                             2 * pi * uniform(random));
    problem.weight_per_length = 5 * any();
    if (i % 2 == 1) problem.grips[0].frame->d1 = any();
    if (i % 3 == 2) problem.grips[1].frame->d1 = any();
    const double held = held_turns(problem, problem.grips[0], problem.grips[1]).value();
    for (const bool exact : {false, true}) {
      const Equilibrium rod = exact ? solve_exact(problem) : solve_energy(problem);
      if (rod.status != SolveStatus::converged) continue;
      const double twist = rod.twists.at(0).angle / (2 * pi);
      EXPECT_NEAR(twist + writhe(rod.sample, 0, 1).value(), held, 1e-2) << i << exact;
      ++compared;
    }
  }
  EXPECT_GE(compared, 22);
}

/// Slack enough for the rod without twist to lie in a loop, on this side or on that. What it counts
/// from is no business of the side.
TEST(Turns, OfALoopAreTheSameOnEitherSide) {
  for (const double roll : {0.0, 0.5, -0.5, 2.0}) {
    Problem problem = rolled({0.45, 0, 0}, {1, 0, 0}, roll);
    const Equilibrium energy = solve_energy(problem);
    const Equilibrium exact = solve_exact(problem);
    ASSERT_TRUE(succeeded(energy.status)) << energy.message;
    ASSERT_TRUE(succeeded(exact.status)) << exact.message;
    for (const Equilibrium* rod : {&energy, &exact}) {
      const double twist = rod->twists.at(0).angle / (2 * pi);
      const double missing = twist + writhe(rod->sample, 0, 1).value() - roll / (2 * pi);
      EXPECT_NEAR(std::remainder(missing, 2), 0, 1e-2) << roll;
    }
    EXPECT_NEAR(std::abs(energy.twists.at(0).torque), std::abs(exact.twists.at(0).torque), 1e-6)
        << roll;
  }
}

}  // namespace
}  // namespace dlo::energy_model
