// Tests of rods on rigid obstacles.

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "contact/clearance.hpp"
#include "contact_samples.hpp"
#include "dlo/energy_model/energy.hpp"
#include "problems.hpp"
#include "random_contact.hpp"
#include "runge_kutta.hpp"
#include "solved.hpp"
#include "start_along.hpp"

namespace dlo::energy_model {
namespace {

/// A rod held above a floor, worked out from its shear force alone. Where it lies it is straight
/// and its weight is carried on the spot; up to the touch-down at s = b it hangs free:
///     theta'' = (w (b - s) - R) cos(theta),  theta = theta' = 0 at s = b,
/// R the floor's force at the touch-down. b and R follow from the height and from theta = 0 at
/// s = 0.
class LyingRod {
 public:
  LyingRod(double gamma, double height) : gamma_(gamma) {
    // Continuation in the height: it starts at small slopes, where beam theory is accurate.
    double h = std::min(height, 1e-3);
    Eigen::Vector2d unknown(std::pow(72 * h / gamma, 0.25), 0);
    unknown[1] = gamma * unknown[0] / 3;
    for (;; h = std::min(1.1 * h, height)) {
      solve(unknown, h);
      if (h == height) break;
    }
    b = unknown[0];
    R = unknown[1];
    residual = shoot(unknown, height).norm();
    tip = width_ + 1 - b;
  }

  double b = 0, R = 0, tip = 0, residual = 0;

 private:
  void solve(Eigen::Vector2d& unknown, double height) {
    for (int step = 0; step < 20; ++step) {
      const Eigen::Vector2d miss = shoot(unknown, height);
      if (miss.norm() < 1e-13) return;
      Eigen::Matrix2d jacobian;
      for (int k = 0; k < 2; ++k) {
        Eigen::Vector2d moved = unknown;
        const double h = 1e-6 * unknown[k];
        moved[k] += h;
        jacobian.col(k) = (shoot(moved, height) - miss) / h;
      }
      const Eigen::Vector2d way = -jacobian.partialPivLu().solve(miss);
      double share = 1;
      while (share > 1e-3 && !(shoot(unknown + share * way, height).norm() < miss.norm())) {
        share /= 2;
      }
      unknown += share * way;
    }
  }

  /// Returns the errors of angle and height at the start, by Runge-Kutta 4 backwards from the
  /// touch-down.
  Eigen::Vector2d shoot(const Eigen::Vector2d& unknown, double height) {
    using State = Eigen::Array4d;  // theta, theta', x, y
    const auto rate = [&](double back, const State& z) {
      return State(-z[1], -(gamma_ * back - unknown[1]) * std::cos(z[0]), -std::cos(z[0]),
                   -std::sin(z[0]));
    };
    State z = State::Zero();
    constexpr int steps = 1500;
    const double h = unknown[0] / steps;
    for (int i = 0; i < steps; ++i) z = test::runge_kutta(rate, i * h, z, h);
    width_ = -z[2];
    return {z[0], z[3] - height};
  }

  double gamma_;
  double width_ = 0;
};

TEST(Contact, LyingRodIsThatOfTheElastica) {
  int compared = 0;
  for (const double gamma : {10.0, 100.0, 1e3, 1e4, 1e5}) {
    for (const double height : {0.01, 0.1, 0.3}) {
      const LyingRod exact(gamma, height);
      if (!(exact.residual < 1e-10) || exact.b > 1) continue;  // if b > 1 only the tip touches
      SCOPED_TRACE("Gamma " + std::to_string(gamma) + ", height " + std::to_string(height));
      ++compared;
      const Problem problem = over_floor(gamma, height);
      const Equilibrium result = test::converged(solve_energy(problem));
      test::expect_only_pushed(problem, result);
      ASSERT_EQ(result.contacts.size(), 1);
      const ContactPart& contact = result.contacts[0];
      EXPECT_EQ(contact.kind, ContactKind::lying);
      EXPECT_NEAR(contact.begin, exact.b, 1e-8);
      EXPECT_EQ(contact.end, 1);
      EXPECT_NEAR(contact.begin_force, exact.R, 1e-7 * gamma);
      EXPECT_NEAR(contact.end_force, 0, 1e-7 * gamma);
      EXPECT_NEAR(contact.largest_pressure, gamma, 1e-4 * gamma);  // a difference
      EXPECT_NEAR(result.obstacles[0].y(), exact.R + gamma * (1 - exact.b), 1e-7 * gamma);
      EXPECT_NEAR(result.grips[0].force.y(), gamma * exact.b - exact.R, 1e-7 * gamma);
      const Samples tip = test::sample_at(result, 1);
      EXPECT_NEAR(tip.points(0, 0), exact.tip, 1e-8);
      EXPECT_NEAR(tip.points(1, 0), -height, 1e-12);
    }
  }
  EXPECT_GE(compared, 11);
}

// A rod that is clamped level on the floor exerts no force on its clamp: the floor carries it.
TEST(Contact, AClampOnTheFloorCarriesNothingOfWhatLies) {
  for (const double at : {0.0, 1.0}) {
    SCOPED_TRACE(at);
    Problem problem = over_floor(50, 0);
    problem.grips[0].at = at;
    const Equilibrium rod = test::converged(solve_energy(problem));
    ASSERT_EQ(rod.contacts.size(), 1);
    EXPECT_EQ(rod.contacts[0].begin, 0);
    EXPECT_EQ(rod.contacts[0].end, 1);
    EXPECT_NEAR(rod.contacts[0].force.y(), 50, 1e-6);
    EXPECT_LT(rod.grips[0].force.norm(), 1e-6);
    EXPECT_LT(rod.grips[0].torque.norm(), 1e-6);
  }
}

// The equilibrium does not depend on the end from which arc lengths are counted.
TEST(Contact, ReversedRodRestsAsTheOther) {
  for (unsigned seed = 0; seed < 12; ++seed) {
    const Problem problem = random_touching_problem(100 + seed, seed % 2 == 0, 100);
    Problem reversed = problem;
    for (Grip& grip : reversed.grips) {
      grip.at = problem.length - grip.at;
      if (grip.direction) grip.direction = Eigen::Vector3d(-*grip.direction);
    }
    const Equilibrium there = solve_energy(problem);
    const Equilibrium back = solve_energy(reversed);
    if (!succeeded(there.status) || !succeeded(back.status)) continue;
    // If the energies differ, the two shapes are different minima.
    const double scale = 1 + problem.weight_per_length.norm();
    if (std::abs(there.energy.total() - back.energy.total()) > 1e-3 * scale) continue;
    SCOPED_TRACE("seed " + std::to_string(seed));
    EXPECT_NEAR(there.energy.total(), back.energy.total(), 1e-8 * scale);
    ASSERT_EQ(there.contacts.size(), back.contacts.size());
    for (std::size_t i = 0; i < there.contacts.size(); ++i) {
      const ContactPart& a = there.contacts[i];
      const ContactPart& b = back.contacts[back.contacts.size() - 1 - i];
      EXPECT_NEAR(a.begin, 1 - b.end, 1e-6);
      EXPECT_NEAR(a.begin_force, b.kind == ContactKind::lying ? b.end_force : b.begin_force,
                  1e-5 * scale);
    }
  }
}

// A search that reaches its time limit at any stage returns finite reactions, and its message names
// the limit.
TEST(Contact, EndsWithNumbersWheneverTheTimeEnds) {
  Problem problem;
  problem.length = 1;
  problem.bending_stiffness = 1;
  problem.weight_per_length = {0, -2, 0};
  problem.grips = {{0, {0, 0.03, 0}, Eigen::Vector3d(-0.33, -0.94, 0).normalized()},
                   {1, {0.48, 0.18, 0}, Eigen::Vector3d(0.8, 0.6, 0).normalized()}};
  problem.obstacles = {{}};
  for (double limit = 1e-6; limit < 0.3; limit *= 1.4) {
    const Equilibrium result = solve_energy(problem, {.time_limit = limit});
    for (const Reaction& grip : result.grips) {
      EXPECT_TRUE(grip.force.allFinite() && grip.torque.allFinite()) << limit;
    }
    if (succeeded(result.status) || result.seconds < limit) continue;
    EXPECT_NE(result.message.find("time limit"), std::string::npos) << result.message;
  }
}

TEST(Contact, OutOfReachChangesNothing) {
  Problem problem = heavy_cantilever(20, 0);
  problem.obstacles = {{obstacle::Body::half_space({0, -2, 0}, {0, 1, 0})}};
  const Equilibrium free = test::converged(solve_energy(problem));
  EXPECT_EQ(free.penetration, 0);
  EXPECT_TRUE(free.contacts.empty());
  const Equilibrium without = solve_energy(heavy_cantilever(20, 0));
  EXPECT_LT(test::largest_point_distance(free, without), 1e-10);
  EXPECT_EQ(free.obstacles[0].norm(), 0);
  EXPECT_EQ(free.evaluations, without.evaluations);
}

// One of the initial guesses touches the obstacle at a point. If contact were kept after the
// obstacle has moved away, the obstacle would pull at the tip with 3 d EI / l^3, where d is the
// distance moved.
TEST(Contact, APointIsReleasedByAnObstacleThatMovesAway) {
  const Problem free = heavy_cantilever(0.3, 0);
  const double reach = -test::point_at(solve_energy(free), 1).y();
  const std::vector<double> at = equal_arc_lengths(free.length, 10001);
  const Eigen::Matrix3Xd alone = solve_energy(free).sample(at).points;
  // Returns the distance of the rod without obstacle from a peg whose top is at y = -top; < 0
  // inside.
  const auto from_peg = [&](double top) {
    const Eigen::Vector3d centre(0.7, -top - 0.1, 0);
    return (alone.colwise() - centre).colwise().norm().minCoeff() - 0.1;
  };
  double clear_peg = 0;
  while (from_peg(clear_peg) < 0) clear_peg += 1e-6;
  for (const bool peg : {false, true}) {
    const auto over = [&](double depth) {
      Problem problem = free;
      const Eigen::Vector3d top(peg ? 0.7 : 0.0, -depth * (peg ? 0.5 : 1.0), 0);
      problem.obstacles = {
          {peg ? obstacle::Body::cylinder(top - Eigen::Vector3d(0, 0.1, 0), {0, 0, 1}, 0.1)
               : obstacle::Body::half_space(top, {0, 1, 0})}};
      return problem;
    };
    const Equilibrium touching = test::converged(solve_energy(over(reach - 0.008)));
    ASSERT_EQ(touching.contacts.size(), 1U);
    for (const double way : {1e-6, 1e-5, 1e-4, 3e-4, 1e-3, 3e-3, 0.02, 0.1}) {
      SCOPED_TRACE((peg ? "peg " : "floor ") + std::to_string(way));
      const double depth = peg ? 2 * clear_peg : reach;
      for (const Equilibrium* start : {static_cast<const Equilibrium*>(nullptr), &touching}) {
        const Equilibrium left = test::converged(solve_energy(over(depth + way), {.start = start}));
        EXPECT_TRUE(left.contacts.empty());
        EXPECT_LT((left.sample(at).points - alone).colwise().norm().maxCoeff(), 1e-8);
      }
    }
  }
}

/// Judges a straight rod along a level floor. @param depth  depth of the rod in the floor, in
/// lengths
Equilibrium judge_rod_below_floor(double length, double depth) {
  Problem problem = heavy_cantilever(1, 0);
  problem.length = length;
  problem.obstacles = {{obstacle::Body::half_space({0, depth * length, 0}, {0, 1, 0})}};
  Equilibrium shape = test::start_along_polyline({{0, 0, 0}, {1, 0, 0}});
  judge_penetration(problem, shape);
  return shape;
}

TEST(Penetration, IsAllowedAsAShareOfTheLength) {
  for (const double length : {0.02, 1.0, 50.0}) {
    for (const double share : {0.5, 2.0}) {
      const double depth = share * allowed_penetration;
      const Equilibrium shape = judge_rod_below_floor(length, depth);
      EXPECT_NEAR(shape.penetration, depth * length, 1e-6 * depth * length);
      EXPECT_EQ(shape.status, share < 1 ? SolveStatus::converged : SolveStatus::not_verified)
          << length << ": " << shape.message;
    }
  }
}

}  // namespace
}  // namespace dlo::energy_model
