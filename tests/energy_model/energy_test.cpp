#include "dlo/energy_model/energy.hpp"

#include <gtest/gtest.h>

#include "dlo/energy_model/exact.hpp"
#include "problems.hpp"
#include "runge_kutta.hpp"
#include "solved.hpp"

namespace dlo::energy_model {
namespace {

TEST(Energy, AgreesWithExactAtEveryClampAngle) {
  for (const double gamma : {0.1, 1.0, 10.0, 100.0}) {
    for (int degrees = -90; degrees <= 90; degrees += 15) {
      SCOPED_TRACE(testing::Message() << "Gamma " << gamma << ", " << degrees << " deg");
      const Problem problem = heavy_cantilever(gamma, degrees);
      const Equilibrium energy = test::converged(solve_energy(problem));
      const Equilibrium exact = test::converged(solve_exact(problem));
      EXPECT_LT(test::largest_point_distance(energy, exact), gamma <= 10 ? 1e-9 : 1e-8);
      EXPECT_NEAR(energy.energy.total(), exact.energy.total(), 1e-10 * (1 + gamma));
      EXPECT_NEAR(energy.energy.bending, exact.energy.bending, 1e-9 * (1 + gamma));
      EXPECT_LT((energy.grips[0].torque - exact.grips[0].torque).norm(), 1e-9 * (1 + gamma));
    }
  }
}

TEST(Energy, OfOneClampIsFoundByAFewNewtonSteps) {
  EXPECT_LE(solve_energy(heavy_cantilever(0.18, 0)).evaluations, 4);
  for (const double gamma : {0.01, 0.5, 1.0, 10.0, 18.0, 100.0}) {
    EXPECT_LE(solve_energy(heavy_cantilever(gamma, 0)).evaluations, gamma < 10 ? 10 : 8) << gamma;
  }
}

TEST(Energy, FallsExponentiallyInTheNumberOfTerms) {
  const Problem problem = heavy_cantilever(10, 0);
  const Equilibrium exact = solve_exact(problem);
  double previous = 1;
  for (const int terms : {2, 4, 8, 12, 16}) {
    const Equilibrium energy = test::converged(solve_energy(problem, {.terms = terms}));
    EXPECT_EQ(energy.terms, terms);
    const double error = test::largest_point_distance(energy, exact);
    EXPECT_LT(error, previous / 10) << terms << " terms";
    previous = error;
  }
  EXPECT_LT(previous, 1e-10);
}

TEST(Energy, ClampAtTheEndIsTheMirrorOfAClampAtTheStart) {
  const Problem start = heavy_cantilever(5, 30);
  Problem end = start;
  end.grips[0].at = 1;
  end.grips[0].direction = -*start.grips[0].direction;
  const Equilibrium a = solve_energy(start);
  const Equilibrium b = solve_energy(end);
  const Equilibrium c = solve_exact(end);
  const std::vector<double> s = {0.0, 0.25, 1.0};
  const std::vector<double> mirrored = {1.0, 0.75, 0.0};
  EXPECT_LT((a.sample(s).points - b.sample(mirrored).points).norm(), 1e-12);
  EXPECT_LT((a.sample(s).tangents + b.sample(mirrored).tangents).norm(), 1e-12);
  EXPECT_LT((a.sample(s).curvature - b.sample(mirrored).curvature).norm(), 1e-11);
  EXPECT_LT((b.sample(s).points - c.sample(s).points).norm(), 1e-10);
  EXPECT_LT((a.grips[0].torque - b.grips[0].torque).norm(), 1e-11);
}

TEST(Energy, UprightRodStaysUprightBelowSelfBucklingAndFallsTowardsXAbove) {
  const double critical = test::self_buckling_gamma;
  const Equilibrium below = test::converged(solve_energy(heavy_cantilever(0.99 * critical, 90)));
  EXPECT_LT((test::point_at(below, 1) - Eigen::Vector3d(0, 1, 0)).norm(), 1e-12);
  const Equilibrium above = test::converged(solve_energy(heavy_cantilever(1.01 * critical, 90)));
  EXPECT_GT(test::point_at(above, 1).x(), 0.05);
}

/// Points of an upright heavy rod, by Runge-Kutta steps from its free end.
struct ShotFromTheTip {
  double base_angle = 0;    // angle at the clamp, from the vertical
  Eigen::Matrix2Xd points;  // at equal arc lengths, across and up
};

ShotFromTheTip shoot_from_tip(double gamma, double tip_angle) {
  constexpr Eigen::Index steps = 1000;
  using Real = long double;
  const Real h = Real(1) / steps;
  using State = Eigen::Matrix<Real, 2, 1>;  // angle, curvature
  const auto rates = [&](Real s, const State& at) {
    return State(at[1], -Real(gamma) * (1 - s) * std::sin(at[0]));
  };
  State state(tip_angle, 0);
  std::vector<Real> angles(steps + 1, state[0]);
  for (Eigen::Index i = steps; i > 0; --i) {
    state = test::runge_kutta(rates, h * static_cast<Real>(i), state, -h);
    angles[static_cast<std::size_t>(i) - 1] = state[0];
  }
  ShotFromTheTip shot;
  shot.base_angle = static_cast<double>(state[0]);
  shot.points.setZero(2, steps + 1);
  for (Eigen::Index i = 0; i < steps; ++i) {
    const auto from = static_cast<double>(angles[static_cast<std::size_t>(i)]);
    const auto to = static_cast<double>(angles[static_cast<std::size_t>(i) + 1]);
    shot.points.col(i + 1) =
        shot.points.col(i) +
        Eigen::Vector2d(std::sin(from) + std::sin(to), std::cos(from) + std::cos(to)) / 2 / steps;
  }
  return shot;
}

// Self-buckling is at Gamma = 7.8373474. Close to it a tilt of 1e-9 rotates the tip by up to a
// million times that angle. The steps and the trapezoidal rule of the reference are accurate to
// 2e-9 here.
TEST(Energy, NextToBucklingTheErrorStatedCoversTheTrueOne) {
  for (const double below : {1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9}) {
    for (const double tilt : {1e-7, 1e-8, 1e-9, 1e-11}) {
      SCOPED_TRACE(testing::Message() << below << ", " << tilt);
      const double gamma = 7.837347 * (1 - below);
      double low = 0;
      double high = 0.5;
      for (int i = 0; i < 60; ++i) {
        const double middle = (low + high) / 2;
        (shoot_from_tip(gamma, middle).base_angle > tilt ? high : low) = middle;
      }
      const Eigen::Matrix2Xd expected = shoot_from_tip(gamma, high).points;
      Problem problem = heavy_cantilever(gamma, 90);
      problem.grips[0].direction = Eigen::Vector3d(std::sin(tilt), std::cos(tilt), 0);
      // A section equal to the rest of the rod does not change it, but the solver no longer uses
      // the method for plain cantilevers.
      for (const bool plain : {true, false}) {
        if (!plain) problem.sections = {{0.4, 0.7, 1, 0, problem.weight_per_length}};
        const Equilibrium found = solve_energy(problem);
        const Eigen::Matrix3Xd points = found.sample(equal_arc_lengths(1, expected.cols())).points;
        const double off = (points.topRows(2) - expected).colwise().norm().maxCoeff();
        EXPECT_LE(off, found.error_estimate + 2e-9) << plain << ": " << found.message;
        EXPECT_LT(found.error_estimate, 1e-3) << "the estimate is not meaningful";
        EXPECT_TRUE(off < 1e-6 || !succeeded(found.status)) << off << " l, " << found.message;
      }
    }
  }
  // Far from there it is below the tolerance.
  EXPECT_LT(solve_energy(heavy_cantilever(1, 0)).error_estimate, 1e-10);
}

// Heavy rods between grips, slack to taut, up to the stiffness below which catenaries are used
// (catenary_limit_stiffness). The number of terms is chosen automatically, or is insufficient. The
// reference has twice the number of terms, whose error is small in comparison.
TEST(Energy, TheErrorStatedIsTheTrueOneWithinAFactorOfAThousand) {
  constexpr double rounding = 1e-12;
  const std::vector<double> s = equal_arc_lengths(1, 201);
  int compared = 0;
  for (const double gamma : {1e2, 1e8, 9e9}) {
    for (const double apart : {0.3, 0.9, 0.99999}) {
      for (const int terms : {0, 24, 48}) {
        SCOPED_TRACE(testing::Message() << gamma << ", " << apart << ", " << terms);
        Problem problem = heavy_cantilever(gamma, 0);
        problem.grips.push_back({.at = 1, .position = {apart, apart < 0.99 ? 0.05 : 0, 0}});
        if (terms != 24) problem.grips[0].direction.reset();
        if (terms != 48) problem.grips[1].direction = Eigen::Vector3d::UnitX();
        const Equilibrium found = solve_energy(problem, {.terms = terms});
        if (!succeeded(found.status) || found.terms > 64) continue;
        const Equilibrium finer =
            solve_energy(problem, {.terms = 2 * found.terms, .start = &found});
        ASSERT_TRUE(succeeded(finer.status)) << finer.message;
        const double error = test::largest_point_distance(found, finer, s);
        EXPECT_LE(error, found.error_estimate + finer.error_estimate + rounding);
        EXPECT_LE(found.error_estimate, 1e3 * std::max(error, rounding));
        ++compared;
      }
    }
  }
  EXPECT_GE(compared, 22);
}

TEST(Energy, OfOneClampTurnsTowardsTheLoadByTheShorterWay) {
  const std::vector<double> s = equal_arc_lengths(1, 33);
  for (const double gamma : {0.5, 7.0, 9.0, 11.9, 12.1, 40.0, 60.0, 300.0}) {
    for (const double degrees : {-89.0, -30.0, 0.0, 45.0, 80.0, 89.0, 95.0, 130.0, 200.0}) {
      const Equilibrium found = solve_energy(heavy_cantilever(gamma, degrees));
      ASSERT_EQ(found.status, SolveStatus::converged) << gamma << ' ' << degrees;
      const Eigen::RowVectorXd across = found.sample(s).tangents.row(0);
      const double side = across[0] > 0 ? 1 : -1;
      EXPECT_GT((side * across).minCoeff(), -1e-8) << gamma << ' ' << degrees;
    }
  }
}

TEST(Energy, StoppedEarlyIsAFailureThatSaysSo) {
  const Equilibrium result = solve_energy(heavy_cantilever(10, 0), {.max_evaluations = 2});
  EXPECT_EQ(result.status, SolveStatus::evaluation_limit);
  EXPECT_FALSE(succeeded(result.status));
  EXPECT_EQ(Equilibrium().status, SolveStatus::not_run);
}

TEST(Energy, RefusesWhatItDoesNotKnow) {
  const auto refused = [](const auto& invalidate) {
    Problem problem = heavy_cantilever(1, 0);
    invalidate(problem);
    EXPECT_THROW((void)solve_energy(problem), std::invalid_argument);
  };
  refused([](Problem& p) { p.length = -1; });
  refused([](Problem& p) { p.bending_stiffness = NAN; });
  refused([](Problem& p) { p.grips.clear(); });
  refused([](Problem& p) { p.loads = {{1.5, {0, 1, 0}}}; });
  EXPECT_THROW((void)solve_energy(heavy_cantilever(1, 0), {.terms = 1000}), std::invalid_argument);
  EXPECT_THROW((void)solve_energy(heavy_cantilever(1, 0), {.tolerance = 0}), std::invalid_argument);
}

}  // namespace
}  // namespace dlo::energy_model
