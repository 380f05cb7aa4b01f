#include "motion/scene_modes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "../../says.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/force_model/simulation.hpp"
#include "polygon/point_layout.hpp"
#include "scenes.hpp"

namespace dlo::compare {
namespace {

Scene rod_with_lateral_load() {
  Scene scene = test::heavy_scene(6, 20);
  scene.loads.push_back({.at = 0.7, .force = {0, 0, 0.3 * scene.bending_stiffness()}});
  return scene;
}

// The polygon's points have half of the masses of their segments, and its joints the stiffness EI /
// h. Its frequencies converge at second order to those of the continuous rod, which are computed
// independently.
TEST(SceneModes, OfThePolygonConvergeToThoseOfTheRod) {
  Scene scene = rod_with_lateral_load();
  std::array<double, 3> before{};
  for (const int points : {24, 48, 96}) {
    scene.force_model.points = points;
    const SceneModes found = scene_modes(scene, {.count = 3});
    ASSERT_EQ(found.missing_polygon_reason, "");
    for (std::size_t k = 0; k < 3; ++k) {
      const SceneMode& mode = found.modes[k];
      ASSERT_TRUE(mode.polygon_omega);
      EXPECT_GT(mode.polygon_kinetic_share, 0.99);
      const double off = *mode.polygon_omega / mode.rod.omega() - 1;
      EXPECT_LT(std::abs(off), 6.0 * static_cast<double>(k + 1) / (points * points)) << points;
      // The error is proportional to 1 / (N - 1.5)^2, not to 1 / N^2, so that the ratio is above 4.
      if (points > 24 && k == 2) {
        EXPECT_NEAR(before[k] / off, 4.2, 0.25) << points;
      }
      before[k] = off;
    }
  }
}

// A mass that hangs at the tip moves with it: of a weightless beam omega^2 = 3 EI / (m l^3).
TEST(SceneModes, WhatHangsOnTheRodMovesWithIt) {
  Scene scene = test::heavy_scene(1e-6, 0);
  const double mass = 1e3 * scene.mass();
  scene.gravity.setZero();
  scene.loads.push_back({.at = 1, .force = Eigen::Vector3d::Zero(), .mass = mass});
  scene.force_model.points = 40;
  const SceneModes found = scene_modes(scene, {.count = 1});
  const double omega = std::sqrt(3 * scene.bending_stiffness() / mass);
  // The rod's own mass counts by 33/140.
  EXPECT_NEAR(found.modes[0].rod.omega() / omega, 1 - 33.0 / 280 / 1e3, 1e-5);
  EXPECT_NEAR(*found.modes[0].polygon_omega / omega, 1, 3e-3);
}

/// A polygon that oscillates in its slowest mode. Its segments are so soft that few steps suffice.
struct Swing {
  MovingPolygon polygon;
  double stiffness = 0;
  Eigen::VectorXd movement;

  explicit Swing(const Scene& scene) : polygon(polygon_at_rest(scene, {})) {
    const PolygonModes modes =
        polygon_modes(polygon.stiffness, Eigen::VectorXd::Ones(polygon.masses.size()));
    stiffness = modes.squared_frequencies[0];
    movement = modes.shapes.col(0);
  }
  [[nodiscard]] force_model::Simulation simulation(const Scene& scene, double amplitude) const {
    Eigen::Matrix3Xd points = polygon.points;
    for (std::size_t i = 0; i < polygon.free.size(); ++i) {
      points.col(polygon.free[i]) +=
          amplitude * movement.segment<3>(3 * static_cast<Eigen::Index>(i));
    }
    // Formula 19 alone, without the damping of points that oscillate from step to step.
    force_model::StepOptions options = step_options(scene.force_model, polygon.discretisation);
    options.policy.damping = false;
    return {polygon.discretisation.rod, points, options};
  }
  /// Returns the coordinate of the mode.
  [[nodiscard]] double along(const force_model::Simulation& simulation) const {
    const Eigen::Matrix3Xd points = simulation.points();
    double sum = 0;
    for (std::size_t i = 0; i < polygon.free.size(); ++i) {
      sum += movement.segment<3>(3 * static_cast<Eigen::Index>(i))
                 .dot(points.col(polygon.free[i]) - polygon.points.col(polygon.free[i]));
    }
    return sum;
  }
};

Scene stepped_scene(double c_F, double c_h) {
  Scene scene = rod_with_lateral_load();
  scene.force_model.points = 12;
  scene.force_model.c_c = 2e-5 * scene.axial_stiffness();
  if (c_F > 0) {
    scene.force_model.stepper = Stepper::dynamic;
    scene.force_model.c_F = c_F;
    scene.force_model.c_h = c_h;
  }
  return scene;
}

// The simulation itself, in one mode of small amplitude, against the closed form.
TEST(SteppedMode, IsWhatTheSimulationDoes) {
  const double rate = 2 * scene_modes(stepped_scene(0, 0), {.count = 1}).physical->least_rate;
  const PhysicalSteps physical =
      *scene_modes(stepped_scene(0, 0), {.count = 1, .rate = rate, .damping = 0.05}).physical;
  const Scene scene = stepped_scene(physical.c_F, physical.c_h);
  const Swing swing(scene);
  const SteppedMode mode = stepped_mode(swing.stiffness, physical.c_F, physical.c_h, rate);
  EXPECT_TRUE(mode.is_stable);
  force_model::Simulation simulation = swing.simulation(scene, 1e-5);
  // Times at which the mode's coordinate passes zero, interpolated between steps, and the speeds
  // there.
  std::vector<double> times;
  std::vector<double> speeds;
  double before = swing.along(simulation);
  for (int step = 1; times.size() < 7 && step < 200000; ++step) {
    ASSERT_EQ(simulation.step().status, force_model::StepStatus::good);
    const double now = swing.along(simulation);
    if (std::signbit(now) != std::signbit(before)) {
      times.push_back((step - now / (now - before)) / rate);
      speeds.push_back(std::abs(now - before));
    }
    before = now;
  }
  ASSERT_EQ(times.size(), 7U);
  const double duration = times[6] - times[0];
  EXPECT_NEAR(mode.omega * duration / (6 * std::numbers::pi), 1, 1e-3);
  const double decay = -std::log(speeds[6] / speeds[0]) / duration;
  EXPECT_NEAR(decay / (mode.omega * mode.damping / std::sqrt(1 - mode.damping * mode.damping)), 1,
              0.01);
}

// Steps at a rate 3 % above the reported least rate are stable. At a rate 3 % below it, with longer
// steps, they are not.
TEST(SceneModes, PhysicalStepsAreStableFromTheirLeastRateOn) {
  const double least = scene_modes(stepped_scene(0, 0), {.count = 1}).physical->least_rate;
  for (const double share : {0.97, 1.03}) {
    const PhysicalSteps physical =
        *scene_modes(stepped_scene(0, 0), {.count = 1, .rate = share * least}).physical;
    EXPECT_NEAR(physical.least_rate, least, 1e-9 * least);
    const Scene scene = stepped_scene(physical.c_F, physical.c_h);
    const Swing swing(scene);
    force_model::Simulation simulation = swing.simulation(scene, 1e-6);
    double farthest = 0;
    for (int step = 0; step < 4000; ++step) {
      if (simulation.step().status != force_model::StepStatus::good) farthest = INFINITY;
      farthest = std::max(farthest, (simulation.points() - swing.polygon.points).norm());
    }
    EXPECT_EQ(farthest > 1e-3, share < 1) << share << ": " << farthest;
  }
}

// An oscillation exp(-zeta omega_0 t) cos(omega t), omega = omega_0 (1 - zeta^2)^(1/2), sampled
// once per step: the sum and the product of its two multipliers give c_F and c_h of Formula 19.
TEST(SteppedMode, HasTheDampingOfTheSwingThatItStepsThrough) {
  constexpr double rate = 200;
  for (const double omega_0 : {1.0, 30.0, 300.0}) {
    for (const double zeta : {0.01, 0.3, 0.8}) {
      const double omega = omega_0 * std::sqrt(1 - zeta * zeta);
      const double kept = std::exp(-zeta * omega_0 / rate);
      const double c_F = 1 + kept * kept - 2 * kept * std::cos(omega / rate);
      const SteppedMode mode = stepped_mode(1, c_F, kept * kept, rate);
      EXPECT_NEAR(mode.damping, zeta, 1e-9) << omega_0;
      EXPECT_NEAR(mode.omega, omega, 1e-7 * omega) << zeta;
      EXPECT_TRUE(mode.is_stable);
    }
  }
}

TEST(SteppedMode, IsVerletWithoutDampingAndUnstableBeyondFour) {
  const SteppedMode slow = stepped_mode(1, 1e-6, 1, 1000);
  EXPECT_NEAR(slow.omega, 1, 1e-6);
  EXPECT_NEAR(slow.damping, 0, 1e-9);
  EXPECT_TRUE(stepped_mode(3.99, 1, 1, 1).is_stable);
  EXPECT_FALSE(stepped_mode(4.01, 1, 1, 1).is_stable);
  EXPECT_EQ(stepped_mode(0.01, 1, 0.1, 1).omega, 0);
}

// With the rod's masses, Formula 19 has the rod's frequencies and the requested damping.
TEST(SceneModes, PhysicalStepsSwingAsTheRodDoes) {
  Scene scene = rod_with_lateral_load();
  scene.force_model.points = 48;
  const double rate = 1.01 * scene_modes(scene, {.count = 1}).physical->least_rate;
  const PhysicalSteps physical =
      *scene_modes(scene, {.count = 1, .rate = rate, .damping = 0.03}).physical;
  scene.force_model.stepper = Stepper::dynamic;
  scene.force_model.c_F = physical.c_F;
  scene.force_model.c_h = physical.c_h;
  const SceneModes found = scene_modes(scene, {.count = 2, .rate = rate});
  EXPECT_NEAR(*found.effective_point_mass, physical.point_mass, 1e-9 * physical.point_mass);
  for (const SceneMode& mode : found.modes) {
    // All points have the mean mass. It is a little less than that of inner points, because the
    // point at the tip has half of their mass.
    EXPECT_NEAR(mode.stepped->omega / mode.rod.omega(), 1, 0.03);
    EXPECT_TRUE(mode.stepped->is_stable);
  }
  EXPECT_NEAR(found.modes[0].stepped->damping, 0.03, 0.03 * 0.03);
}

TEST(SceneModes, OfARodHeldStraightAreThoseOfAClampedBeam) {
  Scene held = test::heavy_scene(0, 0);
  held.gravity.setZero();
  held.grippers.push_back({.at = 1, .position = {1, 0, 0}, .direction = Eigen::Vector3d::UnitX()});
  const double unit = std::sqrt(held.bending_stiffness() / held.mass_per_length());
  const SceneModes found = scene_modes(held, {.count = 1});
  EXPECT_EQ(found.tension, 0);
  EXPECT_NEAR(found.modes[0].rod.omega() / (22.373285448061 * unit), 1, 1e-9);
  EXPECT_NEAR(*found.modes[0].polygon_omega / found.modes[0].rod.omega(), 1, 5e-3);
  EXPECT_GT(scene_modes(held, {.count = 1, .tension = 10}).modes[0].rod.omega(), 22.4 * unit);
  Scene heavy = held;
  heavy.gravity = {0, -9.81, 0};
  EXPECT_THROW((void)scene_modes(heavy), InputError);
  held.grippers[1].position.x() = 0.99;
  EXPECT_FALSE(scene_modes(held, {.count = 1}).tension);
  EXPECT_THROW((void)scene_modes(held, {.count = 1, .tension = 10}), InputError);
}

TEST(SceneModes, SayWhyThereAreNone) {
  Scene twisted = test::two_clamps(5, {0.8, 0, 0});
  for (Gripper& gripper : twisted.grippers) gripper.frame.emplace();
  twisted.grippers[1].frame->roll = 1;
  twisted.torsional_stiffness = twisted.bending_stiffness();
  const SceneModes found = scene_modes(twisted, {.count = 2});
  EXPECT_EQ(found.modes.size(), 2U);
  EXPECT_TRUE(has_all(found.missing_polygon_reason, {"twist"}));
  Scene lying = test::heavy_scene(50, 0);
  lying.obstacles.push_back({obstacle::Body::half_space({0, -0.1, 0}, {0, 1, 0})});
  EXPECT_THROW((void)scene_modes(lying), ConvergenceError);
}

}  // namespace
}  // namespace dlo::compare
