// The exact solver with twist: closed forms of shapes and of where they buckle, the second variation
// against differences, balances and symmetries.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "dlo/energy_model/exact.hpp"
#include "problems.hpp"
#include "rod_span.hpp"
#include "second_variation.hpp"

namespace dlo::energy_model {
namespace {

using std::numbers::pi;

/// A rod of unit length and stiffness, clamped at both ends.
Problem clamped(const Eigen::Vector3d& end, const Eigen::Vector3d& direction, double c,
                double roll) {
  Problem problem = test::two_clamps(0, 0.5);
  problem.torsional_stiffness = c;
  problem.grips[1].position = end;
  problem.grips[1].direction = direction;
  problem.grips[0].frame = FrameHold{};
  problem.grips[1].frame = FrameHold{.d1 = std::nullopt, .roll = roll};
  return problem;
}

/// The span of a rod between clamps that hold frames.
RodSpan span_of(const Problem& problem) { return cut_at_clamps(problem).front(); }

SpanStates states_of(const std::function<RodState(double)>& state) {
  return [state](const std::vector<double>& s) {
    std::vector<RodState> states;
    for (const double at : s) states.push_back(state(at));
    return states;
  };
}

/// Root of a function that is smooth near it: of the parabola through three values.
double root_near(double x, double h, const std::function<double(double)>& value) {
  for (int i = 0; i < 3; ++i) {
    const double before = value(x - h);
    const double here = value(x);
    const double after = value(x + h);
    const double slope = (after - before) / (2 * h);
    const double bend = (after - 2 * here + before) / (2 * h * h);
    double step = -here / slope;
    for (int k = 0; k < 5; ++k) step = -(here + bend * step * step) / slope;
    x += step;
    h /= 10;
  }
  return x;
}

TEST(TwistedSecondVariation, VanishesWhereAStraightRodBuckles) {
  // Clamped, without tension, its ends free to come nearer but not to leave the line... the smallest
  // root of tan(M / 2) = M / 2 (Greenhill): M l / EI = 8.986818916.
  const Problem problem = clamped({1, 0, 0}, {1, 0, 0}, 0.01, 0);
  const RodSpan span = span_of(problem);
  const auto smallest = [&](double torque) {
    return second_variation(span, states_of([&](double) {
                              RodState state;
                              state.t = Eigen::Vector3d::UnitX();
                              state.torque = torque;
                              return state;
                            }))
        .smallest;
  };
  EXPECT_GT(smallest(8.98), 0);
  EXPECT_LT(smallest(8.99), 0);
  EXPECT_NEAR(root_near(8.9, 0.01, smallest), 8.986818916, 1e-8);
}

TEST(TwistedSecondVariation, VanishesWhereMichellsRingBuckles) {
  for (const double c : {0.6, 1.0, 1.5}) {
    const Problem problem = clamped({0, 0, 0}, {1, 0, 0}, c, 0);
    const RodSpan span = span_of(problem);
    const auto smallest = [&](double angle) {
      // An axial torque in a planar circle needs the force M kappa out of the plane.
      return second_variation(span, states_of([&](double s) {
                                const double k = 2 * pi;
                                RodState state;
                                state.t = {std::cos(k * s), std::sin(k * s), 0};
                                state.v = k * Eigen::Vector3d(-state.t.y(), state.t.x(), 0);
                                state.torque = c * angle;
                                state.n = {0, 0, k * state.torque};
                                return state;
                              }))
          .smallest;
    };
    const double critical = 2 * pi * std::sqrt(3.0) / c;
    EXPECT_NEAR(smallest(critical * (1 - 1e-3)), 0, 1e-2);
    EXPECT_NEAR(root_near(critical * (1 - 1e-3), 1e-3, smallest) / critical, 1, 1e-7) << c;
  }
}

TEST(ExactTwist, ZeroIsWhatTheRodWithoutFramesHas) {
  Problem problem = clamped({0.6, 0.2, 0.1}, {0.8, 0.3, -0.5}, 0.7, 0);
  problem.weight_per_length = {0, -5, 0};
  const Equilibrium twisted = solve_exact(problem);
  ASSERT_EQ(twisted.status, SolveStatus::converged) << twisted.message;
  Problem plain = problem;
  for (Grip& grip : plain.grips) grip.frame.reset();
  const Equilibrium expected = solve_exact(plain);
  const std::vector<double> s = equal_arc_lengths(1, 21);
  EXPECT_EQ((twisted.sample(s).points - expected.sample(s).points).norm(), 0);
  ASSERT_EQ(twisted.twists.size(), 1U);
  EXPECT_EQ(twisted.twists[0].angle, 0);
  EXPECT_TRUE(expected.twists.empty());
}

TEST(ExactTwist, Trial) {
  for (const double roll : {1.0, 6.0, 12.0}) {
    Problem problem = clamped({0.6, 0.2, 0.1}, {0.8, 0.3, -0.5}, 0.7, roll);
    problem.weight_per_length = {0, -5, 0};
    const Equilibrium twisted = solve_exact(problem);
    ASSERT_EQ(twisted.status, SolveStatus::converged) << twisted.message;
    std::printf("roll %g: %s %g s, %d shots, curv %g angle %.12g torque %.12g E %.12g %.12g\n", roll,
                twisted.message.c_str(), twisted.seconds, twisted.evaluations,
                twisted.smallest_curvature, twisted.twists[0].angle, twisted.twists[0].torque,
                twisted.energy.bending, twisted.energy.twisting);
  }
}

}  // namespace
}  // namespace dlo::energy_model
