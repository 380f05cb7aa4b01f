// Tests of rods that move and twist: clamps that hold frames, natural curvature, two bending
// stiffnesses.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "dlo/energy_model/dynamics.hpp"
#include "dlo/energy_model/energy.hpp"
#include "rigid_polygon.hpp"
#include "solved.hpp"

namespace dlo::energy_model {
namespace {

/// A cable of 0.8 m, EI 0.01 N m^2, 50 g/m, in SI units.
Problem cable() {
  Problem problem;
  problem.length = 0.8;
  problem.bending_stiffness = 0.01;
  problem.torsional_stiffness = 0.008;
  problem.weight_per_length = {0, 0, -0.05 * 9.81};
  return problem;
}

MovingRod moving_rod(const Problem& problem) {
  return {.problem = problem, .inertia = {.mass_per_length = 0.05}};
}

Grip clamp_with_frame(double at, const Eigen::Vector3d& position, const Eigen::Vector3d& direction,
                      const Eigen::Vector3d& d1) {
  return {.at = at, .position = position, .direction = direction, .frame = FrameHold{.d1 = d1}};
}

double farthest(const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b) {
  return (a - b).colwise().norm().maxCoeff();
}

/// Turns a clamp about its direction, and holds it.
GripMotion roll_motion(const Grip& grip, double angle, double until) {
  return moving(grip.position, {}, {}, *grip.direction, smooth_step(0, until, angle));
}

/// Compares the state of a rod, after a clamp has been rolled and drag has stopped the motion, with
/// an equilibrium.
void expect_converges_to_equilibrium(const MovingRod& rod, const Problem& rolled,
                                     const char* what) {
  const Equilibrium before = test::require_usable(solve_energy(rod.problem));
  const Dynamics moved = test::converged(simulate(rod, before.sample, std::vector<double>{2, 30}));
  EXPECT_LT(moved.energy_error, 1e-5) << what;
  const Equilibrium after = test::require_usable(solve_energy(rolled));
  const std::vector<double> s = equal_arc_lengths(rod.problem.length, 33);
  const Samples last = moved.frames.back().sample(s);
  const Samples at_rest = after.sample(s);
  EXPECT_GT(farthest(before.sample(s).points, at_rest.points), 0.02) << what;
  EXPECT_LT(farthest(last.points, at_rest.points), 2e-5 * rod.problem.length) << what;
  EXPECT_LT(farthest(last.d1, at_rest.d1), 2e-4) << what;
  const double unit = rod.problem.bending_stiffness / rod.problem.length;
  EXPECT_NEAR(moved.frames.back().energy.twisting, after.energy.twisting, 1e-4 * unit) << what;
  EXPECT_NEAR(moved.frames.back().energy.bending, after.energy.bending, 1e-4 * unit) << what;
  for (std::size_t i = 0; i < rod.problem.grips.size(); ++i) {
    EXPECT_LT((moved.frames.back().grips[i].torque - after.grips[i].torque).norm(), 2e-4 * unit)
        << what << ", grip " << i;
  }
}

TEST(TwistMotion, ARolledClampLeavesTheEquilibriumThatItHolds) {
  Problem problem = cable();
  problem.grips = {
      clamp_with_frame(0, {0, 0, 0}, Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY()),
      clamp_with_frame(0.8, {0.6, 0.1, 0}, Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY())};
  // A part that yields more to twist than it does to bending.
  problem.sections = {{.begin = 0.3,
                       .end = 0.5,
                       .bending_stiffness = 0.02,
                       .torsional_stiffness = 0.003,
                       .weight_per_length = problem.weight_per_length}};
  MovingRod rod = moving_rod(problem);
  rod.inertia.of_sections = {rod.inertia.mass_per_length};
  rod.air_drag = 0.5;
  rod.breaks = {0, 1};
  rod.motions = {nullptr, roll_motion(problem.grips[1], 2.8, 1)};
  problem.grips[1].frame->roll = 2.8;
  expect_converges_to_equilibrium(rod, problem, "round");
}

TEST(TwistMotion, AWristTurnsACurvedWire) {
  for (const bool flat : {false, true}) {
    Problem problem = cable();
    problem.natural_strains = {{1, 2, 0.5}, {0.4, 0, 0}};
    if (flat) problem.bending_stiffness_2 = 0.02;
    problem.grips = {
        clamp_with_frame(0, {0, 0, 0}, Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY())};
    MovingRod rod = moving_rod(problem);
    rod.air_drag = 0.5;
    rod.breaks = {0, 1};
    rod.motions = {roll_motion(problem.grips[0], 1.2, 1)};
    problem.grips[0].frame->roll = 1.2;
    expect_converges_to_equilibrium(rod, problem, flat ? "flat" : "round");
  }
}

/// A wire with EI = l = rho A = 1 and a curvature of 2, straight when it is let go, in an oblique
/// plane.
MovingRod straightened_wire() {
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()));
  Problem problem;
  problem.length = 1;
  problem.bending_stiffness = 1;
  problem.torsional_stiffness = 0.75;
  problem.natural_strains = {{2, 0, 0}};
  problem.grips = {clamp_with_frame(0, {0, 0, 0}, turn * Eigen::Vector3d::UnitX(),
                                    turn * Eigen::Vector3d::UnitZ())};
  MovingRod rod = moving_rod(problem);
  rod.inertia.mass_per_length = 1;
  rod.material_damping = 0.002;
  return rod;
}

TEST(TwistMotion, AStraightenedWireCurlsAsAPolygon) {
  const std::vector<double> times = {0.05, 0.1, 0.15, 0.25, 0.4};
  const MovingRod rod = straightened_wire();
  const Eigen::Vector3d along = *rod.problem.grips[0].direction;
  const Eigen::Vector3d across = rod.problem.grips[0].frame->d1->cross(along);
  const Eigen::Matrix2Xd expected = test::limit_of_tips(
      12, 0, {.material_damping = rod.material_damping, .natural_curvature = 2}, times);
  for (const bool spatial : {false, true}) {
    const Dynamics moved =
        test::converged(simulate(rod, straight_rod(along), times, {.spatial = spatial}));
    EXPECT_LT(moved.energy_error, 1e-6);
    for (std::size_t k = 0; k < times.size(); ++k) {
      const Eigen::Vector3d tip = test::point_at(moved.frames[k], 1);
      const Eigen::Vector2d seen(tip.dot(along), tip.dot(across));
      EXPECT_LT((seen - expected.col(static_cast<Eigen::Index>(k))).norm(), 1e-3)
          << spatial << ", " << times[k];
      EXPECT_NEAR(tip.dot(*rod.problem.grips[0].frame->d1), 0, 1e-9);
      EXPECT_LT(moved.frames[k].energy.twisting, 1e-12);
    }
  }
}

// The torque is constant along a straight rod, because twist has no inertia.
TEST(TwistMotion, TorqueOfASlackRodIsThatOfItsTurns) {
  Problem problem = cable();
  problem.weight_per_length.setZero();
  problem.grips = {
      clamp_with_frame(0, {0, 0, 0}, Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY()),
      clamp_with_frame(0.8, {0.799, 0, 0}, Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY())};
  MovingRod rod = moving_rod(problem);
  rod.breaks = {0, 1};
  rod.motions = {nullptr, roll_motion(problem.grips[1], 1, 1)};
  const Equilibrium rest = test::require_usable(solve_energy(problem));
  const Dynamics moved =
      test::converged(simulate(rod, rest.sample, std::vector<double>{0.25, 0.5, 1}));
  for (const MovingFrame& frame : moved.frames) {
    const Samples ends = frame.sample(std::vector<double>{0, 0.8});
    const double turned = std::atan2(ends.d1.col(1).z(), ends.d1.col(1).y());
    EXPECT_NEAR(frame.grips[1].torque.x(), problem.torsional_stiffness * turned / 0.8,
                0.02 * std::abs(problem.torsional_stiffness * turned / 0.8));
  }
  EXPECT_NEAR(moved.frames.back().energy.work,
              moved.frames.back().energy.total() - rest.energy.total(), 1e-6);
}

}  // namespace
}  // namespace dlo::energy_model
