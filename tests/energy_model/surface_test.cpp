// Tests of the reactions that keep a rod on a surface, against a closed form, the equations
// themselves and their differences.

#include "kirchhoff/surface.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <random>
#include <vector>

#include "base/spin.hpp"
#include "shooting/rod_flow.hpp"

namespace dlo::energy_model {
namespace {

std::vector<Surface> surfaces() {
  const Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  return {surface_of(obstacle::Body::half_space({0, 0.1, 0}, {0.1, 1, 0.2}), {0, 1, 0}),
          surface_of(obstacle::Body::cylinder({0, 0, 0}, {0.2, 0.1, 1}, 0.4), {0.5, 0.2, 0}),
          surface_of(obstacle::Body::sphere({0.1, 0, 0}, 0.3), {0.2, 0.5, 0.1}),
          surface_of(obstacle::Body::box({0, 0, 0}, axes, {1, 0.2, 1}, 0.05), {0.55, 0.2, 0})};
}

std::vector<RodSection> sections() {
  return {{1.3, 0, {0.2, -3, 0.1}}, {0.8, 0.6, {0, -2, 0}}, {1, 0.5, {0, -2, 1}, 2.5}};
}

/// Returns a random cross-section near a point.
RodState random_state(std::mt19937& random) {
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto vector = [&] { return Eigen::Vector3d(unit(random), unit(random), unit(random)); };
  RodState state;
  state.r = Eigen::Vector3d(0.4, 0.4, 0) + 0.1 * vector();
  state.R = from_rotation_vector(2 * vector());
  state.m = vector();
  state.n = 3 * vector();
  return state;
}

RodState moved(RodState state, const Eigen::Matrix<double, 12, 1>& by) {
  state.r += by.segment<3>(0);
  state.R = from_rotation_vector(by.segment<3>(3)) * state.R;
  state.m += by.segment<3>(6);
  state.n += by.segment<3>(9);
  return state;
}

/// Returns a cross-section at which contact begins, by changing r, R, m and n until
/// lying_conditions() are zero.
RodState lying(const Surface& surface, const RodSection& section, RodState state) {
  for (int step = 0; step < 30; ++step) {
    const LyingConditions now = lying_conditions(surface, section, state);
    const Eigen::Matrix<double, 4, 12> by = now.by_state;
    state = moved(state, -by.transpose() * (by * by.transpose()).inverse() * now.values);
  }
  return state;
}

// If the four conditions hold at the begin, the reaction pressure keeps gap and slope zero along
// the surface, for any section and twist.
TEST(Surface, ARodThatBeginsToLieStaysThere) {
  std::mt19937 random(11);
  for (const Surface& surface : surfaces()) {
    for (const RodSection& section : sections()) {
      RodState state = lying(surface, section, random_state(random));
      const RodElement element{section, {}, 0, 0.5, &surface};
      ASSERT_TRUE(integrate_rod(element, 1e-13, state));
      EXPECT_LT(lying_conditions(surface, section, state).values.norm(), 1e-9);
      EXPECT_NEAR(surface.gap(state.r).value, 0, 1e-10);
    }
  }
}

// Differences of the end states agree with the linearised equations.
TEST(Surface, LinearisedEquationsAreThoseOfTheRod) {
  std::mt19937 random(5);
  constexpr double h = 1e-6;
  for (const Surface& surface : surfaces()) {
    for (const RodSection& section : sections()) {
      const RodState begin = lying(surface, section, random_state(random));
      const RodElement element{section, {}, 0, 0.3, &surface};
      RodVariation change(12);
      change.r.leftCols<3>().setIdentity();
      change.spin.middleCols<3>(3).setIdentity();
      change.m.middleCols<3>(6).setIdentity();
      change.n.rightCols<3>().setIdentity();
      RodState end = begin;
      ASSERT_TRUE(integrate_rod(element, 1e-12, end, change));
      for (Eigen::Index k = 0; k < 12; ++k) {
        const Eigen::Matrix<double, 12, 1> step = h * Eigen::Matrix<double, 12, 1>::Unit(k);
        RodState ahead = moved(begin, step);
        RodState behind = moved(begin, -step);
        ASSERT_TRUE(integrate_rod(element, 1e-13, ahead));
        ASSERT_TRUE(integrate_rod(element, 1e-13, behind));
        const Eigen::Vector3d r = (ahead.r - behind.r) / (2 * h);
        const Eigen::Vector3d m = (ahead.m - behind.m) / (2 * h);
        const Eigen::Vector3d n = (ahead.n - behind.n) / (2 * h);
        const Eigen::Matrix3d turned = (ahead.R - behind.R) * end.R.transpose() / (2 * h);
        const Eigen::Vector3d spin(turned(2, 1), turned(0, 2), turned(1, 0));
        const double scale = 1 + n.norm() + m.norm();
        EXPECT_LT((r - change.r.col(k)).norm(), 1e-6 * scale);
        EXPECT_LT((spin - change.spin.col(k)).norm(), 1e-6 * scale);
        EXPECT_LT((m - change.m.col(k)).norm(), 1e-6 * scale);
        EXPECT_LT((n - change.n.col(k)).norm(), 1e-6 * scale);
      }
    }
  }
}

// A rope around a peg: p = T / R, whatever it is stiff against.
TEST(Surface, ARodAroundAPegIsPressedByItsTension) {
  constexpr double radius = 0.2;
  const Surface peg = surface_of(obstacle::Body::cylinder({0, 0, 0}, {0, 0, 1}, radius), {1, 0, 0});
  RodState state;
  state.r = {radius, 0, 0};
  state.R = frame_along({0, 1, 0}, {1, 0, 0});
  state.m = {0, 0, 1.7 / radius};
  state.n = {0, 12, 0};
  const RodSection section{1.7, 0, Eigen::Vector3d::Zero()};
  EXPECT_LT(lying_conditions(peg, section, state).values.norm(), 1e-12);
  EXPECT_NEAR(pressure(peg, section, state), 12 / radius, 1e-10);
}

}  // namespace
}  // namespace dlo::energy_model
