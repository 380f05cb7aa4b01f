// Tests of the results for shapes near a fold, against the elastica computed by shooting from its
// tip in long double.

#include <gtest/gtest.h>

#include <cmath>
#include <span>
#include <vector>

#include "dlo/energy_model/energy.hpp"
#include "problems.hpp"
#include "runge_kutta.hpp"
#include "solved.hpp"

namespace dlo::energy_model {
namespace {

using Real = long double;

/// Returns a rod that is clamped along x and stiff out of the plane of its weight.
Problem ribbon(Real gamma) {
  Problem problem = heavy_cantilever(static_cast<double>(gamma), 0);
  problem.bending_stiffness = 50;
  problem.bending_stiffness_2 = 1;
  problem.torsional_stiffness = 50;
  return problem;
}

/// theta'' = Gamma s cos(theta) from the tip, s = 0, where theta' = 0; with the derivative by
/// theta(0) and what lies between the tip and here.
using State = Eigen::Matrix<Real, 6, 1>;  // theta, theta', their derivatives, x, y

/// Integrates by the Runge-Kutta method, at equally spaced s from the tip to the clamp.
std::vector<State> integrate_from_tip(Real gamma, Real tip_angle, int steps) {
  const Real h = Real(1) / static_cast<Real>(steps);
  const auto rates = [gamma](Real s, const State& u) {
    return State(u[1], gamma * s * std::cos(u[0]), u[3], -gamma * s * std::sin(u[0]) * u[2],
                 std::cos(u[0]), std::sin(u[0]));
  };
  std::vector<State> states = {State(tip_angle, 0, 1, 0, 0, 0)};
  for (int i = 0; i < steps; ++i) {
    states.push_back(test::runge_kutta(rates, static_cast<Real>(i) * h, states.back(), h));
  }
  return states;
}

/// Returns the state at the clamp, extrapolated twice: accurate to 1e-15.
State at_clamp(Real gamma, Real tip_angle) {
  constexpr int steps = 200;
  const State a = integrate_from_tip(gamma, tip_angle, steps).back();
  const State b = integrate_from_tip(gamma, tip_angle, 2 * steps).back();
  const State c = integrate_from_tip(gamma, tip_angle, 4 * steps).back();
  const State coarse = b + (b - a) / Real(15);
  const State fine = c + (c - b) / Real(15);
  return fine + (fine - coarse) / Real(31);
}

struct Fold {
  Real gamma, tip_angle;
};

/// Returns the fold at which the angle at the clamp and its derivative by that at the tip are zero,
/// by Newton's method.
Fold fold_of_clamp_angle() {
  Fold fold = {41.4L, 4.0L};
  for (int i = 0; i < 8; ++i) {
    constexpr Real step = 1e-6L;
    const State here = at_clamp(fold.gamma, fold.tip_angle);
    const State heavier = at_clamp(fold.gamma + step, fold.tip_angle);
    const State turned = at_clamp(fold.gamma, fold.tip_angle + step);
    const Real a = (heavier[0] - here[0]) / step;
    const Real b = here[2];
    const Real c = (heavier[2] - here[2]) / step;
    const Real d = (turned[2] - here[2]) / step;
    const Real determinant = a * d - b * c;
    fold.gamma -= (d * here[0] - b * here[2]) / determinant;
    fold.tip_angle -= (a * here[2] - c * here[0]) / determinant;
  }
  return fold;
}

/// Returns the shape that is shot from this tip angle, as an initial guess.
Equilibrium shape_of(Real gamma, Real tip_angle) {
  constexpr int steps = 2000;
  const std::vector<State> states = integrate_from_tip(gamma, tip_angle, steps);
  Equilibrium shape;
  shape.sample = [states](std::span<const double> arc_lengths) {
    Samples samples;
    samples.arc_length.assign(arc_lengths.begin(), arc_lengths.end());
    const auto count = static_cast<Eigen::Index>(arc_lengths.size());
    samples.tangents.setZero(3, count);
    samples.d1.setZero(3, count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const double s = samples.arc_length[static_cast<std::size_t>(i)];
      const auto at = static_cast<std::size_t>(std::lround((1 - s) * steps));
      const auto theta = static_cast<double>(states[at][0]);
      samples.tangents.col(i) << std::cos(theta), std::sin(theta), 0;
      samples.d1.col(i) << -std::sin(theta), std::cos(theta), 0;
    }
    return samples;
  };
  return shape;
}

Eigen::Vector2d tip_of(const Equilibrium& equilibrium) {
  return test::point_at(equilibrium, 1).head<2>();
}

TEST(Fold, WhatIsCalledConvergedIsAsNearAsItsErrorSays) {
  const Fold fold = fold_of_clamp_angle();
  ASSERT_NEAR(static_cast<double>(fold.gamma), 41.4, 0.01);
  const Equilibrium start = shape_of(fold.gamma, fold.tip_angle + 0.05L);
  int open = 0;
  double softest = 1;
  Real angle = fold.tip_angle + 0.3L;
  for (const double exponent : {2., 3., 4., 5., 6., 7., 8., 9., 10., 11., 12., 13., 13.5, 14.}) {
    SCOPED_TRACE(testing::Message() << "1e-" << exponent << " above the fold");
    const Real gamma =
        static_cast<double>(fold.gamma * (1 + std::pow(10.0L, static_cast<Real>(-exponent))));
    const Equilibrium found = solve_energy(ribbon(gamma), {.start = &start});
    // The nearer the weight is to the fold, the nearer the two shapes are. Newton's method starts
    // on the side away from the other shape.
    for (int i = 0; i < 60; ++i) {
      const State here = at_clamp(gamma, angle);
      angle -= here[0] / here[2];
      if (std::abs(here[0] / here[2]) < 1e-15L) break;
    }
    const State exact = at_clamp(gamma, angle);
    const double error = (tip_of(found) - Eigen::Vector2d(static_cast<double>(exact[4]),
                                                          static_cast<double>(exact[5])))
                             .norm();
    EXPECT_LE(error, found.error_estimate);
    // The square of the smallest eigenvalue is proportional to the distance of the weight from the
    // fold.
    if (exponent >= 5 && exponent <= 9) {
      EXPECT_NEAR(found.smallest_eigenvalue / softest, std::sqrt(0.1), 0.002);
    }
    if (exponent <= 9) {
      EXPECT_EQ(found.status, SolveStatus::converged) << found.message;
      EXPECT_LT(found.error_estimate, 1e-5);
      softest = found.smallest_eigenvalue;
    }
    if (exponent <= 13) continue;
    // This near to the fold, the truncated terms determine whether an equilibrium exists at all.
    EXPECT_EQ(found.status, SolveStatus::near_singular) << found.message;
    EXPECT_EQ(found.neutral_directions, 1);
    if (found.smallest_eigenvalue > 1e-7) ++open;
  }
  EXPECT_GE(open, 1) << "all are singular by their eigenvalue alone";
  EXPECT_LT(softest, 1e-4);
}

TEST(Fold, BelowItNothingOfTheBranchIsCalledConverged) {
  const Fold fold = fold_of_clamp_angle();
  const Equilibrium start = shape_of(fold.gamma, fold.tip_angle);
  for (int exponent = 4; exponent <= 15; ++exponent) {
    const Real gamma = fold.gamma * (1 - std::pow(10.0L, -exponent));
    const Equilibrium found = solve_energy(ribbon(gamma), {.start = &start});
    // Beyond the fold the shape that hangs on the other side is the only equilibrium.
    const bool is_reversed = tip_of(found).x() < 0;
    EXPECT_FALSE(is_reversed && succeeded(found.status)) << exponent << ": " << found.message;
  }
}

}  // namespace
}  // namespace dlo::energy_model
