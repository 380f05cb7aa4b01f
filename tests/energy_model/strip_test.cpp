// Tests of strips, rods of two bending stiffnesses, against round rods, beam theory, the lateral
// buckling of a narrow cantilever, and between both models.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "../says.hpp"
#include "dlo/energy_model/energy.hpp"
#include "dlo/energy_model/exact.hpp"
#include "problems.hpp"
#include "random_problems.hpp"
#include "solved.hpp"

namespace dlo::energy_model {
namespace {

using Solver = Equilibrium (*)(const Problem&);

class BothModels : public testing::TestWithParam<std::pair<const char*, Solver>> {
 protected:
  [[nodiscard]] static Equilibrium solved(const Problem& problem) {
    return test::converged(GetParam().second(problem));
  }
};

INSTANTIATE_TEST_SUITE_P(Strip, BothModels,
                         testing::Values(std::pair("energy", test::solvers[0]),
                                         std::pair("exact", test::solvers[1])),
                         [](const auto& model) { return std::string(model.param.first); });

/// Returns a strip of unit length, clamped along x at the origin; in the x-y plane it bends about
/// d2.
Problem strip(double about_d1, double about_d2, double torsion = 0.8) {
  Problem problem;
  problem.length = 1;
  problem.bending_stiffness = about_d1;
  problem.bending_stiffness_2 = about_d2;
  problem.torsional_stiffness = torsion;
  problem.grips = {{0, {0, 0, 0}, Vector3d::UnitX(), std::nullopt}};
  return problem;
}

Problem round_rod(Problem of, double stiffness) {
  of.bending_stiffness = stiffness;
  of.bending_stiffness_2.reset();
  return of;
}

/// Returns strips of two equal stiffnesses, held in ways in which a round rod can be held too.
std::vector<Problem> held_strips() {
  std::vector<Problem> problems;
  Problem problem = strip(1, 1);
  problem.weight_per_length = {0, -6, 0};
  problems.push_back(problem);
  Problem skew = problem;
  skew.grips[0].frame = FrameHold{Vector3d(0, 0.6, 0.8), 0};
  skew.loads = {{0.7, {0.5, 1, 3}}};
  problems.push_back(skew);
  Problem pinned = skew;
  pinned.grips.push_back({1, {0.8, 0.1, -0.2}, std::nullopt, std::nullopt});
  problems.push_back(pinned);
  Problem clamped = skew;
  clamped.grips.push_back(
      {1, {0.7, 0.1, -0.2}, Vector3d(1, 0.3, 0.2), FrameHold{Vector3d(0, 1, 1), 0}});
  problems.push_back(clamped);
  problem.sections = {{0.3, 0.6, 2, 1.5, {0, -9, 0}}};
  problems.push_back(problem);
  return problems;
}

TEST_P(BothModels, EqualStiffnessesAreARoundRod) {
  const std::vector<Problem> problems = held_strips();
  for (std::size_t i = 0; i < problems.size(); ++i) {
    SCOPED_TRACE(i);
    const Problem& problem = problems[i];
    const Equilibrium two = solved(problem);
    const Equilibrium one = solved(round_rod(problem, 1));
    EXPECT_LT(test::largest_point_distance(two, one), 1e-9);
    EXPECT_NEAR(two.energy.bending, one.energy.bending, 1e-9);
    EXPECT_NEAR(two.energy.total(), one.energy.total(), 1e-9);
    for (std::size_t g = 0; g < problem.grips.size(); ++g) {
      EXPECT_LT((two.grips[g].force - one.grips[g].force).norm(), 1e-7);
      EXPECT_LT((two.grips[g].torque - one.grips[g].torque).norm(), 1e-7);
    }
  }
}

// A strip in a plane is the round rod of its stiffness about the axis across the plane, whichever
// axis this is and whichever end is clamped.
TEST_P(BothModels, InAPlaneIsTheRoundRodOfItsStiffnessThere) {
  constexpr double B1 = 2.5;
  constexpr double B2 = 0.7;
  for (const double turns : {0.0, 0.25, 0.5, -0.25}) {
    for (const double at : {0.0, 1.0}) {
      SCOPED_TRACE(std::to_string(turns) + " " + std::to_string(at));
      Problem problem = strip(B1, B2, 3);
      problem.weight_per_length = {0, -2, 0};
      problem.grips[0].at = at;
      problem.grips[0].frame = FrameHold{std::nullopt, 2 * pi * turns};
      problem.sections = {{0.2, 0.5, 4, 4, {0, -3, 0}, 1.2}};
      const bool about_d2 = std::remainder(turns, 0.5) == 0;
      Problem plain = round_rod(problem, about_d2 ? B2 : B1);
      plain.grips[0].frame.reset();
      plain.sections[0].bending_stiffness = about_d2 ? 1.2 : 4;
      plain.sections[0].bending_stiffness_2.reset();
      const Equilibrium two = solved(problem);
      EXPECT_LT(test::largest_point_distance(two, solved(plain)), 1e-9);
      const Samples samples = test::sample_at(two, at);
      const Vector3d d1 = Eigen::AngleAxisd(2 * pi * turns, Vector3d::UnitX()) * Vector3d::UnitY();
      EXPECT_LT((samples.d1.col(0) - d1).norm(), 1e-9);
    }
  }
}

// A small force F at the tip moves it by l^3/3 (F.d1 / B2 d1 + F.d2 / B1 d2).
TEST_P(BothModels, BendsObliquelyUnderAForceBetweenItsAxes) {
  constexpr double B1 = 1;
  constexpr double B2 = 5;
  constexpr double F = 1e-4;
  Problem problem = strip(B1, B2);
  problem.grips[0].frame = FrameHold{Vector3d(0, 1, 1), 0};
  problem.loads = {{1, {0, F, 0}}};
  const Vector3d d1 = Vector3d(0, 1, 1).normalized();
  const Vector3d d2 = Vector3d::UnitX().cross(d1);
  const Vector3d expected = F / 3 * (d1.y() / B2 * d1 + d2.y() / B1 * d2);
  Vector3d tip = test::point_at(solved(problem), 1);
  tip.x() = 0;  // second order
  EXPECT_LT((tip - expected).norm(), F * F);
  EXPECT_GT(std::abs(tip.z()), 0.5 * F / 3 * (1 / B1 - 1 / B2) * 0.99);
}

/// Returns the tip load at which a cantilever that is bent about its stiff axis, 1/`softness` times
/// as stiff as the weak one, can leave its plane. There the smallest eigenvalue of the second
/// variation, a parabola through three loads, is zero.
double lateral_buckling_load(const Solver& solve, double weak, double torsion, double softness,
                             double guess) {
  const auto eigenvalue = [&](double load) {
    Problem problem = strip(weak, weak / softness, torsion);
    problem.loads = {{1, {0, -load, 0}}};
    const Equilibrium result = test::converged(solve(problem));
    EXPECT_LT(std::abs(test::point_at(result, 1).z()), 1e-9);
    return result.smallest_eigenvalue;
  };
  const double h = -1e-3 * guess;
  const double first = guess - 0.01 * guess;
  const double a = eigenvalue(first);
  const double b = eigenvalue(first + h);
  const double c = eigenvalue(first + 2 * h);
  const double second = (c - 2 * b + a) / 2;
  double x = 0;
  for (int i = 0; i < 30; ++i) {
    const double value = a + (b - a) * x + second * x * (x - 1);
    x -= value / ((b - a) + second * (2 * x - 1));
  }
  return first + h * x;
}

TEST_P(BothModels, BucklesOutOfPlaneUnderPrandtlsAndMichellsLoad) {
  // P l^2 = 4.0126 (B C)^(1/2) with the weak stiffness B, for an infinite ratio of the stiffnesses.
  // The effect of a finite ratio on the load is of first order in its inverse; two ratios are used
  // to extrapolate.
  constexpr double weak = 1;
  constexpr double torsion = 0.6;
  constexpr double first_zero_of_bessel = 2.0062996717894504;  // first zero of J_(-1/4)
  const double expected = 2 * first_zero_of_bessel * std::sqrt(weak * torsion);
  const Solver& solve = GetParam().second;
  const double one = lateral_buckling_load(solve, weak, torsion, 2e-3, expected);
  const double two = lateral_buckling_load(solve, weak, torsion, 1e-3, expected);
  EXPECT_NEAR(2 * two - one, expected, 1e-4);
  EXPECT_GT(one, two);
  EXPECT_GT(two, expected);
}

TEST_P(BothModels, BeyondThatLoadLeavesItsPlane) {
  Problem problem = strip(1, 50, 0.6);
  problem.loads = {{1, {0, -3.4, 0}}};
  const Equilibrium result = solved(problem);
  EXPECT_GT(std::abs(test::point_at(result, 1).z()), 0.1);
}

TEST(Strip, ModelsAgreeInSpace) {
  int same = 0;
  for (std::uint64_t number = 1; number < 20; number += 2) {
    Problem problem = test::random_problem(number, test::RandomSpace::strip);
    problem.weight_per_length *= 0.1;
    SCOPED_TRACE(number);
    const Equilibrium one = test::converged(solve_energy(problem));
    const Equilibrium other = test::require_usable(solve_exact(problem, {.start = &one}));
    EXPECT_LT(test::largest_point_distance(one, other), 1e-8);
    EXPECT_NEAR(one.energy.total(), other.energy.total(), 1e-8);
    EXPECT_NEAR(one.energy.twisting, other.energy.twisting, 1e-8);
    ++same;
  }
  EXPECT_EQ(same, 10);
}

TEST(Strip, WithoutClampsLiesOnItsSoftSide) {
  // Between two pins the strip rolls until it bends about its softer axis, whichever of d1 and d2
  // that is.
  for (const double about_d2 : {0.5, 2.0}) {
    Problem problem = strip(1, about_d2);
    problem.grips = {{0, {0, 0, 0}, std::nullopt, std::nullopt},
                     {1, {0.9, 0, 0}, std::nullopt, std::nullopt}};
    problem.weight_per_length = {0, -3, 0};
    const Equilibrium result = test::require_usable(solve_energy(problem));
    const Equilibrium round = solve_energy(round_rod(problem, std::min(1.0, about_d2)));
    EXPECT_NEAR(result.energy.total(), round.energy.total(), 1e-9);
  }
}

std::string refused(const Problem& problem) {
  return test::error_of<std::invalid_argument>([&] { return (check(problem), 0); });
}

TEST(Strip, WantsPositiveStiffnessesAndTorsion) {
  EXPECT_EQ(refused(strip(1, 2)), "no error");
  EXPECT_NE(refused(strip(1, 0)).find("bending_stiffness_2"), std::string::npos);
  EXPECT_NE(refused(strip(1, 2, 0)).find("two bending stiffnesses"), std::string::npos);
  Problem problem = strip(1, 2);
  problem.sections = {{0.1, 0.2, 1, 1, {0, 0, 0}, -1}};
  EXPECT_NE(refused(problem).find("bending_stiffness_2 of a section"), std::string::npos);
  // Two stiffnesses in one section suffice to give the rod material directors.
  problem = round_rod(problem, 1);
  problem.sections[0].bending_stiffness_2 = 3;
  EXPECT_EQ(refused(problem), "no error");
  EXPECT_TRUE(has_material_directors(problem));
  problem.torsional_stiffness = 0;
  EXPECT_NE(refused(problem), "no error");
}

}  // namespace
}  // namespace dlo::energy_model
