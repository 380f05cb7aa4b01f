// Tests of rods on pegs, balls and tables with edges.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "contact/clearance.hpp"
#include "contact_samples.hpp"
#include "dlo/energy_model/energy.hpp"
#include "problems.hpp"
#include "rolled_clamps.hpp"
#include "solved.hpp"
#include "start_along.hpp"

namespace dlo::energy_model {
namespace {

using obstacle::Body;

double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

// A taut weightless rod bends towards the peg by theta' = 2 (T/EI)^(1/2) sin(theta/2), theta from
// the line of its tension, and leaves it where that is the peg's curvature.
TEST(Peg, TautRodLeavesItWhereItsCurvatureIsThePegs) {
  for (const double radius : {0.03, 0.05, 0.1}) {
    for (const double tension : {3e3, 1e4}) {
      SCOPED_TRACE("radius " + std::to_string(radius) + ", tension " + std::to_string(tension));
      const Problem problem = test::rod_pulled_over_peg(radius, tension);
      // On this side of the peg it would hang from the clamp alone.
      const Equilibrium start = test::start_over_peg(radius);
      const Equilibrium rod = test::converged(solve_energy(problem, {.start = &start}));
      test::expect_only_pushed(problem, rod);
      ASSERT_EQ(rod.contacts.size(), 1);
      const ContactPart& contact = rod.contacts[0];
      ASSERT_EQ(contact.kind, ContactKind::lying);
      const Samples ends = rod.sample(std::array{contact.begin, contact.end});
      const double exact = 2 * std::asin(std::sqrt(1 / tension) / (2 * radius));
      EXPECT_NEAR(angle_between(ends.tangents.col(1), {0, -1, 0}), exact, 1e-8);
      const Eigen::Vector3d held = rod.grips[0].force;
      EXPECT_NEAR(angle_between(ends.tangents.col(0), -held), exact, 1e-8);
      // Without friction the tension is the same on both sides.
      EXPECT_NEAR(held.norm(), tension, 1e-8 * tension);
      const Eigen::Vector3d by_peg = -held - problem.loads[0].force;
      EXPECT_LT((contact.force - by_peg).norm(), 1e-8 * tension);
      EXPECT_LT((rod.obstacles[0] - by_peg).norm(), 1e-8 * tension);
    }
  }
}

// A nearly straight rod with the overhang a lifts off the table at the distance b = 2^(1/2) a
// behind the edge. The moment at the edge is w a^2 / 2. Moment, slope and height are zero at b,
// which requires w b^4 / 24 = w a^2 / 2 b^2 / 6.
TEST(Table, OverhangLiftsTheRodBehindTheEdge) {
  constexpr double overhang = 0.2;
  double last = 1;
  for (const double gamma : {4.0, 1.0, 0.25}) {
    SCOPED_TRACE("Gamma " + std::to_string(gamma));
    constexpr double radius = 1e-3;
    Problem problem = heavy_cantilever(gamma, 0);
    const Eigen::Vector3d size(1 - overhang + 1, 0.2, 1);
    const Eigen::Vector3d centre(1 - overhang - size.x() / 2, -size.y() / 2, 0);
    problem.obstacles = {{Body::box(centre, Eigen::Matrix3d::Identity(), size, radius)}};
    const Equilibrium rod = test::converged(solve_energy(problem));
    test::expect_only_pushed(problem, rod);
    ASSERT_EQ(rod.contacts.size(), 2);
    // The table carries the part of the rod that lies on it. The clamp there only prevents sliding
    // off the edge, where the contact force is perpendicular to the rod.
    EXPECT_NEAR(rod.grips[0].force.y(), 0, 1e-6 * gamma);
    const Eigen::Vector3d weight(0, gamma, 0);
    const Eigen::Vector3d pushed = rod.contacts[0].force + rod.contacts[1].force;
    EXPECT_LT((pushed + rod.grips[0].force - weight).norm(), 1e-6 * gamma);
    const Eigen::Vector3d across = test::sample_at(rod, rod.contacts[1].begin).tangents.col(0);
    EXPECT_NEAR(rod.contacts[1].force.dot(across), 0, 1e-6 * gamma);
    EXPECT_EQ(rod.contacts[0].kind, ContactKind::lying);
    EXPECT_EQ(rod.contacts[1].kind, ContactKind::touching);
    // The round edge begins a radius before the box ends.
    EXPECT_NEAR(rod.contacts[1].begin, 1 - overhang - radius, radius);
    const double edge = rod.contacts[1].begin;
    const double behind = (edge - rod.contacts[0].end) / (1 - edge);
    EXPECT_NEAR(behind, std::sqrt(2.0), 1e-3 * gamma);
    EXPECT_LT(std::abs(behind - std::sqrt(2.0)), last);
    last = std::abs(behind - std::sqrt(2.0));
    // The edge carries w a of the overhang and w b / 2 of the lifted part, and w a^2 / (2 b) of
    // their moment.
    const double a = 1 - edge;
    const double b = edge - rod.contacts[0].end;
    EXPECT_NEAR(rod.contacts[1].force.y(), gamma * (a + b / 2 + a * a / (2 * b)), 2e-3 * gamma);
  }
}

// A rope over a peg: the tensions at its ends differ by the weight of its length between their
// heights.
TEST(Peg, RopeHasTheTensionOfTheFrictionlessCapstan) {
  constexpr double gamma = 1e4;
  Problem problem = heavy_cantilever(gamma, 0);
  problem.grips = {{0, {-0.33, -0.28, 0}}, {1, {0.38, -0.29, 0}}};
  problem.obstacles = {{Body::cylinder({0, 0, 0}, {0, 0, 1}, 0.05)}};
  const Equilibrium start =
      test::start_along_polyline({{-0.33, -0.28, 0}, {0, 0.06, 0}, {0.38, -0.29, 0}});
  const Equilibrium rod = test::converged(solve_energy(problem, {.start = &start}));
  test::expect_only_pushed(problem, rod);
  ASSERT_EQ(rod.contacts.size(), 1);
  EXPECT_EQ(rod.contacts[0].kind, ContactKind::lying);
  const Samples ends = rod.sample(std::array{0.0, 1.0});
  const double before = -rod.grips[0].force.dot(ends.tangents.col(0));
  const double after = rod.grips[1].force.dot(ends.tangents.col(1));
  EXPECT_NEAR(before - after, gamma * (ends.points(1, 0) - ends.points(1, 1)), 1e-7 * gamma);
}

// A body thinner than the grid on which penetration is checked is detected, independently of the
// search.
TEST(Peg, AThinOneWithinARodIsSeenWhereverItIs) {
  Problem problem = test::framed_clamps(5, 0.7, 0.8, 1);
  const Equilibrium free = test::converged(solve_energy(problem));
  for (const double at : {0.30025, 0.5001, 0.71234}) {
    for (const double radius : {3e-5, 1e-4, 3e-4}) {
      const Samples there = test::sample_at(free, at);
      const Eigen::Vector3d aside = there.tangents.col(0).unitOrthogonal();
      const Eigen::Vector3d centre = there.points.col(0) + radius / 2 * aside;
      problem.obstacles = {{Body::sphere(centre, radius)}};
      Equilibrium within = free;
      judge_penetration(problem, within);
      EXPECT_EQ(within.status, SolveStatus::not_verified) << at << ", radius " << radius;
      EXPECT_NEAR(within.penetration, radius / 2, 0.01 * radius) << at;
      const Equilibrium rod = solve_energy(problem);
      if (succeeded(rod.status)) {
        EXPECT_LE(rod.penetration, allowed_penetration);
      } else {
        EXPECT_EQ(rod.status, SolveStatus::not_verified) << rod.message;
      }
    }
  }
}

}  // namespace
}  // namespace dlo::energy_model
