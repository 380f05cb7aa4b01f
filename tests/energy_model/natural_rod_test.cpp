// Tests of rods of sections and of rods that are not intrinsically straight: against closed forms,
// references and Kirchhoff's equations, integrated from a solution's own reactions.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <random>
#include <stdexcept>

#include "dlo/energy_model/energy.hpp"
#include "dlo/energy_model/exact.hpp"
#include "dlo/energy_model/natural_frame.hpp"
#include "kirchhoff_rod.hpp"
#include "solved.hpp"

namespace dlo::energy_model {
namespace {

using Eigen::Matrix3d;

Problem clamped_rod() {
  Problem problem;
  problem.length = 1;
  problem.bending_stiffness = 1;
  problem.torsional_stiffness = 2.0 / 3;
  problem.grips = {{0, {0, 0, 0}, Vector3d::UnitX(), std::nullopt}};
  return problem;
}

Equilibrium solved_rod(const Problem& problem) { return test::converged(solve_energy(problem)); }

/// Directors of a clamp along x whose d1 is y.
Matrix3d along_x() {
  Matrix3d frame;
  frame << Vector3d::UnitY(), Vector3d::UnitZ(), Vector3d::UnitX();
  return frame;
}

/// Compares a solution with Kirchhoff's equations, integrated from its own reactions.
/// @param tolerance  of the end point [l]; a hundred times this is allowed for the remaining force
/// and moment at the end [EI/l^2, EI/l]
void expect_kirchhoff(const Problem& problem, const Equilibrium& solution, const Matrix3d& frame,
                      double tolerance) {
  const test::RodEnd end = test::integrate_kirchhoff(problem, solution, frame);
  EXPECT_LT((end.point - point_at(solution, problem.length)).norm(), tolerance);
  EXPECT_LT(end.force.norm(), 100 * tolerance);
  EXPECT_LT(end.moment.norm(), 100 * tolerance);
}

TEST(NaturalRod, IsItsOwnShapeWithoutForces) {
  Problem problem = clamped_rod();
  problem.natural_strains = {{0, 3, 0}};
  Equilibrium circle = solved_rod(problem);
  // A curvature about d2 bends the rod to the left of x, seen from +z.
  EXPECT_LT((point_at(circle, 1) - Vector3d(std::sin(3) / 3, (1 - std::cos(3)) / 3, 0)).norm(),
            1e-12);
  EXPECT_LT(circle.energy.total(), 1e-20);
  // A curvature about d1 bends the rod towards -d2.
  problem.natural_strains = {{3, 0, 0}};
  circle = solved_rod(problem);
  EXPECT_LT((point_at(circle, 1) - Vector3d(std::sin(3) / 3, 0, -(1 - std::cos(3)) / 3)).norm(),
            1e-12);
  // A curvature of 1 + 4 (2 s - 1) turns the tangent by s + 4 (s^2 - s).
  problem.natural_strains = {{0, 1, 0}, {0, 4, 0}};
  const Equilibrium clothoid = solved_rod(problem);
  Vector3d tip = Vector3d::Zero();
  constexpr int intervals = 2000;
  for (int i = 0; i < intervals; ++i) {
    for (const double gauss : {-1 / std::sqrt(3.0), 1 / std::sqrt(3.0)}) {
      const double s = (i + (1 + gauss) / 2) / intervals;
      const double angle = s + 4 * (s * s - s);
      tip += Vector3d(std::cos(angle), std::sin(angle), 0) / (2.0 * intervals);
    }
  }
  EXPECT_LT((point_at(clothoid, 1) - tip).norm(), 1e-12);
}

// The clamps at 0.6 and 1 are at the stress-free shape, so no force acts, however many turns that
// shape has.
TEST(NaturalRod, IsFreeBetweenClampsWhereTheStressFreeShapeEnds) {
  for (const double k : {2.0, 6.0, -9.0, 14.0}) {
    SCOPED_TRACE(k);
    Problem problem = clamped_rod();
    problem.natural_strains = {{0, k, 0}};
    const Samples free = solved_rod(problem).sample(std::vector<double>{0.6, 1.0});
    problem.grips.push_back({0.6, free.points.col(0), free.tangents.col(0)});
    problem.grips.push_back({1, free.points.col(1), free.tangents.col(1)});
    const Equilibrium held = solved_rod(problem);
    EXPECT_LT(held.energy.bending, 1e-16);
    EXPECT_LT((point_at(held, 1) - free.points.col(1)).norm(), 1e-12);
  }
}

/// Returns the smallest eigenvalue of the planar shape of an intrinsically curved rod that hangs
/// from a clamp.
double hanging_smallest_eigenvalue(double natural, double gamma) {
  Problem problem = clamped_rod();
  problem.grips[0].direction = -Vector3d::UnitY();
  problem.weight_per_length = {0, -gamma, 0};
  problem.natural_strains = {{0, natural, 0}};
  const Equilibrium result = solved_rod(problem);
  EXPECT_LT(std::abs(point_at(result, 1).z()), 1e-9) << natural << " " << gamma;
  return result.smallest_eigenvalue;
}

/// Returns the weight at which a parabola through the eigenvalue at three weights on the stable
/// side of `gamma` is zero.
double extrapolated_loss(double natural, double gamma, double side) {
  const double h = side * 2e-3 * gamma;
  const double a = hanging_smallest_eigenvalue(natural, gamma + h);
  const double b = hanging_smallest_eigenvalue(natural, gamma + 2 * h);
  const double c = hanging_smallest_eigenvalue(natural, gamma + 3 * h);
  // In x = (weight - gamma) / h: Newton's form at 1, 2, 3.
  const double second = (c - 2 * b + a) / 2;
  double x = 0;
  for (int i = 0; i < 20; ++i) {
    const double value = a + (b - a) * (x - 1) + second * (x - 1) * (x - 2);
    x -= value / ((b - a) + second * (2 * x - 3));
  }
  return gamma + x * h;
}

TEST(NaturalRod, HangingLeavesItsPlaneWhereItShould) {
  // C/B = 2/3; the references are known to these digits.
  EXPECT_NEAR(extrapolated_loss(10, 28.769705, -1), 28.769705, 1e-5);
  EXPECT_NEAR(extrapolated_loss(10, 238.935595, 1), 238.935595, 1e-4);
  EXPECT_NEAR(extrapolated_loss(8, 19.248423, -1), 19.248423, 1e-5);
  EXPECT_NEAR(extrapolated_loss(8, 119.902772, 1), 119.902772, 1e-4);
  EXPECT_NEAR(extrapolated_loss(6, 11.868751, -1), 11.868751, 1e-5);
  EXPECT_NEAR(extrapolated_loss(6, 37.763909, 1), 37.763909, 1e-4);
  for (const double gamma : {2.0, 8.0, 12.0, 20.0, 40.0, 100.0}) {
    EXPECT_GT(hanging_smallest_eigenvalue(5, gamma), 0) << gamma;
  }
}

/// Expects that random rods obey Kirchhoff's equations: with one and two clamps, with sections and
/// without, with natural strains (strips also without).
void expect_kirchhoff_of_random_rods(std::uint64_t seed, bool strip) {
  std::mt19937_64 random(seed);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  const auto vector = [&](double size) {
    return Vector3d(uniform(-size, size), uniform(-size, size), uniform(-size, size));
  };
  for (int i = 0; i < 12; ++i) {
    Problem problem = clamped_rod();
    if (strip) problem.bending_stiffness_2 = uniform(0.2, 6);
    problem.weight_per_length = vector(6);
    if (!strip || i % 4 > 0) problem.natural_strains = {vector(4), vector(2)};
    if (!strip) problem.natural_strains.push_back(vector(1));
    problem.grips[0].frame = FrameHold{Vector3d::UnitY(), 0};
    if (i % 2 == 1) {
      problem.sections = {{0.2, 0.45, uniform(0.3, 4), uniform(0.2, 3), vector(9)},
                          {0.45, 0.7, uniform(0.3, 4), uniform(0.2, 3), vector(9)}};
      if (strip) problem.sections[0].bending_stiffness_2 = uniform(0.3, 4);
    }
    if (i % 3 > 0) {
      problem.grips.push_back(
          {1, {uniform(0.3, 0.8), uniform(-0.3, 0.3), uniform(-0.3, 0.3)}, vector(1), {}});
      if (i % 3 == 2) problem.grips.back().frame = FrameHold{std::nullopt, uniform(-3, 3)};
    }
    SCOPED_TRACE(i);
    expect_kirchhoff(problem, solved_rod(problem), along_x(), 1e-8);
  }
}

TEST(NaturalRod, OfAllKindsObeysKirchhoffsEquations) {
  expect_kirchhoff_of_random_rods(20261122, false);
}

TEST(Strip, OfAllKindsObeysKirchhoffsEquations) { expect_kirchhoff_of_random_rods(20261123, true); }

TEST(Sections, ObeyKirchhoffsEquationsInThePlaneAndInSpace) {
  for (const double aside : {0.0, 2.0}) {
    Problem problem = clamped_rod();
    problem.weight_per_length = {0, -5, aside};
    problem.sections = {{0.2, 0.5, 4, 2, {0, -20, 0}}, {0.7, 0.8, 0.2, 0.1, {0, -1, aside}}};
    expect_kirchhoff(problem, solved_rod(problem), along_x(), 1e-8);
    problem.grips.push_back({1, {0.7, 0, 0}, Vector3d::UnitX(), {}});
    expect_kirchhoff(problem, solved_rod(problem), along_x(), 1e-8);
  }
}

TEST(Clamp, ThatLetsTheRodRotatePassesItsTorqueOn) {
  Problem problem = clamped_rod();
  problem.weight_per_length = {0, -4, 1};
  problem.grips[0].frame = FrameHold{Vector3d::UnitY(), 0};
  problem.grips.push_back(
      {1, {0.8, 0.1, 0}, Vector3d(1, 0.3, 0.1), FrameHold{Vector3d(0.3, -0.4, 0.9), 0}});
  const Equilibrium whole = solved_rod(problem);
  // A clamp at the position and direction that the rod has anyway exerts no load if it does not
  // hold the twist.
  const Samples there = test::sample_at(whole, 0.4);
  Problem passed = problem;
  passed.grips.insert(passed.grips.begin() + 1,
                      {0.4, there.points.col(0), there.tangents.col(0), std::nullopt});
  const Equilibrium same = solved_rod(passed);
  EXPECT_LT(same.grips[1].force.norm(), 1e-6);
  EXPECT_LT(same.grips[1].torque.norm(), 1e-6);
  EXPECT_NEAR(same.energy.total(), whole.energy.total(), 1e-9);
  EXPECT_NEAR(same.twists.at(0).torque, whole.twists.at(0).torque, 1e-7);
  for (const double s : {0.2, 0.7}) {
    EXPECT_LT((point_at(same, s) - point_at(whole, s)).norm(), 1e-8);
  }
  // A clamp at another position exerts a force, and Kirchhoff's equations still hold.
  passed.grips[1].position += Vector3d(0, 0.02, 0.01);
  const Equilibrium pushed = solved_rod(passed);
  EXPECT_GT(pushed.grips[1].force.norm(), 1);
  EXPECT_NEAR(pushed.grips[1].torque.dot(there.tangents.col(0)), 0, 1e-9);
  expect_kirchhoff(passed, pushed, along_x(), 1e-8);
}

TEST(NaturalRod, HasTheSameDirectorsInBothModels) {
  // A rolled clamp inside the rod: both models have the same d1 on both sides of it.
  Problem problem = clamped_rod();
  problem.weight_per_length = {0, -5, 2};
  problem.natural_strains = {{1, 2, 0.5}};
  problem.grips[0].at = 0.4;
  problem.grips[0].frame = FrameHold{Vector3d::UnitY(), 0.7};
  const std::vector<double> s = {0, 0.2, 0.4, 0.7, 1};
  const Samples energy = solved_rod(problem).sample(s);
  const Equilibrium shot = test::converged(solve_exact(problem));
  const Samples exact = shot.sample(s);
  ASSERT_EQ(energy.d1.cols(), 5);
  ASSERT_EQ(exact.d1.cols(), 5);
  EXPECT_LT((energy.points - exact.points).norm(), 1e-9);
  EXPECT_LT((energy.d1 - exact.d1).norm(), 1e-8);
  EXPECT_LT((exact.d1.col(2) - Vector3d(0, std::cos(0.7), std::sin(0.7))).norm(), 1e-12);
}

TEST(NaturalRod, BehindItsFirstClampIsTheSameRod) {
  // A rod that is clamped in its middle is compared with a separate rod that equals its first half.
  Problem whole = clamped_rod();
  whole.weight_per_length = {0, -5, 2};
  whole.natural_strains = {{1, 2, 0.5}, {0.5, -1, 1}};
  whole.grips[0].at = 0.5;
  whole.grips[0].frame = FrameHold{Vector3d::UnitY(), 0.3};
  const Equilibrium both = solved_rod(whole);
  // The half before the clamp is counted from the clamp, so s is reversed. t and d2 change sign,
  // and so do the strains about d1.
  Problem half = whole;
  half.length = 0.5;
  half.grips[0] = {0, Vector3d::Zero(), -Vector3d::UnitX(), FrameHold{Vector3d::UnitY(), -0.3}};
  // With x counted from the clamp, P_1 of the whole rod is -x/2 - 1/2 on this half.
  const Vector3d back(-1, 1, 1);
  const std::vector<Vector3d>& u = whole.natural_strains;
  half.natural_strains = {back.cwiseProduct(u[0] - u[1] / 2), back.cwiseProduct(-u[1] / 2)};
  const Equilibrium one = solved_rod(half);
  EXPECT_LT((point_at(one, 0.5) - point_at(both, 0)).norm(), 1e-9);
}

/// Returns a rod whose stress-free shape is a straight shaft and two arcs; the second arc ends at
/// 0.4 rad from the direction of the shaft.
Problem guide_wire() {
  Problem problem = clamped_rod();
  problem.natural_strains = {Vector3d::Zero()};
  for (const auto& [begin, end, curvature] :
       {std::array{0.5, 0.7, 8.0}, std::array{0.7, 1.0, -4.0}}) {
    Section section{begin, end, 1, 2.0 / 3, {0, 0, 0}};
    section.natural_curvature = Eigen::Vector2d(0, curvature);
    problem.sections.push_back(section);
  }
  return problem;
}

TEST(SectionsOfTheirOwnShape, AreArcsWithoutForces) {
  const Vector3d first(0.5 + std::sin(1.6) / 8, (1 - std::cos(1.6)) / 8, 0);
  const Vector3d second((std::sin(1.6) - std::sin(0.4)) / 4, (std::cos(0.4) - std::cos(1.6)) / 4,
                        0);
  for (const bool from_its_tip : {false, true}) {
    SCOPED_TRACE(from_its_tip);
    Problem problem = guide_wire();
    if (from_its_tip) problem.grips[0].at = 1;
    for (const Equilibrium& result : {solved_rod(problem), solve_exact(problem)}) {
      ASSERT_EQ(result.status, SolveStatus::converged) << result.message;
      EXPECT_NEAR(result.energy.total(), 0, 1e-18);
      const Vector3d chord = point_at(result, 1) - point_at(result, 0);
      // The tip is clamped along x, which rotates the whole shape, including the shaft, by -0.4
      // rad.
      const Vector3d expected = first + second;
      const Vector3d seen =
          from_its_tip ? Vector3d(Eigen::AngleAxisd(0.4, Vector3d::UnitZ()) * chord) : chord;
      EXPECT_LT((seen - expected).norm(), 1e-12);
      const Samples samples = result.sample(std::vector<double>{0.3, 0.6, 0.8});
      const Vector3d bends = samples.curvature.colwise().norm();
      EXPECT_LT((bends - Vector3d(0, 8, 4)).norm(), 1e-10);
    }
  }
}

TEST(SectionsOfTheirOwnShape, ObeyKirchhoffsEquationsInBothModels) {
  for (const bool spatial : {false, true}) {
    for (const bool closed : {false, true}) {
      SCOPED_TRACE(closed);
      Problem problem = guide_wire();
      problem.weight_per_length = {0, -6, spatial ? 3.0 : 0};
      problem.sections[0].bending_stiffness = 0.5;
      problem.sections[1].weight_per_length = {0, -2, spatial ? 1.0 : 0};
      problem.grips[0].frame = FrameHold{Vector3d::UnitY(), 0};
      if (spatial) {
        // The natural strains that a section defines replace the series in the section. For its
        // other strains the series remains.
        problem.natural_strains = {{1, -0.5, 0.4}, {0.5, 0.3, -1}};
        problem.sections[0].natural_twist = 2;
        problem.sections[1].natural_curvature.reset();
        problem.sections[1].natural_twist = -1;
      }
      if (closed) {
        problem.grips.push_back({1, {0.6, 0.1, spatial ? 0.1 : 0}, Vector3d(1, 0.2, 0), {}});
        if (spatial) problem.grips.back().frame = FrameHold{std::nullopt, 0.5};
      }
      const Equilibrium energy = solved_rod(problem);
      expect_kirchhoff(problem, energy, along_x(), 1e-8);
      const Equilibrium exact = test::converged(solve_exact(problem));
      expect_kirchhoff(problem, exact, along_x(), 1e-8);
      EXPECT_NEAR(energy.energy.total(), exact.energy.total(), 1e-8);
    }
  }
}

TEST(NaturalRod, SaysWhatItNeeds) {
  Problem problem = clamped_rod();
  problem.natural_strains = {{0, 1, 0}};
  problem.torsional_stiffness = 0;
  EXPECT_THROW((void)solve_energy(problem), std::invalid_argument);
  problem = clamped_rod();
  problem.natural_strains = {{0, 1, 0}};
  problem.weight_per_length = {0, -1, 1};
  problem.grips.push_back({1, {0.5, 0.3, 0}, Vector3d::UnitX(), {}});
  // The shape lies in no plane and no d1 is given.
  EXPECT_THROW((void)solve_energy(problem), std::invalid_argument);
  problem = clamped_rod();
  problem.sections = {{0.2, 0.6, 1, 1, {}}, {0.5, 0.8, 1, 1, {}}};
  EXPECT_THROW((void)solve_energy(problem), std::invalid_argument);
  problem = guide_wire();
  problem.natural_strains.clear();
  EXPECT_THROW((void)solve_energy(problem), std::invalid_argument);
  problem.sections = {{0.2, 0.6, 0, 1, {}}};
  EXPECT_THROW((void)solve_energy(problem), std::invalid_argument);
}

/// The plane of the natural curvature is that of the rod without loads. A load of 1e-8 out of this
/// plane does not change it; with a load of 0.1 there is none.
TEST(NaturalNormal, IsThatOfTheSceneWithoutLoads) {
  Problem problem = clamped_rod();
  problem.natural_strains = {{0, 1, 0}};
  const Vector3d free = point_at(solved_rod(problem), 1);
  problem.loads = {{.at = 1, .force = {0, 0, 1e-8}}};
  EXPECT_LT((point_at(solved_rod(problem), 1) - free).norm(), 1e-7);
  // A larger load along z moves the rod out of the plane that it has without loads.
  problem.loads[0].force.z() = 0.1;
  EXPECT_FALSE(natural_normal(problem));
  EXPECT_THROW((void)solve_energy(problem), std::invalid_argument);
  problem.loads[0].force = {0, 0.1, 0};
  EXPECT_EQ(natural_normal(problem), Vector3d::UnitZ());
  problem.grips[0].direction = Vector3d::UnitZ();
  EXPECT_FALSE(natural_normal(problem));
  problem.weight_per_length = {-1, 0, 0};
  EXPECT_FALSE(natural_normal(problem));  // the load leaves the plane x-z
  problem.loads[0].force = {0.1, 0, 0};
  EXPECT_EQ(natural_normal(problem), Vector3d::UnitY());
}

}  // namespace
}  // namespace dlo::energy_model
