// Tests of contact by two methods that share no solver.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "../sanitized.hpp"
#include "../says.hpp"
#include "contact_samples.hpp"
#include "dlo/energy_model/energy.hpp"
#include "dlo/energy_model/exact.hpp"
#include "problems.hpp"
#include "random_contact.hpp"
#include "solved.hpp"
#include "start_along.hpp"

namespace dlo::energy_model {
namespace {

/// Numbers of the shapes of `solve_energy` that were refused, have contact, or were confirmed by
/// `solve_exact` from that shape, and of their contacts by kind.
struct Confirmed {
  bool may_be_near_singular = false;
  double place_error = 1e-6;        // allowed for the ends of a contact
  bool relative_to_weight = false;  // whether forces are compared with the weight alone
  int refused = 0;
  int touching = 0;
  int confirmed = 0;
  int lying = 0;
  int points = 0;
  int several = 0;

  /// Compares a shape with contact: points to 1e-8 of the length, directors to 1e-7, forces and
  /// torques to 1e-7 and the energy to 1e-8 of the weight, or of the largest of 1 + weight and the
  /// grips' forces.
  void confirm(const Problem& problem, const Equilibrium* start = nullptr) {
    // A search has a time limit, because it may not end; a solve from an initial guess always ends.
    constexpr double no_limit = std::numeric_limits<double>::infinity();
    const double limit = start != nullptr ? no_limit : 20;
    const Equilibrium energy = solve_energy(problem, {.time_limit = limit, .start = start});
    refused += succeeded(energy.status) ? 0 : 1;
    if (!succeeded(energy.status) || energy.contacts.empty()) return;
    ++touching;
    test::expect_only_pushed(problem, energy);
    const Equilibrium exact = solve_exact(problem, {.start = &energy});
    ASSERT_TRUE(succeeded(exact.status) ||
                (may_be_near_singular && exact.status == SolveStatus::near_singular))
        << exact.message;
    ++confirmed;
    ASSERT_EQ(exact.contacts.size(), energy.contacts.size());
    const std::vector<double> at = equal_arc_lengths(problem.length, 101);
    const Samples one = exact.sample(at);
    const Samples other = energy.sample(at);
    EXPECT_LT((one.points - other.points).colwise().norm().maxCoeff(), 1e-8 * problem.length);
    ASSERT_EQ(one.d1.cols(), other.d1.cols());
    if (one.d1.cols() > 0) EXPECT_LT((one.d1 - other.d1).colwise().norm().maxCoeff(), 1e-7);
    const double weight = problem.weight_per_length.norm();
    double force = relative_to_weight ? weight : 1 + weight;
    for (const Reaction& grip : energy.grips) {
      if (!relative_to_weight) force = std::max(force, grip.force.norm());
    }
    for (std::size_t k = 0; k < energy.grips.size(); ++k) {
      EXPECT_LT((exact.grips[k].force - energy.grips[k].force).norm(), 1e-7 * force);
      EXPECT_LT((exact.grips[k].torque - energy.grips[k].torque).norm(), 1e-7 * force);
    }
    EXPECT_NEAR(exact.energy.total(), energy.energy.total(), 1e-8 * force);
    for (std::size_t k = 0; k < energy.contacts.size(); ++k) {
      EXPECT_EQ(exact.contacts[k].kind, energy.contacts[k].kind);
      EXPECT_EQ(exact.contacts[k].obstacle, energy.contacts[k].obstacle);
      EXPECT_NEAR(exact.contacts[k].begin, energy.contacts[k].begin, place_error);
      EXPECT_NEAR(exact.contacts[k].end, energy.contacts[k].end, place_error);
      EXPECT_LT((exact.contacts[k].force - energy.contacts[k].force).norm(), 1e-7 * force);
      (energy.contacts[k].kind == ContactKind::lying ? lying : points) += 1;
    }
    several += energy.contacts.size() > 1 ? 1 : 0;
  }
};

TEST(ExactContact, ConfirmsRodsThatTouchAFloorOrLieOnIt) {
  Confirmed confirmation{.place_error = 1e-7, .relative_to_weight = true};
  for (const double gamma : {0.3, 1.0, 3.0, 10.0, 100.0, 1e3, 1e4, 1e5}) {
    for (const double height : {0.01, 0.03, 0.1, 0.3}) {
      SCOPED_TRACE("Gamma " + std::to_string(gamma) + ", height " + std::to_string(height));
      // A soft rod that hangs down steeply rotates about the vertical almost without a change of
      // energy.
      confirmation.may_be_near_singular = gamma >= 1e4 && height == 0.3;
      confirmation.confirm(over_floor(gamma, height));
    }
  }
  EXPECT_EQ(confirmation.refused, 0);
  EXPECT_GT(confirmation.points, 2);
  EXPECT_GT(confirmation.lying, 10);
}

// Out of a plane: a clamp that points downwards and a load from the side, above a floor and next to
// a wall.
TEST(ExactContact, ConfirmsARodThatALoadTakesOutOfThePlane) {
  Confirmed confirmation;
  for (const double side : {0.5, 2.0, 8.0}) {
    SCOPED_TRACE("side load " + std::to_string(side));
    Problem problem = over_floor(20, 0.15);
    problem.grips[0].direction = Eigen::Vector3d(1, -0.1, 0.2).normalized();
    problem.loads = {{0.6, {0, 0, side}}};
    problem.obstacles.push_back({obstacle::Body::half_space({0, 0, 2}, {0, 0, -1})});
    confirmation.confirm(problem);
  }
  EXPECT_EQ(confirmation.confirmed, 3);
}

// One to three grips of all kinds above floors and next to walls.
TEST(ExactContact, ConfirmsRandomRodsAgainstPlanes) {
  for (const bool space : {false, true}) {
    Confirmed confirmation;
    for (unsigned seed = 0; seed < 40; ++seed) {
      SCOPED_TRACE("seed " + std::to_string(seed) + (space ? " in space" : " in the plane"));
      confirmation.confirm(test::random_touching_problem(seed, space, 300));
    }
    EXPECT_LE(confirmation.refused, 1);
    EXPECT_GE(confirmation.touching, 14);
    EXPECT_EQ(confirmation.confirmed, confirmation.touching);
    EXPECT_GE(confirmation.points, 5);
    EXPECT_GE(confirmation.lying, 5);
  }
}

// Cylinders, balls and capsules, touched at a point or wrapped.
TEST(ExactContact, ConfirmsRandomRodsOverBodies) {
  for (const bool space : {false, true}) {
    Confirmed confirmation;
    for (int seed = 0; seed < test::draws(40); ++seed) {
      SCOPED_TRACE("seed " + std::to_string(seed) + (space ? " in space" : " in the plane"));
      const std::optional<Problem> problem =
          test::random_problem_with_body(static_cast<unsigned>(seed), space);
      if (problem) confirmation.confirm(*problem);
    }
    EXPECT_GE(confirmation.touching, test::draws(30));
    EXPECT_EQ(confirmation.confirmed, confirmation.touching);
    EXPECT_GE(confirmation.points, test::draws(20));
  }
}

// The part of a rod that is wrapped around a peg has the peg's curvature. In space, where the
// tension is not perpendicular to the axis, it is a helix.
TEST(ExactContact, ConfirmsTautRodsAroundAPeg) {
  Confirmed confirmation;
  constexpr double radius = 0.05;
  for (const double aside : {0.0, 0.02}) {
    SCOPED_TRACE("aside " + std::to_string(aside));
    Problem problem = test::rod_pulled_over_peg(radius, 3e3, aside);
    problem.weight_per_length = {0, -10, 0};
    const Equilibrium start = test::start_over_peg(radius);
    confirmation.confirm(problem, &start);
  }
  EXPECT_EQ(confirmation.lying, 2);
  EXPECT_EQ(confirmation.confirmed, 2);
}

// Two horizontal clamps above a floor: free spans on both sides of the contact interval, and a taut
// rod with a point contact, in units of a real rod.
TEST(ExactContact, ConfirmsACableBetweenTwoClampsOverAFloor) {
  Confirmed confirmation;
  for (const double apart : {0.9, 0.95, 0.99}) {
    for (const double depth : {0.02, 0.1, 0.2}) {
      SCOPED_TRACE("apart " + std::to_string(apart) + ", depth " + std::to_string(depth));
      Problem cable;
      cable.length = 2;
      cable.bending_stiffness = 3e-3;
      cable.weight_per_length = {0, -0.8, 0};
      const Eigen::Vector3d level = Eigen::Vector3d::UnitX();
      cable.grips = {{0, {1, 1, 0}, level}, {2, {1 + 2 * apart, 1, 0}, level}};
      cable.obstacles = {{obstacle::Body::half_space({0, 1 - depth, 0}, {0, 1, 0})}};
      confirmation.confirm(cable);
    }
  }
  EXPECT_GE(confirmation.lying, 3);
  EXPECT_EQ(confirmation.confirmed, confirmation.touching);
}

// Strips that stand, lie or are held askew, and rods whose middle is stiffer, on a floor and over a
// peg: both models have the same forces, and the same directors.
TEST(ExactContact, ConfirmsStripsAndSections) {
  Confirmed confirmation;
  for (const double roll : {0.0, 0.4, 1.2}) {
    for (const bool peg : {false, true}) {
      SCOPED_TRACE("roll " + std::to_string(roll) + (peg ? ", peg" : ", floor"));
      Problem strip = over_floor(peg ? 3 : 20, 0.12);
      strip.bending_stiffness_2 = 0.3;
      strip.torsional_stiffness = 0.5;
      strip.grips[0].frame = FrameHold{.d1 = Eigen::Vector3d::UnitZ(), .roll = roll};
      if (peg) {
        strip.obstacles = {{obstacle::Body::cylinder({0.5, -0.12, 0}, {0.1, 0, 1}, 0.1)}};
      }
      confirmation.confirm(strip);
    }
  }
  for (const double stiffer : {0.3, 3.0}) {
    SCOPED_TRACE("stiffer " + std::to_string(stiffer));
    Problem rod = over_floor(30, 0.1);
    rod.sections = {{.begin = 0.1, .end = 0.3, .bending_stiffness = stiffer}};
    rod.sections[0].weight_per_length = {0, -60, 0};
    confirmation.confirm(rod);
  }
  EXPECT_GE(confirmation.touching, 7);
  EXPECT_EQ(confirmation.confirmed, confirmation.touching);
}

// A weightless rod that a ball lifts by more than its radius slides off the ball, by rotation about
// the clamp's axis. If it is lifted by less, it stays on the ball. From a peg along z it cannot
// slide off.
TEST(ExactContact, ARodOverABallFallsOffWhereItsCentreIsAboveTheClampsAxis) {
  constexpr double radius = 0.05;
  const auto with = [](bool ball, double height) {
    const Eigen::Vector3d centre(0.6, height * radius, 0);
    Problem problem = heavy_cantilever(0, 0);
    problem.obstacles = {{ball ? obstacle::Body::sphere(centre, radius)
                               : obstacle::Body::cylinder(centre, {0, 0, 1}, radius)}};
    return problem;
  };
  for (const bool ball : {true, false}) {
    Equilibrium last = test::require_usable(solve_energy(with(ball, -0.5)));
    for (const double height : {-0.5, -0.3, -0.1, 0.1, 0.3, 0.5}) {
      SCOPED_TRACE((ball ? "ball " : "peg ") + std::to_string(height));
      Equilibrium exact = solve_exact(with(ball, height), {.start = &last});
      EXPECT_EQ(exact.status, ball && height > 0 ? SolveStatus::saddle : SolveStatus::converged)
          << exact.message;
      ASSERT_EQ(exact.contacts.size(), 1U);
      EXPECT_GT(exact.contacts[0].force.y(), 0);
      last = std::move(exact);
    }
  }
}

TEST(ExactContact, NoRodWithinAnObstacleIsConfirmed) {
  // The initial shape is at rest without the floor and has no contacts.
  Problem problem = heavy_cantilever(8, 0);
  const Equilibrium free = solve_energy(problem);
  const double tip = test::point_at(free, 1).y();
  problem.obstacles = {{obstacle::Body::half_space({0, tip + 1e-3, 0}, {0, 1, 0})}};
  const Equilibrium found = solve_exact(problem, {.start = &free});
  EXPECT_EQ(found.status, SolveStatus::not_verified) << found.message;
  EXPECT_NEAR(found.penetration, 1e-3, 1e-9);
}

// The ball is a third as wide as the distance of the cross-sections at which pressures are sampled.
// The rod passes through its centre, or next to it.
TEST(ExactContact, NoRodEntersASmallBall) {
  constexpr double radius = 1e-3;
  const Problem alone = heavy_cantilever(8, 0);
  const Equilibrium free = solve_energy(alone);
  for (double s = 0.5; s < 0.508; s += 1.3e-3) {
    const Eigen::Vector3d centre = test::point_at(free, s);
    Problem problem = alone;
    problem.obstacles = {{obstacle::Body::sphere(centre, radius)}};
    const Equilibrium entered = solve_exact(problem, {.start = &free});
    EXPECT_EQ(entered.status, SolveStatus::not_verified) << s << entered.message;
    EXPECT_NEAR(entered.penetration, radius, 0.011 * radius) << s;
    problem.obstacles = {
        {obstacle::Body::sphere(centre + Eigen::Vector3d(0, 0, 1.001 * radius), radius)}};
    const Equilibrium passed = test::converged(solve_exact(problem, {.start = &free}));
    EXPECT_EQ(passed.penetration, 0) << s;
  }
}

// The initial guess touches an obstacle that is then moved away. If the contact is kept, the
// equations have a solution with a tensile contact force, which an obstacle cannot exert.
TEST(ExactContact, NoObstacleIsConfirmedToPull) {
  const auto over = [](bool peg, double height) {
    Problem problem = heavy_cantilever(0.3, 0);
    problem.obstacles = {{peg ? obstacle::Body::cylinder({0.7, height - 0.1, 0}, {0, 0, 1}, 0.1)
                              : obstacle::Body::half_space({0, height, 0}, {0, 1, 0})}};
    return problem;
  };
  const Equilibrium alone = solve_energy(heavy_cantilever(0.3, 0));
  const Samples at = alone.sample(std::vector<double>{0.7, 1});
  // The highest point of a peg below an inclined rod is farther from the rod than the point of the
  // peg nearest to the rod.
  const double aside = 0.1 * (1 / at.tangents(0, 0) - 1);
  for (const bool peg : {false, true}) {
    const double free = peg ? at.points(1, 0) - aside : at.points(1, 1);
    const Equilibrium touching = test::converged(solve_energy(over(peg, free + 0.008)));
    ASSERT_EQ(touching.contacts.size(), 1U);
    EXPECT_TRUE(succeeded(solve_exact(over(peg, free + 0.004), {.start = &touching}).status));
    for (const double way : {1e-4, 1e-3, 0.01}) {
      SCOPED_TRACE((peg ? "peg " : "floor ") + std::to_string(way));
      const Equilibrium exact = solve_exact(over(peg, free - way), {.start = &touching});
      EXPECT_EQ(exact.status, SolveStatus::not_verified) << exact.message;
      EXPECT_NE(exact.message.find("tensile"), std::string::npos) << exact.message;
    }
  }
}

TEST(ExactContact, ToleranceIsThatOfTheIntegratorWhereTheRodTouchesToo) {
  const Problem problem = over_floor(30, 0.1);
  const std::vector<double> at = equal_arc_lengths(problem.length, 33);
  const Equilibrium energy = solve_energy(problem);
  const Eigen::Matrix3Xd fine = solve_exact(problem, {.start = &energy}).sample(at).points;
  const Equilibrium coarse =
      test::require_usable(solve_exact(problem, {.tolerance = 1e-3, .start = &energy}));
  const double off = (coarse.sample(at).points - fine).colwise().norm().maxCoeff();
  EXPECT_GT(off, 1e-12);  // the tolerance has an effect
  EXPECT_LT(off, 1e-3);
}

TEST(ExactContact, EndsWithItsTimeLimit) {
  const Problem problem = over_floor(1e5, 0.03);
  const Equilibrium energy = solve_energy(problem);
  const Equilibrium exact = solve_exact(problem, {.time_limit = 1e-9, .start = &energy});
  EXPECT_EQ(exact.status, SolveStatus::time_limit) << exact.message;
}

TEST(ExactContact, DetectsNoContactWithoutAStart) {
  const std::string error =
      dlo::test::error_of<std::invalid_argument>([] { return solve_exact(over_floor(10, 0.1)); });
  EXPECT_TRUE(dlo::test::has_all(error, {"number of obstacles", "a start with its contacts"}));
}

}  // namespace
}  // namespace dlo::energy_model
