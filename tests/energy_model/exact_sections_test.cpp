// Rods of several sections by multiple shooting, against beam theory, a stepped column's buckling
// load, first integrals, the rod of one section, and the balance of forces.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "dlo/energy_model/exact.hpp"
#include "equilibrium_balance.hpp"
#include "placement.hpp"
#include "problems.hpp"
#include "random_problems.hpp"
#include "solved.hpp"

namespace dlo::energy_model {
namespace {

using std::numbers::pi;
using test::heavy_cantilever;
using test::two_clamps;

/// A weightless rod of unit length along x, of stiffness 1 up to `step` and `stiffness` beyond.
Problem stepped_rod(double step, double stiffness) {
  Problem problem = heavy_cantilever(0, 0);
  problem.sections = {{step, 1, stiffness, 0, Eigen::Vector3d::Zero()}};
  return problem;
}

/// Divides the problem into sections that are all like the rod.
Problem divided(Problem problem) {
  for (const auto& [begin, end] : {std::pair(0.0, 0.3), {0.3, 0.35}, {0.61, 1.0}}) {
    problem.sections.push_back({begin, end, problem.bending_stiffness, problem.torsional_stiffness,
                                problem.weight_per_length});
  }
  return problem;
}

void expect_same(const Equilibrium& a, const Equilibrium& b, double tolerance) {
  ASSERT_EQ(a.status, SolveStatus::converged) << a.message;
  ASSERT_EQ(b.status, SolveStatus::converged) << b.message;
  const std::vector<double> s = equal_arc_lengths(1, 41);
  EXPECT_LT((a.sample(s).points - b.sample(s).points).cwiseAbs().maxCoeff(), tolerance);
  EXPECT_LT((a.sample(s).curvature - b.sample(s).curvature).cwiseAbs().maxCoeff(), 100 * tolerance);
  EXPECT_NEAR(a.energy.bending, b.energy.bending, tolerance);
  EXPECT_NEAR(a.energy.twisting, b.energy.twisting, tolerance);
  EXPECT_NEAR(a.energy.gravity, b.energy.gravity, tolerance);
  EXPECT_NEAR(a.energy.load, b.energy.load, tolerance);
  for (std::size_t i = 0; i < a.grips.size(); ++i) {
    EXPECT_LT((a.grips[i].force - b.grips[i].force).norm(), 100 * tolerance);
    EXPECT_LT((a.grips[i].torque - b.grips[i].torque).norm(), 100 * tolerance);
  }
}

TEST(ExactSections, SectionsLikeTheRodAreTheRod) {
  Problem cantilever = heavy_cantilever(20, 30);
  cantilever.loads = {{0.5, {1, 2, 0}}, {1, {0, -3, 0}}};
  expect_same(solve_exact(divided(cantilever)), solve_exact(cantilever), 1e-12);
  Problem twisted = two_clamps(10, 0.8);
  twisted.torsional_stiffness = 0.7;
  for (Grip& grip : twisted.grips) grip.frame = FrameHold{};
  twisted.grips[1].frame->roll = 2;
  expect_same(solve_exact(divided(twisted)), solve_exact(twisted), 1e-11);
}

TEST(ExactSections, TendToBeamTheoryWithTheSquareOfTheLoad) {
  constexpr double step = 0.4;
  constexpr double stiffness = 0.25;
  const double soft = std::pow(1 - step, 3);
  double before = 0;
  for (const double force : {0.02, 0.01, 0.005}) {
    Problem problem = stepped_rod(step, stiffness);
    problem.loads = {{1, {0, -force, 0}}};
    const Equilibrium result = test::converged(solve_exact(problem));
    const double beam = force / 3 * (1 - soft + soft / stiffness);
    const double error = 1 + test::point_at(result, 1).y() / beam;
    if (before > 0) {
      EXPECT_NEAR(before / error, 4, 0.02);
    }
    before = error;
    EXPECT_LT(std::abs(error), 1e-3);
  }
}

TEST(ExactSections, AColumnOfTwoStiffnessesBucklesUnderItsLoad) {
  // Linear theory: tan(k a) tan(q b) = q / k, k = P^(1/2), q = (P / stiffness)^(1/2).
  constexpr double step = 0.4;
  constexpr double stiffness = 0.25;
  const auto miss = [&](double load) {
    const double k = std::sqrt(load);
    const double q = std::sqrt(load / stiffness);
    return std::sin(k * step) * std::sin(q * (1 - step)) * k -
           q * std::cos(k * step) * std::cos(q * (1 - step));
  };
  double low = 0.1;
  double high = pi * pi / 4;
  ASSERT_LT(miss(low) * miss(high), 0);
  while (high - low > 1e-14) {
    const double middle = (low + high) / 2;
    (miss(low) * miss(middle) > 0 ? low : high) = middle;
  }
  const auto column = [&](double load) {
    Problem problem = stepped_rod(step, stiffness);
    problem.loads = {{1, {-load, 0, 0}}};
    return problem;
  };
  const Equilibrium straight = solve_exact(column(low * (1 - 1e-5)));
  ASSERT_LT(straight.energy.bending, 1e-12);
  const double below = straight.smallest_eigenvalue;
  const double above =
      solve_exact(column(low * (1 + 1e-5)), {.start = &straight}).smallest_eigenvalue;
  EXPECT_GT(below, 0);
  EXPECT_LT(above, 0);
  EXPECT_NEAR(below / above, -1, 1e-3);  // the zero is in the middle
}

TEST(ExactSections, KeepTheFirstIntegralAndTheMomentOfAWeightlessRod) {
  Problem problem = stepped_rod(0.5, 3);
  problem.sections.insert(problem.sections.begin(), {0.2, 0.5, 0.4, 0, Eigen::Vector3d::Zero()});
  const Eigen::Vector3d force(-3, -4, 0);
  problem.loads = {{1, force}};
  const Equilibrium result = test::converged(solve_exact(problem));
  const auto state = [&](double s) { return test::sample_at(result, s); };
  const auto integral = [&](double s, double stiffness) {
    const Samples at = state(s);
    return stiffness * at.curvature.col(0).squaredNorm() / 2 + force.dot(at.tangents.col(0));
  };
  EXPECT_NEAR(integral(0, 1), integral(0.19, 1), 1e-11);
  EXPECT_NEAR(integral(0.2, 0.4), integral(0.49, 0.4), 1e-11);
  EXPECT_NEAR(integral(0.5, 3), integral(1, 3), 1e-11);
  // The moment is that of the force about the section, whatever the stiffness.
  for (const auto& [s, stiffness] : {std::pair(0.1, 1.0), {0.3, 0.4}, {0.7, 3.0}}) {
    const Samples at = state(s);
    const Eigen::Vector3d moment =
        stiffness * Eigen::Vector3d(at.tangents.col(0)).cross(Eigen::Vector3d(at.curvature.col(0)));
    const Eigen::Vector3d arm = state(1).points.col(0) - at.points.col(0);
    EXPECT_LT((moment - arm.cross(force)).norm(), 1e-11);
  }
}

TEST(ExactSections, ATautRodOfTwoTorsionalStiffnessesTwistsAsTwoSprings) {
  Problem problem = heavy_cantilever(0, 0);
  problem.torsional_stiffness = 0.5;
  problem.grips.push_back({1, {1 - 1e-3, 0, 0}, Eigen::Vector3d(1, 0, 0)});
  problem.sections = {{0.3, 0.6, 1, 2, Eigen::Vector3d::Zero()}};
  for (Grip& grip : problem.grips) grip.frame = FrameHold{};
  problem.grips[1].frame->roll = 0.3;
  const Equilibrium result = test::converged(solve_exact(problem));
  ASSERT_EQ(result.twists.size(), 1U);
  const double compliance = 0.7 / 0.5 + 0.3 / 2;
  EXPECT_NEAR(result.twists[0].angle, compliance * result.twists[0].torque, 1e-12);
  EXPECT_NEAR(result.energy.twisting, compliance * std::pow(result.twists[0].torque, 2) / 2, 1e-12);
}

TEST(ExactSections, ReactionsAreTheDerivativesOfTheEnergy) {
  Problem problem = two_clamps(3, 0.8);
  problem.weight_per_length = {0.3, -3, 0.2};
  problem.sections = {{0.2, 0.45, 4, 0, {0, -9, 1}}, {0.6, 0.7, 0.3, 0, {0, 0, 0}}};
  problem.loads = {{0.65, {0, 1, 2}}};
  const Equilibrium result = test::converged(solve_exact(problem));
  constexpr double h = 1e-4;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const auto energy = [&](double shift) {
      Problem moved = problem;
      moved.grips[1].position[axis] += shift;
      return solve_exact(moved, {.start = &result}).energy.total();
    };
    const double rate = (energy(h) - energy(-h)) / (2 * h);
    EXPECT_NEAR(rate, result.grips[1].force[axis], 2e-6 * (1 + result.grips[1].force.norm()));
  }
}

/// Grips that a random curve goes through, forces of up to some 30 EI/l^2, two or three sections.
Problem random_rod(std::uint64_t number, test::RandomSpace space) {
  test::RandomNumbers random(7000 + number);
  const double size = std::pow(10, random.uniform(-1, 1.5));
  Problem problem = heavy_cantilever(size, 0);
  problem.grips.clear();
  const test::RandomCurve curve(random, space);
  const int grips = 1 + random.below(3);
  for (const double at : test::random_grip_places(random, grips)) {
    const bool clamp = grips == 1 || random.chance(0.6);
    problem.grips.push_back(
        {at, 0.95 * curve.point(at), clamp ? std::optional(curve.tangent(at)) : std::nullopt, {}});
  }
  problem.loads = {{random.uniform(), size * random.direction(space)}};
  double at = random.uniform(0, 0.3);
  for (int i = 0; i < 2; ++i) {
    const double end = at + random.uniform(0.05, 0.3);
    const double stiffness = std::exp(random.uniform(-2, 2));
    problem.sections.push_back(
        {at, end, stiffness, 0, problem.weight_per_length * random.uniform(0, 3)});
    at = end + (random.chance(0.5) ? 0 : 0.03);
  }
  return problem;
}

TEST(ExactSections, UnitsDoNotMatter) {
  const Problem own = random_rod(1, test::RandomSpace::space);
  const test::Placement other{.length = 0.7, .stiffness = 3e-3};
  const auto found =
      other.between(test::converged(solve_exact(own)), test::converged(solve_exact(other.of(own))));
  EXPECT_LT(found.points, 1e-10);
  EXPECT_LT(found.energy, 2e-10);
  EXPECT_LT(std::max(found.force, found.torque), 1e-9);
}

TEST(ExactSections, RandomRodsAreInBalance) {
  for (const auto space : {test::RandomSpace::plane, test::RandomSpace::space}) {
    for (std::uint64_t number = 0; number < 6; ++number) {
      const Problem problem = random_rod(number, space);
      const Equilibrium result = solve_exact(problem);
      EXPECT_EQ(result.status, SolveStatus::converged) << number << ": " << result.message;
      if (result.status != SolveStatus::converged) continue;
      EXPECT_LT(test::balance_of(problem, result, 0.005).worst(), 1e-9) << number;
    }
  }
}

}  // namespace
}  // namespace dlo::energy_model
