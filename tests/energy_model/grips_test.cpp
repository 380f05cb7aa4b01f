// Tests of rods with several grips, in the plane and in space, and on obstacles.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>
#include <random>

#include "../says.hpp"
#include "dlo/energy_model/energy.hpp"
#include "dlo/energy_model/exact.hpp"
#include "equilibrium_balance.hpp"
#include "placement.hpp"
#include "problems.hpp"
#include "solved.hpp"

namespace dlo::energy_model {
namespace {

TEST(Grips, BalanceWeightAndLoadsInEveryArrangement) {
  const double gamma = 6;
  std::vector<Problem> problems;
  problems.push_back(two_clamps(gamma, 0.7));
  // A clamp inside the rod: two cantilevers
  problems.push_back(heavy_cantilever(gamma, 30));
  problems.back().grips[0].at = 0.4;
  // Two pins and free ends
  problems.push_back(heavy_cantilever(gamma, 0));
  problems.back().grips = {{0.2, {0, 0, 0}, {}}, {0.8, {0.5, 0.1, 0}, {}}};
  // Clamp, pin inside, free end with loads
  problems.push_back(heavy_cantilever(gamma, 0));
  problems.back().grips.push_back({0.6, {0.5, 0.1, 0}, {}});
  problems.back().loads = {{0.3, {0, 1, 0}}, {1.0, {1, -1, 0}}};
  // In space: two clamps, and a clamp with a pin
  problems.push_back(two_clamps(gamma, 0.7));
  problems.back().grips[1].position = {0.6, 0.1, 0.3};
  problems.back().grips[1].direction = Eigen::Vector3d(1, 0.2, -0.4);
  problems.push_back(heavy_cantilever(gamma, 20));
  problems.back().grips.push_back({0.7, {0.4, 0, 0.4}, {}});
  problems.back().loads = {{1.0, {0, 0.5, 1}}};
  // A load on a clamp
  problems.push_back(two_clamps(gamma, 0.7));
  problems.back().loads = {{1.0, {0.5, 0.5, 0}}};
  for (std::size_t i = 0; i < problems.size(); ++i) {
    for (const Equilibrium& result : {solve_energy(problems[i]), solve_exact(problems[i])}) {
      ASSERT_EQ(result.status, SolveStatus::converged) << i << ": " << result.message;
      const test::BalanceDefects defects = test::balance_of(problems[i], result, 0.01);
      EXPECT_LT(std::max(defects.force, defects.torque), 1e-9) << "problem " << i;
      EXPECT_LT(defects.grips, 1e-10) << "problem " << i;
    }
  }
}

TEST(Grips, TurnWithTheSceneInSpace) {
  std::mt19937 engine(5);
  std::normal_distribution<double> normal;
  std::vector<Problem> problems = {two_clamps(8, 0.8), heavy_cantilever(8, 40),
                                   heavy_cantilever(3, 0)};
  problems[2].loads = {{0.6, {0, 0, 2}}, {1.0, {0, 1, 1}}};
  for (const Problem& problem : problems) {
    const Equilibrium original = test::converged(solve_energy(problem));
    for (int i = 0; i < 50; ++i) {
      const Eigen::Quaterniond turn(normal(engine), normal(engine), normal(engine), normal(engine));
      const test::Placement other{.turn = turn.normalized().toRotationMatrix()};
      const Equilibrium result = test::converged(solve_energy(other.of(problem)));
      EXPECT_LT(other.differences(original, result).points, 1e-9);
      EXPECT_LT(other.differences(original, result).force, 1e-7);
    }
  }
}

TEST(Grips, OnePinCarriesAllThatHangsOnARodInSpace) {
  // The weight per length is not the largest force. It must be normalised before a frame is derived
  // from it.
  Problem problem;
  problem.length = 1;
  problem.bending_stiffness = 1;
  problem.weight_per_length = {0, -0.2, 0};
  problem.grips = {{.at = 0.3}};
  problem.loads = {{.at = 0.7, .force = {0.1, -0.3, 0.2}}, {.at = 1, .force = {-0.2, 0.1, 0.3}}};
  for (const double weight : {0.2, 0.0}) {
    problem.weight_per_length = {0, -weight, 0};
    const Equilibrium result = test::converged(solve_energy(problem));
    const Eigen::Vector3d hanging =
        problem.weight_per_length + problem.loads[0].force + problem.loads[1].force;
    EXPECT_LT((result.grips[0].force + hanging).norm(), 1e-12);
    const Equilibrium exact = test::converged(solve_exact(problem));
    EXPECT_LT(test::largest_point_distance(result, exact), 1e-9);
  }
}

TEST(Grips, FurtherApartThanTheRodAreRefusedWithTheNumbers) {
  EXPECT_TRUE(test::has_all(
      test::error_of<std::invalid_argument>([] { return solve_energy(two_clamps(1, 1.2)); }),
      {"1.2 m apart"}));
  Problem same_place = two_clamps(1, 0.5);
  same_place.grips[1].at = 0;
  EXPECT_THROW((void)solve_energy(same_place), std::invalid_argument);
}

TEST(TwoClamps, TautAndSlackConvergeInBoundedWork) {
  for (const double span : {0.999, 0.5}) {
    for (const double gamma : {0.0, 10.0, 1000.0, 1e5}) {
      const Equilibrium result = solve_energy(two_clamps(gamma, span));
      EXPECT_LT(result.evaluations, 2000);
      ASSERT_EQ(result.status, SolveStatus::converged)
          << "span " << span << ", Gamma " << gamma << ": " << result.message;
      EXPECT_GT(result.smallest_eigenvalue, -1e-7 * (1 + gamma)) << span << ", Gamma " << gamma;
      const Samples ends = result.sample(std::vector<double>{0, 1});
      EXPECT_NEAR((ends.points.col(1) - ends.points.col(0)).norm(), span, 1e-9);
      EXPECT_LT((ends.tangents.colwise() - Eigen::Vector3d::UnitX()).norm(), 1e-9);
      // The grips carry the weight, and there is no other force.
      EXPECT_LT(
          (result.grips[0].force + result.grips[1].force - Eigen::Vector3d(0, gamma, 0)).norm(),
          1e-6 * (1 + gamma));
    }
  }
}

TEST(TwoClamps, AtOnePlaceAndInOneDirectionHoldARing) {
  const Equilibrium ring = test::converged(solve_energy(two_clamps(0, 0)));
  // 1/2 EI (2 pi / l)^2 l
  EXPECT_NEAR(ring.energy.total(), 2 * std::numbers::pi * std::numbers::pi, 1e-9);
}

TEST(TwoClamps, AtOnePlaceConvergeOrSayWhyNot) {
  const std::vector<Eigen::Vector3d> ends = {
      Eigen::Vector3d::UnitX(), -Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(), {0.3, 0.2, 1}};
  for (const double gamma : {0.0, 10.0, 1000.0}) {
    int converged = 0;
    for (const Eigen::Vector3d& end : ends) {
      Problem problem = two_clamps(gamma, 0);
      problem.grips[1].direction = end;
      const Equilibrium result = solve_energy(problem);
      EXPECT_LT(result.evaluations, 5000);
      EXPECT_NE(result.message, "never ran");
      if (!succeeded(result.status)) continue;
      ++converged;
      const test::BalanceDefects defects = test::balance_of(problem, result, 0.005);
      EXPECT_LT(defects.force, 2e-10);
      EXPECT_LT(defects.torque, 1e-8);
    }
    EXPECT_GE(converged, 3) << "Gamma " << gamma;
  }
}

TEST(SlackRope, HangsAsACatenary) {
  // Catenary y = a cosh(x/a) with 2 a sinh(b/(2a)) = 1 and b = 0.6. Near the clamps the rod bends
  // within Gamma^(-1/2) = 1e-3.
  double a = 0.1;
  for (int i = 0; i < 100; ++i) {
    a -= (2 * a * std::sinh(0.3 / a) - 1) / (2 * std::sinh(0.3 / a) - 0.6 / a * std::cosh(0.3 / a));
  }
  Problem problem = two_clamps(1e6, 0.6);
  const double slope = std::sinh(0.3 / a);
  problem.grips[0].direction = Eigen::Vector3d(1, -slope, 0);
  problem.grips[1].direction = Eigen::Vector3d(1, slope, 0);
  const Equilibrium result = test::converged(solve_energy(problem));
  EXPECT_NEAR(test::point_at(result, 0.5).y(), a * (1 - std::cosh(0.3 / a)), 1e-5);
}

TEST(AllEquilibria, OfAHorizontalClampAreThoseOfTheExactScan) {
  // Above the fold at 41.4: the hanging branch, the folded-over branch, and the saddle between
  // them.
  for (const double gamma : {41.0, 41.5, 45.0, 60.0, 96.0, 120.0}) {
    SCOPED_TRACE(gamma);
    const Problem problem = heavy_cantilever(gamma, 0);
    const std::vector<Equilibrium> found = all_energy(problem);
    const std::vector<Equilibrium> exact = all_exact(problem);
    ASSERT_EQ(exact.size(), gamma > 41.4 ? 3U : 1U);
    ASSERT_EQ(found.size(), exact.size());
    EXPECT_GT(found[0].smallest_eigenvalue, 0);
    for (std::size_t i = 0; i < exact.size(); ++i) {
      EXPECT_NEAR(found[i].energy.total(), exact[i].energy.total(), 1e-8 * gamma);
    }
  }
}

TEST(AllEquilibria, AreCalledConvergedOnlyIfStable) {
  // An early prototype reported an S-shaped saddle with an energy of about 16.8 as converged.
  for (const double gamma : {0.0, 10.0, 60.0}) {
    for (const Problem& problem : {two_clamps(gamma, 0.8), heavy_cantilever(gamma, 50)}) {
      const std::vector<Equilibrium> found = all_energy(problem);
      EXPECT_EQ(found.front().status, SolveStatus::converged);
      for (const Equilibrium& equilibrium : found) {
        EXPECT_EQ(succeeded(equilibrium.status), equilibrium.smallest_eigenvalue >= -1e-6)
            << equilibrium.message << ", " << equilibrium.smallest_eigenvalue;
      }
    }
  }
}

TEST(SelfBuckling, IsWhereTheUprightRodLosesItsStability) {
  // The smallest eigenvalue of the straight rod passes zero linearly.
  const auto curvature = [](double gamma) {
    const std::vector<Equilibrium> all = all_energy(heavy_cantilever(gamma, 90));
    double straight = 0;
    for (const Equilibrium& equilibrium : all) {
      if (std::abs(test::point_at(equilibrium, 1).y() - 1) < 1e-9) {
        straight = equilibrium.smallest_eigenvalue;
      }
    }
    return straight;
  };
  const double below = curvature(7.8);
  const double above = curvature(7.9);
  EXPECT_GT(below, 0);
  EXPECT_LT(above, 0);
  EXPECT_NEAR((7.8 + 0.1 * below / (below - above)) / test::self_buckling_gamma, 1, 1e-4);
}

TEST(Grips, ScaleWithTheRodAtEqualGamma) {
  Problem problem = two_clamps(7, 0.7);
  problem.grips[1].direction = Eigen::Vector3d(1, 0.2, 0.4);
  problem.loads = {{0.4, {0, -1, 2}}};
  const Equilibrium unit = test::converged(solve_energy(problem));
  std::mt19937 random(7);
  std::uniform_real_distribution<double> decades(-2, 2);
  for (int draw = 0; draw < 10; ++draw) {
    const double l = std::pow(10, decades(random));
    const test::Placement other{.length = l, .stiffness = std::pow(10, decades(random))};
    const auto found = other.differences(unit, test::converged(solve_energy(other.of(problem))));
    EXPECT_LT(found.points, 1e-10);
    EXPECT_LT(found.energy, 1e-9);
    EXPECT_LT(found.force, 1e-7);
  }
}

TEST(HighLoad, LowestStateIsRightAtEveryAngle) {
  for (const double gamma : {1000.0, 10000.0}) {
    for (int degrees = -90; degrees <= 90; degrees += 15) {
      const Equilibrium energy = solve_energy(heavy_cantilever(gamma, degrees));
      const Equilibrium exact = solve_exact(heavy_cantilever(gamma, degrees));
      ASSERT_EQ(energy.status, SolveStatus::converged) << gamma << ", " << degrees;
      EXPECT_LT(test::largest_point_distance(energy, exact), 1e-7) << gamma << ", " << degrees;
    }
  }
}

// Checks a rod that clamps divide into spans, by both models and by the points themselves.
TEST(Clamps, LiftTheWeightOfEverySpan) {
  Problem problem = heavy_cantilever(6, 0);
  problem.grips.push_back({0.5, {0.4, 0.15, 0.05}, Eigen::Vector3d(1, 0.3, 0)});
  problem.grips.push_back({1, {0.8, -0.1, 0}, Eigen::Vector3d(1, -0.2, 0.1)});
  const Equilibrium found = test::converged(solve_energy(problem));
  constexpr Eigen::Index intervals = 2000;
  const std::vector<double> s = equal_arc_lengths(1, intervals + 1);
  const Eigen::RowVectorXd height = found.sample(s).points.row(1);
  // Trapezoids, whose error is below theta' h^2 / 12.
  const double mean = (height.sum() - (height[0] + height[intervals]) / 2) / intervals;
  EXPECT_NEAR(found.energy.gravity, 6 * mean, 1e-5);
  EXPECT_NEAR(found.energy.gravity, solve_exact(problem).energy.gravity, 1e-8);
}

TEST(Clamps, AnUnstableSpanMakesTheRodUnstable) {
  // A rod stands on a clamp that points down, up to a critical weight, and hangs below it.
  Problem problem = heavy_cantilever(40, -90);
  problem.grips[0].at = 0.5;
  const Equilibrium light = test::converged(solve_exact(problem));
  problem.weight_per_length *= 2;
  const Equilibrium heavy = solve_exact(problem, {.start = &light});
  EXPECT_EQ(heavy.status, SolveStatus::saddle) << heavy.message;
  EXPECT_LT(heavy.smallest_eigenvalue, -1e-3);
}

TEST(Pin, CarriesTheLoadThatActsOnIt) {
  Problem problem = heavy_cantilever(6, 0);
  problem.grips.push_back({0.6, {0.5, 0.1, 0}});
  const Eigen::Vector3d load(1, -2, 0.5);
  Problem loaded = problem;
  loaded.loads = {{0.6, load}};
  for (const auto solve : test::solvers) {
    const Equilibrium without = test::converged(solve(problem));
    const Equilibrium with = test::converged(solve(loaded));
    EXPECT_LT((with.grips[1].force + load - without.grips[1].force).norm(), 1e-6);
    EXPECT_LT((with.grips[0].force - without.grips[0].force).norm(), 1e-6);
  }
}

TEST(Arch, ThatIsUnstableOutOfPlaneLeavesThePlane) {
  // A tall arch between an upright clamp and one that points down leans out of its plane.
  Problem problem = heavy_cantilever(200, 90);
  problem.grips.push_back({1, {0.1, 0, 0}, Eigen::Vector3d(0, -1, 0)});
  const Equilibrium result = test::converged(solve_energy(problem));
  EXPECT_GE(result.smallest_eigenvalue, -1e-6);
  const std::vector<double> s = equal_arc_lengths(1, 21);
  EXPECT_GT(result.sample(s).points.row(2).cwiseAbs().maxCoeff(), 0.05);
}

}  // namespace
}  // namespace dlo::energy_model
