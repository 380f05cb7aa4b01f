// Rods with several grips, in the plane and in space, and on obstacles.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>
#include <random>

#include "dlo/energy_model/energy.hpp"
#include "dlo/energy_model/exact.hpp"
#include "problems.hpp"

namespace dlo::energy_model {
namespace {

using test::heavy_cantilever;
using test::reference_values;
using test::two_clamps;

/// Force and torque about the origin of everything that acts on the rod; zero in equilibrium.
struct Balance {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();
};

Balance balance(const Problem& problem, const Equilibrium& equilibrium) {
  Balance result;
  const auto add = [&](const Eigen::Vector3d& point, const Eigen::Vector3d& force) {
    result.force += force;
    result.torque += point.cross(force);
  };
  for (std::size_t i = 0; i < problem.grips.size(); ++i) {
    add(problem.grips[i].position, equilibrium.grips[i].force);
    result.torque += equilibrium.grips[i].torque;
  }
  for (const Load& load : problem.loads) {
    const std::vector<double> at = {load.at};
    add(equilibrium.sample(at).points.col(0), load.force);
  }
  // Simpson's rule between kinks: 400 panels for each piece
  std::vector<double> cuts = {0, problem.length};
  for (const Grip& grip : problem.grips) cuts.push_back(grip.at);
  for (const Load& load : problem.loads) cuts.push_back(load.at);
  std::sort(cuts.begin(), cuts.end());
  for (std::size_t c = 0; c + 1 < cuts.size(); ++c) {
    const double width = cuts[c + 1] - cuts[c];
    if (width < 1e-12) continue;
    std::vector<double> s;
    for (int i = 0; i <= 800; ++i) s.push_back(std::min(cuts[c] + width * i / 800, problem.length));
    const Eigen::Matrix3Xd points = equilibrium.sample(s).points;
    for (int i = 0; i <= 800; ++i) {
      const double simpson = (i == 0 || i == 800 ? 1.0 : i % 2 == 1 ? 4.0 : 2.0) / 2400;
      add(points.col(i), width * simpson * problem.weight_per_length);
    }
  }
  return result;
}

TEST(TwoClamps, MatchTheReferenceValues) {
  const auto expected = reference_values().at("two_clamps").at("Gamma=10, lowest state");
  const Equilibrium result = solve_energy(two_clamps(10, 0.8));
  ASSERT_EQ(result.status, SolveStatus::converged) << result.message;
  const std::vector<double> middle = {0.5};
  EXPECT_NEAR(result.sample(middle).points(1, 0), expected.at("y_mid").get<double>(), 1e-8);
  EXPECT_NEAR(result.energy.bending, expected.at("bending_energy").get<double>(), 1e-8);
  EXPECT_NEAR(result.energy.gravity, expected.at("gravity_energy").get<double>(), 1e-8);
  EXPECT_NEAR(result.energy.total(), expected.at("total_energy").get<double>(), 1e-8);
  EXPECT_NEAR(result.grips[1].force.x(), expected.at("lambda_x").get<double>(), 1e-6);
  EXPECT_NEAR(result.grips[1].force.y(), expected.at("lambda_y").get<double>(), 1e-6);
  EXPECT_NEAR(std::abs(result.grips[0].torque.z()),
              std::abs(expected.at("clamp_moment_0").get<double>()), 1e-6);
  EXPECT_NEAR(std::abs(result.grips[1].torque.z()),
              std::abs(expected.at("clamp_moment_L").get<double>()), 1e-6);
}

TEST(SpatialCantilever, MatchesTheReferenceValues) {
  const auto expected = reference_values().at("spatial_cantilever").at("tip P=(0,0,1), Gamma=1");
  Problem problem = heavy_cantilever(1, 0);
  problem.loads = {{1.0, {0, 0, 1}}};
  const Equilibrium result = solve_energy(problem);
  ASSERT_EQ(result.status, SolveStatus::converged) << result.message;
  const std::vector<double> tip = {1.0};
  const Samples samples = result.sample(tip);
  for (Eigen::Index i = 0; i < 3; ++i) {
    const auto k = static_cast<std::size_t>(i);
    EXPECT_NEAR(samples.points(i, 0), expected.at("tip")[k].get<double>(), 1e-8);
    EXPECT_NEAR(samples.tangents(i, 0), expected.at("tip_tangent")[k].get<double>(), 1e-8);
  }
  EXPECT_NEAR(result.energy.bending, expected.at("bending_energy").get<double>(), 1e-8);
  EXPECT_NEAR(result.energy.gravity, expected.at("gravity_energy").get<double>(), 1e-8);
}

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
      const Balance rest = balance(problems[i], result);
      EXPECT_LT(rest.force.norm(), 1e-8 * gamma) << "problem " << i;
      EXPECT_LT(rest.torque.norm(), 1e-8 * gamma) << "problem " << i;
      for (const Grip& grip : problems[i].grips) {
        const std::vector<double> at = {grip.at};
        const Samples samples = result.sample(at);
        EXPECT_LT((samples.points.col(0) - grip.position).norm(), 1e-10) << "problem " << i;
        if (!grip.direction) continue;
        EXPECT_LT((samples.tangents.col(0) - grip.direction->normalized()).norm(), 1e-10);
      }
    }
  }
}

TEST(Grips, TurnWithTheSceneInSpace) {
  std::mt19937 engine(5);
  std::normal_distribution<double> normal;
  std::vector<Problem> problems = {two_clamps(8, 0.8), heavy_cantilever(8, 40),
                                   heavy_cantilever(3, 0)};
  problems[2].loads = {{0.6, {0, 0, 2}}, {1.0, {0, 1, 1}}};
  const std::vector<double> s = equal_arc_lengths(1, 11);
  for (const Problem& problem : problems) {
    const Equilibrium original = solve_energy(problem);
    ASSERT_EQ(original.status, SolveStatus::converged);
    for (int i = 0; i < 50; ++i) {
      const Eigen::Matrix3d R =
          Eigen::Quaterniond(normal(engine), normal(engine), normal(engine), normal(engine))
              .normalized()
              .toRotationMatrix();
      Problem turned = problem;
      turned.weight_per_length = R * problem.weight_per_length;
      for (Grip& grip : turned.grips) {
        grip.position = R * grip.position;
        grip.direction = R * *grip.direction;
      }
      for (Load& load : turned.loads) load.force = R * load.force;
      const Equilibrium result = solve_energy(turned);
      ASSERT_EQ(result.status, SolveStatus::converged) << result.message;
      EXPECT_LT(
          (R * original.sample(s).points - result.sample(s).points).colwise().norm().maxCoeff(),
          1e-9);
      EXPECT_LT((R * original.grips[0].force - result.grips[0].force).norm(), 1e-7);
    }
  }
}

TEST(Grips, OnePinCarriesAllThatHangsOnARodInSpace) {
  // The weight is not the largest force: no frame may be made of it unless it has length 1.
  Problem problem;
  problem.length = 1;
  problem.bending_stiffness = 1;
  problem.weight_per_length = {0, -0.2, 0};
  problem.grips = {{.at = 0.3}};
  problem.loads = {{.at = 0.7, .force = {0.1, -0.3, 0.2}}, {.at = 1, .force = {-0.2, 0.1, 0.3}}};
  for (const double weight : {0.2, 0.0}) {
    problem.weight_per_length = {0, -weight, 0};
    const Equilibrium result = solve_energy(problem);
    ASSERT_EQ(result.status, SolveStatus::converged) << result.message;
    const Eigen::Vector3d hanging =
        problem.weight_per_length + problem.loads[0].force + problem.loads[1].force;
    EXPECT_LT((result.grips[0].force + hanging).norm(), 1e-12);
    const Equilibrium exact = solve_exact(problem);
    ASSERT_EQ(exact.status, SolveStatus::converged) << exact.message;
    const std::vector<double> s = equal_arc_lengths(1, 21);
    EXPECT_LT((result.sample(s).points - exact.sample(s).points).colwise().norm().maxCoeff(), 1e-9);
  }
}

TEST(Grips, FurtherApartThanTheRodAreRefusedWithTheNumbers) {
  try {
    (void)solve_energy(two_clamps(1, 1.2));
    FAIL() << "no error";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("1.2 m apart"), std::string::npos) << error.what();
  }
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
      // The grips carry the weight, and nothing else acts.
      EXPECT_LT(
          (result.grips[0].force + result.grips[1].force - Eigen::Vector3d(0, gamma, 0)).norm(),
          1e-6 * (1 + gamma));
    }
  }
}

TEST(TwoClamps, AtOnePlaceAndInOneDirectionHoldARing) {
  const Equilibrium ring = solve_energy(two_clamps(0, 0));
  ASSERT_EQ(ring.status, SolveStatus::converged) << ring.message;
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
      const Balance rest = balance(problem, result);
      EXPECT_LT(rest.force.norm(), 1e-8 * (1 + gamma));
      EXPECT_LT(rest.torque.norm(), 1e-6 * (1 + gamma));
    }
    EXPECT_GE(converged, 3) << "Gamma " << gamma;
  }
}

TEST(SlackRope, HangsAsACatenary) {
  // y = a cosh(x/a) with 2 a sinh(b/(2a)) = 1, b = 0.6; stiffness rounds the clamps within
  // Gamma^(-1/2) = 1e-3
  double a = 0.1;
  for (int i = 0; i < 100; ++i) {
    a -= (2 * a * std::sinh(0.3 / a) - 1) / (2 * std::sinh(0.3 / a) - 0.6 / a * std::cosh(0.3 / a));
  }
  Problem problem = two_clamps(1e6, 0.6);
  const double slope = std::sinh(0.3 / a);
  problem.grips[0].direction = Eigen::Vector3d(1, -slope, 0);
  problem.grips[1].direction = Eigen::Vector3d(1, slope, 0);
  const Equilibrium result = solve_energy(problem);
  ASSERT_EQ(result.status, SolveStatus::converged) << result.message;
  const std::vector<double> middle = {0.5};
  EXPECT_NEAR(result.sample(middle).points(1, 0), a * (1 - std::cosh(0.3 / a)), 1e-5);
}

TEST(AllEquilibria, OfAHorizontalClampAreThoseOfTheExactScan) {
  // Above the fold at 41.4: what hangs, what is folded over it, and the pass between.
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

TEST(AllEquilibria, AreCalledConvergedOnlyIfNothingMakesThemFall) {
  // The prototype's trap: an S of energy about 16.8 that a solver called a success
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

double fold_gamma(double degrees, double from) {
  // Follow the thrown-back state downwards until it snaps, then bisect.
  Problem problem = heavy_cantilever(from, degrees);
  const std::vector<Equilibrium> all = all_energy(problem);
  const std::vector<double> tip = {1.0};
  const Equilibrium* thrown_back = nullptr;
  for (const Equilibrium& equilibrium : all) {
    // Held in the plane; in space it would fall to the front sideways, which is not the fold.
    const bool behind = equilibrium.sample(tip).points(0, 0) < 0;
    if (behind &&
        (thrown_back == nullptr || equilibrium.energy.total() < thrown_back->energy.total())) {
      thrown_back = &equilibrium;
    }
  }
  if (thrown_back == nullptr) return 0;
  Equilibrium on_branch = *thrown_back;
  double high = from;
  double low = from / 2;
  double step = from / 20;
  while (high - low > 1e-5 * high) {
    const double gamma = std::max(high - step, (high + low) / 2);
    const Equilibrium next = solve_energy(heavy_cantilever(gamma, degrees), {.start = &on_branch});
    // Beyond the fold it snaps to the front. (Out of the plane it does not hold itself, see above.)
    if (next.status != SolveStatus::failed && next.sample(tip).points(0, 0) < 0) {
      high = gamma;
      on_branch = next;
    } else {
      low = gamma;
      step /= 2;
    }
  }
  return high;
}

TEST(Bistability, FoldsAreWhereTheFollowedStateSnaps) {
  const auto folds = reference_values().at("bistability_fold_Gamma");
  EXPECT_NEAR(fold_gamma(0, 60) / folds.at("0").get<double>(), 1, 1e-4);
  EXPECT_NEAR(fold_gamma(30, 40) / folds.at("30").get<double>(), 1, 1e-4);
}

TEST(SelfBuckling, IsWhereTheUprightRodLosesItsStability) {
  // The smallest eigenvalue of the straight rod passes zero linearly.
  const auto curvature = [](double gamma) {
    const std::vector<Equilibrium> all = all_energy(heavy_cantilever(gamma, 90));
    double straight = 0;
    const std::vector<double> tip = {1.0};
    for (const Equilibrium& equilibrium : all) {
      if (std::abs(equilibrium.sample(tip).points(1, 0) - 1) < 1e-9) {
        straight = equilibrium.smallest_eigenvalue;
      }
    }
    return straight;
  };
  const double below = curvature(7.8);
  const double above = curvature(7.9);
  EXPECT_GT(below, 0);
  EXPECT_LT(above, 0);
  EXPECT_NEAR((7.8 + 0.1 * below / (below - above)) / self_buckling_gamma(), 1, 1e-4);
}

TEST(Grips, ScaleWithTheRodAtEqualGamma) {
  Problem problem = two_clamps(7, 0.7);
  problem.grips[1].direction = Eigen::Vector3d(1, 0.2, 0.4);
  problem.loads = {{0.4, {0, -1, 2}}};
  const Equilibrium unit = solve_energy(problem);
  ASSERT_EQ(unit.status, SolveStatus::converged) << unit.message;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> decades(-2, 2);
  for (int draw = 0; draw < 10; ++draw) {
    const double l = std::pow(10, decades(random));
    const double EI = std::pow(10, decades(random));
    Problem scaled = problem;
    scaled.length = l;
    scaled.bending_stiffness = EI;
    scaled.weight_per_length *= EI / (l * l * l);
    scaled.grips[1].at = l;
    scaled.grips[1].position *= l;
    scaled.loads = {{0.4 * l, problem.loads[0].force * EI / (l * l)}};
    const Equilibrium result = solve_energy(scaled);
    ASSERT_EQ(result.status, SolveStatus::converged) << result.message;
    const std::vector<double> middle = {0.5};
    const std::vector<double> scaled_middle = {0.5 * l};
    EXPECT_LT((unit.sample(middle).points - result.sample(scaled_middle).points / l).norm(), 1e-10);
    EXPECT_NEAR(result.energy.total() * l / EI, unit.energy.total(), 1e-9);
    EXPECT_LT((result.grips[1].force * l * l / EI - unit.grips[1].force).norm(), 1e-7);
  }
}

TEST(HighLoad, LowestStateIsRightAtEveryAngle) {
  const std::vector<double> s = equal_arc_lengths(1, 41);
  for (const double gamma : {1000.0, 10000.0}) {
    for (int degrees = -90; degrees <= 90; degrees += 15) {
      const Equilibrium energy = solve_energy(heavy_cantilever(gamma, degrees));
      const Equilibrium exact = solve_exact(heavy_cantilever(gamma, degrees));
      ASSERT_EQ(energy.status, SolveStatus::converged) << gamma << ", " << degrees;
      EXPECT_LT((energy.sample(s).points - exact.sample(s).points).colwise().norm().maxCoeff(),
                1e-7)
          << gamma << ", " << degrees;
    }
  }
}

// Of a rod that clamps cut into spans, wherever they are: both models and the points themselves.
TEST(Clamps, LiftTheWeightOfEverySpan) {
  Problem problem = heavy_cantilever(6, 0);
  problem.grips.push_back({0.5, {0.4, 0.15, 0.05}, Eigen::Vector3d(1, 0.3, 0)});
  problem.grips.push_back({1, {0.8, -0.1, 0}, Eigen::Vector3d(1, -0.2, 0.1)});
  const Equilibrium found = solve_energy(problem);
  ASSERT_EQ(found.status, SolveStatus::converged) << found.message;
  constexpr Eigen::Index intervals = 2000;
  const std::vector<double> s = equal_arc_lengths(1, intervals + 1);
  const Eigen::RowVectorXd height = found.sample(s).points.row(1);
  // Trapezoids, whose error is below theta' h^2 / 12.
  const double mean = (height.sum() - (height[0] + height[intervals]) / 2) / intervals;
  EXPECT_NEAR(found.energy.gravity, 6 * mean, 1e-5);
  EXPECT_NEAR(found.energy.gravity, solve_exact(problem).energy.gravity, 1e-8);
}

TEST(Clamps, ASpanThatGivesWayMakesTheRodUnstable) {
  // The rod comes down to its clamp, at last too heavy to stand on it, and hangs below.
  Problem problem = heavy_cantilever(40, -90);
  problem.grips[0].at = 0.5;
  const Equilibrium light = solve_exact(problem);
  EXPECT_EQ(light.status, SolveStatus::converged) << light.message;
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
  for (const auto& solve : {+[](const Problem& p) { return solve_energy(p); },
                            +[](const Problem& p) { return solve_exact(p); }}) {
    const Equilibrium without = solve(problem);
    const Equilibrium with = solve(loaded);
    ASSERT_EQ(without.status, SolveStatus::converged) << without.message;
    ASSERT_EQ(with.status, SolveStatus::converged) << with.message;
    EXPECT_LT((with.grips[1].force + load - without.grips[1].force).norm(), 1e-6);
    EXPECT_LT((with.grips[0].force - without.grips[0].force).norm(), 1e-6);
  }
}

TEST(Arch, ThatIsUnstableOutOfPlaneLeavesThePlane) {
  // An upright rod above self-buckling whose tip is pinned right above the clamp, pressed down: it
  // buckles in any plane; a tall arch between clamps that point up and down leans over.
  Problem problem = heavy_cantilever(200, 90);
  problem.grips.push_back({1, {0.1, 0, 0}, Eigen::Vector3d(0, -1, 0)});
  const Equilibrium result = solve_energy(problem);
  ASSERT_EQ(result.status, SolveStatus::converged) << result.message;
  EXPECT_GE(result.smallest_eigenvalue, -1e-6);
  const std::vector<double> s = equal_arc_lengths(1, 21);
  EXPECT_GT(result.sample(s).points.row(2).cwiseAbs().maxCoeff(), 0.05);
}

}  // namespace
}  // namespace dlo::energy_model
