// Tests of times that differ by rounding, and of energies whose rounding exceeds the error of a
// step.

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <vector>

#include "dlo/energy_model/dynamics.hpp"
#include "dlo/energy_model/energy.hpp"
#include "problems.hpp"
#include "runge_kutta.hpp"
#include "solved.hpp"

namespace dlo::energy_model {
namespace {

/// Simulates a rod without weight whose clamp starts at once at 0.3 s, which strikes the rod.
/// Returns the frames at `frame` and 0.4 s.
Dynamics simulate_impact(const std::vector<double>& breaks, double frame) {
  constexpr double start = 0.3;
  MovingRod rod{.problem = test::heavy_cantilever(0, 0), .inertia = {.mass_per_length = 1}};
  rod.material_damping = 0.01;
  rod.motions = {[](double time) {
    const Vector3d velocity(0, 0.4, 0);
    GripPose pose;
    pose.position = std::max(0.0, time - start) * velocity;
    if (time > start + 1e-14) pose.velocity = velocity;
    return pose;
  }};
  rod.breaks = breaks;
  return simulate(rod, straight_rod(Vector3d::UnitX()), std::vector<double>{frame, 0.4},
                  {.terms = 8});
}

// 0.1 + 0.2 differs from 0.3 by rounding. No step between the two is possible or needed; a common
// event of two grips is processed once.
TEST(DynamicsRounding, FramesAndBreaksThatDifferByRoundingAreOneInstant) {
  constexpr double sum = 0.1 + 0.2;
  static_assert(sum > 0.3);
  const Dynamics plain = test::converged(simulate_impact({0.3}, 0.3));
  const std::vector<std::pair<std::vector<double>, double>> alike = {
      {{0.3}, sum}, {{sum}, 0.3}, {{0.3, 0.3}, 0.3}, {{0.3, sum}, 0.3}, {{sum, 0.3}, sum}};
  for (std::size_t i = 0; i < alike.size(); ++i) {
    const Dynamics rounded = simulate_impact(alike[i].first, alike[i].second);
    ASSERT_EQ(rounded.status, SolveStatus::converged) << i << ": " << rounded.message;
    EXPECT_LT(rounded.energy_error, 1e-6) << i;
    for (std::size_t k = 0; k < 2; ++k) {
      const Eigen::Matrix3Xd apart =
          test::point_at(rounded.frames[k], 1) - test::point_at(plain.frames[k], 1);
      EXPECT_LT(apart.norm(), 1e-9) << i << " " << k;
    }
  }
}

/// Returns the angle from the vertical of a pendulum of unit length, whose pivot moves to the side
/// with constant acceleration a: theta'' = -g sin(theta) - a cos(theta), by the Runge-Kutta method
/// of order four.
double pendulum_angle(double g, double a, double time) {
  constexpr int steps = 2000;
  const double h = time / steps;
  const auto rates = [&](double, const Eigen::Vector2d& state) {
    return Eigen::Vector2d(state[1], -g * std::sin(state[0]) - a * std::cos(state[0]));
  };
  Eigen::Vector2d state(0, 0);
  for (int i = 0; i < steps; ++i) state = test::runge_kutta(rates, i * h, state, h);
  return state[0];
}

constexpr double gravity = 9.81;
constexpr double acceleration = 1.5;
constexpr double payload = 0.3;

/// Returns a soft thread that hangs from a pin with a payload at its end; the pin moves to the side
/// with constant acceleration.
MovingRod thread_with_payload(double mass, double damping) {
  MovingRod rod;
  rod.problem.length = 1;
  rod.problem.bending_stiffness = 2e-6;
  rod.problem.weight_per_length = {0, -mass * gravity, 0};
  rod.problem.grips = {{.at = 0, .position = Vector3d::Zero()}};
  rod.problem.loads = {{1, {0, -payload * gravity, 0}}};
  rod.inertia.mass_per_length = mass;
  rod.inertia.point_masses = {{1, payload}};
  rod.material_damping = damping;
  rod.motions = {[](double time) {
    GripPose pose;
    pose.position.x() = acceleration * time * time / 2;
    pose.velocity.x() = acceleration * time;
    pose.acceleration.x() = acceleration;
    return pose;
  }};
  return rod;
}

/// Expects that the payload moves as a pendulum. @param share  largest allowed distance from
/// the pendulum, divided by its length
void expect_pendulum(const Dynamics& moved, const std::vector<double>& times, double share) {
  ASSERT_EQ(moved.status, SolveStatus::converged) << moved.message;
  for (std::size_t k = 0; k < times.size(); ++k) {
    const double pivot = acceleration * times[k] * times[k] / 2;
    const double theta = pendulum_angle(gravity, acceleration, times[k]);
    const Vector3d expected(pivot + std::sin(theta), -std::cos(theta), 0);
    EXPECT_LT((test::point_at(moved.frames[k], 1) - expected).norm(), share) << times[k];
  }
}

// With EI = 2e-6 N m^2 and 0.3 kg the potential of the load is 1e6 times the bending energy. Its
// rounding must not count as an error of a step.
TEST(DynamicsRounding, APayloadOnASoftThreadIsAPendulum) {
  constexpr double thread = 1e-3;
  const std::vector<double> times = {0.25, 0.5};
  expect_pendulum(simulate(thread_with_payload(thread, 0.01), straight_rod(-Vector3d::UnitY()),
                           times, {.terms = 4, .tolerance = 1e-6}),
                  times, 2 * thread / payload);
}

// The stiffness of the thread is geometric, due to its tension; the bending stiffness is 1e-6 of
// it. If Newton's matrix lacked the geometric stiffness, only steps of about one radian of the
// fastest mode would converge, 4500 in all. Waves of (T / m)^(1/2) = 17 m/s cross the thread in
// 0.06 s.
TEST(DynamicsRounding, AnUndampedThreadUnderTensionTakesTheStepsOfItsMotion) {
  constexpr double thread = 1e-2;
  const std::vector<double> times = {0.1, 0.2};
  const Dynamics moved = simulate(thread_with_payload(thread, 0), straight_rod(-Vector3d::UnitY()),
                                  times, {.terms = 12});
  expect_pendulum(moved, times, 2 * thread / payload);
  EXPECT_LT(moved.energy_error, 1e-5);
  EXPECT_LT(moved.steps, 100);
}

}  // namespace
}  // namespace dlo::energy_model
