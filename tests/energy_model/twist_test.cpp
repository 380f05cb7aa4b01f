// Tests of rods whose clamps hold their frames: twist against closed forms, laws and symmetries.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <stdexcept>

#include "dlo/energy_model/energy.hpp"
#include "dlo/energy_model/exact.hpp"
#include "dlo/energy_model/turns.hpp"
#include "problems.hpp"
#include "rolled_clamps.hpp"
#include "solved.hpp"

namespace dlo::energy_model {
namespace {

/// Returns a rod between two clamps along one line, `distance` apart, the second rolled by `roll`.
Problem turned_rod(double distance, double roll, double weight) {
  return test::framed_clamps(weight, distance, 0.75, roll);
}

Equilibrium solved(const Problem& problem) { return test::converged(solve_energy(problem)); }

double axial_torque(const Equilibrium& equilibrium) { return equilibrium.twists.at(0).torque; }

// Michell 1889, Zajac 1962: a ring is unstable beyond a twist of 2 pi sqrt(3) EI / GJ. Beyond that
// angle it passes through itself and loses two turns. Its writhe is one of the turns that the
// clamps hold.
TEST(Twist, LeavesTheRingThatItMakesUnstable) {
  const double critical = 2 * pi * std::sqrt(3.0) / 0.75;
  const Equilibrium ring = solved(turned_rod(0, critical - 0.1 + 2 * pi, 0));
  EXPECT_NEAR(ring.energy.bending, 2 * pi * pi, 1e-9);
  EXPECT_NEAR(ring.twists.at(0).angle, critical - 0.1, 1e-9);
  const Equilibrium other = solved(turned_rod(0, critical + 0.1 + 2 * pi, 0));
  EXPECT_NEAR(other.energy.bending, 2 * pi * pi, 1e-9);
  EXPECT_NEAR(other.twists.at(0).angle, critical + 0.1 - 4 * pi, 1e-9);
}

TEST(Twist, OfZeroChangesNothing) {
  Problem problem = turned_rod(0.8, 0, 20);
  const Equilibrium held = solved(problem);
  for (Grip& grip : problem.grips) grip.frame.reset();
  const Equilibrium loose = solved(problem);
  EXPECT_NEAR(held.energy.total(), loose.energy.total(), 1e-10);
  EXPECT_NEAR(axial_torque(held), 0, 1e-9);
  EXPECT_TRUE(loose.twists.empty());
  EXPECT_LT(test::largest_point_distance(held, loose), 2e-9);
}

TEST(Twist, OfOppositeSignGivesTheMirrorImage) {
  const Equilibrium left = solved(turned_rod(0.8, 2, 20));
  const Equilibrium right = solved(turned_rod(0.8, -2, 20));
  const std::vector<double> s = equal_arc_lengths(1, 21);
  Eigen::Matrix3Xd mirrored = right.sample(s).points;
  mirrored.row(2) *= -1;
  EXPECT_LT((left.sample(s).points - mirrored).norm(), 1e-8);
  EXPECT_GT(left.sample(s).points.row(2).norm(), 1e-3);
  EXPECT_NEAR(axial_torque(left), -axial_torque(right), 1e-9);
}

// The work of the gripper during a small rotation of the end is stored as energy.
TEST(Twist, TorqueIsTheDerivativeOfTheEnergyByTheTurn) {
  constexpr double h = 1e-4;
  for (const double roll : {0.5, 2.0, 4.0}) {
    const Equilibrium here = solved(turned_rod(0.7, roll, 30));
    const double slope = (solved(turned_rod(0.7, roll + h, 30)).energy.total() -
                          solved(turned_rod(0.7, roll - h, 30)).energy.total()) /
                         (2 * h);
    EXPECT_NEAR(slope, axial_torque(here), 1e-6);
    EXPECT_NEAR(here.grips.back().torque.x(), axial_torque(here), 1e-8);
    EXPECT_NEAR(here.energy.twisting, 0.5 * 0.75 * std::pow(here.twists.front().angle, 2), 1e-9);
  }
}

/// A point of a helix, its tangent and its normal.
struct HelixPoint {
  Eigen::Vector3d r, t, normal;
};

HelixPoint helix(double curvature, double torsion, double s) {
  const double rate = std::hypot(curvature, torsion);
  const double radius = curvature / (rate * rate);
  const double rise = torsion / rate;
  const double a = rate * s;
  return {{radius * std::cos(a), radius * std::sin(a), rise * s},
          {-radius * rate * std::sin(a), radius * rate * std::cos(a), rise},
          {-std::cos(a), -std::sin(a), 0}};
}

// Kirchhoff: every helix is a shape of a round rod, under a force rate (m - torsion) along its axis
// and any twisting moment m.
TEST(Twist, HoldsAHelixUnderItsWrench) {
  const double curvature = 2;
  const double torsion = 1;
  for (const double moment : {0.5, 1.0, 2.0}) {
    Problem problem = turned_rod(0.5, 0, 0);
    const double twist = moment / problem.torsional_stiffness;
    for (Grip& grip : problem.grips) {
      const HelixPoint point = helix(curvature, torsion, grip.at);
      grip.position = point.r;
      grip.direction = point.t;
      // Bishop's frame rotates relative to Frenet's at the rate of the torsion.
      const Eigen::AngleAxisd ahead((twist - torsion) * grip.at, point.t);
      grip.frame->d1 = ahead * point.normal;
    }
    // A rotation of more than half a turn must be stated explicitly.
    Eigen::Matrix3Xd points(3, 200);
    for (Eigen::Index i = 0; i < 200; ++i) {
      points.col(i) = helix(curvature, torsion, static_cast<double>(i) / 199).r;
    }
    const Grip& first = problem.grips.front();
    Grip& last = problem.grips.back();
    const double turns =
        twist / (2 * pi) + writhe(points, *first.direction, *last.direction)->value.value();
    last.frame->roll = 2 * pi * std::round(turns - held_turns(problem, first, last).value());
    const Equilibrium equilibrium = solved(problem);
    EXPECT_NEAR(equilibrium.twists.at(0).angle, twist, 1e-9);
    const double force = std::hypot(curvature, torsion) * (moment - torsion);
    EXPECT_LT((equilibrium.grips.back().force - Eigen::Vector3d(0, 0, force)).norm(), 1e-8);
    const std::vector<double> s = equal_arc_lengths(1, 11);
    const Samples samples = equilibrium.sample(s);
    for (std::size_t i = 0; i < s.size(); ++i) {
      const auto column = static_cast<Eigen::Index>(i);
      EXPECT_LT((samples.points.col(column) - helix(curvature, torsion, s[i]).r).norm(), 1e-9);
    }
  }
}

// Each of the two models introduces the twist by its own continuation.
TEST(Twist, AgreesWithMultipleShooting) {
  Problem problem = turned_rod(0.7, 0, 8);
  problem.grips.back().direction = Eigen::Vector3d(0.8, 0.3, -0.5);
  problem.loads = {{0.4, {1, 3, -2}}};
  problem.grips.front().frame->roll = 0.7;
  const auto expect_agreement = [&] {
    const Equilibrium energy = solved(problem);
    const Equilibrium exact = test::converged(solve_exact(problem));
    EXPECT_LT(test::largest_point_distance(energy, exact), 1e-9);
    EXPECT_NEAR(energy.twists.at(0).angle, exact.twists.at(0).angle, 1e-8);
  };
  for (const double roll : {-5.0, 3.0}) {
    problem.grips.back().frame->roll = roll;
    expect_agreement();
  }
  problem.grips.front().frame->d1 = Eigen::Vector3d(0.2, 1, 0.4);
  problem.grips.back().frame->d1 = Eigen::Vector3d(1, -0.2, 0.6);
  expect_agreement();
  // A rotation of half a turn counts as +pi in both models, whatever the rounding error is.
  for (const double aside : {-1e-12, 1e-12}) {
    problem = turned_rod(0.8, 0, 8);
    problem.grips.front().frame->d1 = Eigen::Vector3d::UnitZ();
    problem.grips.back().frame->d1 = Eigen::Vector3d(0, aside, -1);
    EXPECT_GT(solved(problem).twists.at(0).angle, 1);
    expect_agreement();
  }
}

TEST(Twist, IsFollowedWhileTheGripperTurns) {
  EnergySolver solver;
  Equilibrium followed = solver.solve(turned_rod(0.7, 1, 8));
  for (const double roll : {1.1, 1.3, 1.2}) {
    followed = test::converged(solver.follow(turned_rod(0.7, roll, 8)));
    const Equilibrium fresh = solved(turned_rod(0.7, roll, 8));
    EXPECT_LT(followed.evaluations, fresh.evaluations);
    EXPECT_NEAR(followed.energy.total(), fresh.energy.total(), 1e-9);
    EXPECT_NEAR(axial_torque(followed), axial_torque(fresh), 1e-8);
  }
}

TEST(Twist, IsRefusedWhereItMeansNothing) {
  Problem problem = turned_rod(0.8, 1, 0);
  problem.torsional_stiffness = 0;
  EXPECT_THROW((void)solve_energy(problem), std::invalid_argument);
  problem = turned_rod(0.8, 1, 0);
  problem.grips.front().direction.reset();
  EXPECT_THROW((void)solve_energy(problem), std::invalid_argument);
  problem = turned_rod(0.8, 1, 0);
  problem.grips.back().frame->d1 = Eigen::Vector3d(2, 0, 0);
  EXPECT_THROW((void)solve_energy(problem), std::invalid_argument);
}

// The initial guess has the number of turns of another roll.
TEST(Twist, StartedFromAnotherRollItMeetsItsOwn) {
  Problem problem = test::framed_clamps(5, 0.7, 0.8, 0);
  const auto solved = [&problem](double roll, const Equilibrium* start) {
    problem.grips[1].frame->roll = roll;
    return test::converged(solve_energy(problem, {.start = start}));
  };
  const Equilibrium first = solved(1, nullptr);
  for (const double roll : {1.01, 1.3, 0.6}) {
    const Equilibrium searched = solved(roll, nullptr);
    const Equilibrium started = solved(roll, &first);
    EXPECT_NEAR(started.twists.at(0).angle, searched.twists.at(0).angle, 1e-8);
    EXPECT_NEAR(started.energy.total(), searched.energy.total(), 1e-9);
    EXPECT_GT(std::abs(started.twists.at(0).angle - first.twists.at(0).angle), 1e-3);
  }
}

}  // namespace
}  // namespace dlo::energy_model
