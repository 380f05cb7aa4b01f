// Tests of intrinsically curved rods, in the plane and in space, against a first integral,
// published critical weights, and Kirchhoff's equations integrated along the rod from the reaction
// of its first clamp.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "dlo/energy_model/exact.hpp"
#include "dlo/energy_model/natural_frame.hpp"
#include "equilibrium_balance.hpp"
#include "kirchhoff_rod.hpp"
#include "placement.hpp"
#include "problems.hpp"
#include "random_problems.hpp"
#include "runge_kutta.hpp"
#include "solved.hpp"

namespace dlo::energy_model {
namespace {

/// Returns a rod of unit length and bending stiffness, clamped at the origin in the frame of the
/// axes.
Problem curved_rod(const Eigen::Vector3d& strain, double torsion = 0.8) {
  Problem problem;
  problem.length = 1;
  problem.bending_stiffness = 1;
  problem.torsional_stiffness = torsion;
  problem.grips = {{.at = 0,
                    .position = Eigen::Vector3d::Zero(),
                    .direction = Eigen::Vector3d(0, 0, 1),
                    .frame = FrameHold{.d1 = Eigen::Vector3d(1, 0, 0)}}};
  problem.natural_strains = {strain};
  return problem;
}

/// Returns a rod that hangs from a clamp at its top, in units of its length and stiffness.
Problem hanging_rod(double curvature, double gamma) {
  Problem problem = heavy_cantilever(gamma, -90);
  problem.torsional_stiffness = 2.0 / 3;
  problem.natural_strains = {{0, curvature, 0}};
  return problem;
}

/// Returns int f dtheta from a to b by Simpson's rule, which is the Runge-Kutta method of f alone.
template <class Function>
double quadrature(double a, double b, Function f) {
  constexpr int panels = 2000;
  const double h = (b - a) / panels;
  const auto rate = [&](double at, double) { return f(at); };
  double sum = 0;
  for (int p = 0; p < panels; ++p) sum = test::runge_kutta(rate, a + p * h, sum, h);
  return sum;
}

TEST(ExactNatural, ATipLoadInThePlaneIsAQuadrature) {
  // The first integral (EI kappa0 + m)^2 / 2 + F.t is constant along the rod and m is zero at the
  // tip. It gives the curvature by the angle, and ds = dtheta / kappa the arc length.
  constexpr double natural = 3;
  const Eigen::Vector2d force(-0.7, -1.2);
  const auto pull = [&](double angle) {
    return force.x() * std::cos(angle) + force.y() * std::sin(angle);
  };
  const auto curvature = [&](double angle, double tip) {
    return std::sqrt(natural * natural + 2 * (pull(tip) - pull(angle)));
  };
  double low = 1;
  double high = 5;
  while (high - low > 1e-14) {
    const double tip = (low + high) / 2;
    const double length = quadrature(0, tip, [&](double a) { return 1 / curvature(a, tip); });
    (length < 1 ? low : high) = tip;
  }
  Problem problem = heavy_cantilever(0, 0);
  problem.torsional_stiffness = 1;
  problem.natural_strains = {{0, natural, 0}};
  problem.loads = {{1, {force.x(), force.y(), 0}}};
  const Equilibrium result = test::converged(solve_exact(problem));
  const Samples tip = test::sample_at(result, 1);
  EXPECT_LT((tip.tangents.col(0) - Eigen::Vector3d(std::cos(low), std::sin(low), 0)).norm(), 1e-11);
  const double x = quadrature(0, low, [&](double a) { return std::cos(a) / curvature(a, low); });
  const double y = quadrature(0, low, [&](double a) { return std::sin(a) / curvature(a, low); });
  EXPECT_LT((tip.points.col(0) - Eigen::Vector3d(x, y, 0)).norm(), 1e-11);
  EXPECT_NEAR(result.grips[0].torque.z(), -(curvature(0, low) - natural), 1e-10);
  const double bending = quadrature(0, low, [&](double a) {
    return std::pow(curvature(a, low) - natural, 2) / 2 / curvature(a, low);
  });
  EXPECT_NEAR(result.energy.bending, bending, 1e-11);
}

/// Returns the equilibrium of a hanging rod in its plane that is found from a similar one.
Equilibrium planar_shape(double curvature, double gamma, const Equilibrium& near) {
  Equilibrium shape = solve_exact(hanging_rod(curvature, gamma), {.start = &near});
  EXPECT_TRUE(shape.sample) << shape.message;
  EXPECT_LT(shape.sample(equal_arc_lengths(1, 9)).points.row(2).cwiseAbs().maxCoeff(), 1e-9);
  return shape;
}

/// Returns the Gamma at which the smallest eigenvalue of the planar shape is zero, by the secant
/// method from a and b.
double critical_gamma(double curvature, double a, double b, Equilibrium shape) {
  const auto at = [&](double gamma) {
    shape = planar_shape(curvature, gamma, shape);
    return shape.smallest_eigenvalue;
  };
  double f = at(a);
  double g = at(b);
  for (int i = 0; i < 30 && std::abs(a - b) > 1e-9 * b; ++i) {
    const double next = b - g * (b - a) / (g - f);
    a = std::exchange(b, next);
    f = std::exchange(g, at(next));
  }
  return b;
}

/// Compares the weights at which the hanging rod leaves its plane and returns to it with
/// references.
void expect_critical_weights(double curvature, double leaves, double returns) {
  Equilibrium light = solve_exact(hanging_rod(curvature, 0));
  for (double gamma = 4; gamma < leaves; gamma += 4) light = planar_shape(curvature, gamma, light);
  EXPECT_NEAR(critical_gamma(curvature, leaves - 0.5, leaves + 0.5, light), leaves, 1e-6);
  const double above = 1.05 * returns;
  const Equilibrium heavy = test::converged(solve_exact(hanging_rod(curvature, above)));
  EXPECT_NEAR(critical_gamma(curvature, above, 1.03 * returns, heavy), returns, 1e-6);
}

// Rods with natural curvature 10/l, 8/l and 6/l leave their plane, and return to it, at different
// weights.
TEST(ExactNatural, AHangingRodOf10LeavesItsPlaneAndReturns) {
  expect_critical_weights(10, 28.769705, 238.935595);
}

TEST(ExactNatural, AHangingRodOf8LeavesItsPlaneAndReturns) {
  expect_critical_weights(8, 19.248423, 119.902772);
}

TEST(ExactNatural, AHangingRodOf6LeavesItsPlaneAndReturns) {
  expect_critical_weights(6, 11.868751, 37.763909);
}

TEST(ExactNatural, AHangingRodOfLessCurvatureStaysInItsPlane) {
  Equilibrium shape = solve_exact(hanging_rod(5, 0));
  for (double gamma = 2; gamma < 60; gamma += 2) {
    shape = planar_shape(5, gamma, shape);
    EXPECT_EQ(shape.status, SolveStatus::converged) << gamma;
  }
}

TEST(ExactNatural, BetweenTheTwoWeightsTheLowestShapeIsOutOfThePlane) {
  const std::vector<Equilibrium> all = all_exact(hanging_rod(10, 35));
  ASSERT_GE(all.size(), 2U);
  EXPECT_EQ(all[0].status, SolveStatus::converged);
  const std::vector<double> s = equal_arc_lengths(1, 21);
  const double out = all[0].sample(s).points.row(2).cwiseAbs().maxCoeff();
  EXPECT_GT(out, 0.01);
  // The second equilibrium is the mirror image of the first.
  Samples mirrored = all[0].sample(s);
  mirrored.points.row(2) *= -1;
  EXPECT_LT((all[1].sample(s).points - mirrored.points).cwiseAbs().maxCoeff(), 1e-10);
}

/// Returns a rod with one to three grips on a random curve that is shrunk by 5 % towards its begin,
/// natural strains of two Legendre terms, a load and a section.
Problem random_curved_rod(std::uint64_t number) {
  test::RandomNumbers random(9000 + number);
  const test::RandomCurve curve(random, test::RandomSpace::space);
  const Eigen::Vector3d any = random.direction(test::RandomSpace::space);
  Problem problem =
      curved_rod({random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(-3, 3)},
                 random.uniform(0.5, 1.2));
  problem.natural_strains.emplace_back(random.uniform(-1, 1), random.uniform(-1, 1), 0);
  problem.weight_per_length = random.uniform(0, 8) * any;
  problem.grips[0].position = curve.point(0);
  problem.grips[0].direction = curve.tangent(0);
  problem.grips[0].frame->d1 = curve.tangent(0).unitOrthogonal();
  problem.grips[0].frame->roll = random.uniform(-1, 1);
  const int more = random.below(3);
  const bool framed = random.chance(0.5);
  for (int i = 1; i <= more; ++i) {
    const double at = static_cast<double>(i) / more;
    Grip grip{at, 0.05 * curve.point(0) + 0.95 * curve.point(at), curve.tangent(at), {}};
    if (random.chance(0.3)) {
      grip.direction.reset();
    } else if (framed) {
      grip.frame = FrameHold{std::nullopt, random.uniform(-2, 2)};
    }
    problem.grips.push_back(grip);
  }
  problem.loads = {{0.35, 2 * random.direction(test::RandomSpace::space)}};
  problem.sections = {
      {0.2, 0.6, random.uniform(0.5, 2), random.uniform(0.5, 1), 2 * problem.weight_per_length}};
  return problem;
}

TEST(ExactNatural, RandomRodsObeyKirchhoffsEquations) {
  constexpr int count = 8;
  int solved = 0;
  for (std::uint64_t number = 0; number < count; ++number) {
    const Problem problem = random_curved_rod(number);
    const Equilibrium result = solve_exact(problem);
    EXPECT_EQ(result.status, SolveStatus::converged) << number << ": " << result.message;
    if (result.status != SolveStatus::converged) continue;
    ++solved;
    EXPECT_LT(test::balance_of(problem, result, 0.01).worst(), 1e-9) << number;
    const test::RodEnd end = test::integrate_kirchhoff(problem, result, first_frame(problem));
    EXPECT_LT(end.apart, 1e-8) << number;
    EXPECT_LT(end.force.norm(), 1e-8) << number;
    EXPECT_LT(end.moment.norm(), 1e-7) << number;
    for (std::size_t g = 1; g < problem.grips.size(); ++g) {
      const Grip& grip = problem.grips[g];
      if (grip.frame) continue;
      const Eigen::Vector3d& torque = result.grips[g].torque;
      const double passes =
          grip.direction ? torque.dot(grip.direction->normalized()) : torque.norm();
      EXPECT_NEAR(passes, 0, 1e-8) << number;
    }
  }
  EXPECT_EQ(solved, count);
}

TEST(ExactNatural, ReactionsAreTheDerivativesOfTheEnergy) {
  Problem problem = curved_rod({0.5, 2, 1});
  problem.natural_strains.emplace_back(0, 0.7, -0.4);
  problem.weight_per_length = {1, -2, -3};
  problem.sections = {{0.5, 0.8, 2, 1.2, {0, -4, 0}}};
  problem.grips.push_back({1, {0.4, 0.1, 0.5}, Eigen::Vector3d(1, 0.2, 0.3), FrameHold{}});
  constexpr double h = 1e-4;
  // The end's frame is prescribed explicitly. Without a given frame it would rotate when the clamp
  // moves.
  const Eigen::Vector3d direction = problem.grips[1].direction->normalized();
  problem.grips[1].frame = FrameHold{direction.unitOrthogonal(), 0};
  const Equilibrium held = test::converged(solve_exact(problem));
  const auto slope = [&](const auto& change) {
    const auto energy = [&](double size) {
      Problem moved = problem;
      change(moved.grips[1], size);
      return solve_exact(moved, {.start = &held}).energy.total();
    };
    return (energy(h) - energy(-h)) / (2 * h);
  };
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const double rate = slope([&](Grip& grip, double size) { grip.position[axis] += size; });
    EXPECT_NEAR(rate, held.grips[1].force[axis], 1e-6);
    const double turned = slope([&](Grip& grip, double size) {
      const Eigen::AngleAxisd turn(size, Eigen::Vector3d::Unit(axis));
      grip.direction = turn * *grip.direction;
      grip.frame->d1 = turn * *grip.frame->d1;
    });
    EXPECT_NEAR(turned, held.grips[1].torque[axis], 1e-6);
  }
  const double rolled = slope([](Grip& grip, double size) { grip.frame->roll += size; });
  EXPECT_NEAR(rolled, held.twists.at(0).torque, 1e-6);
}

TEST(ExactNatural, WhatIsUnstableOfTheStraightRodIsUnstable) {
  Problem upright = heavy_cantilever(120, 90);
  upright.torsional_stiffness = 0.7;
  const std::vector<Equilibrium> straight = all_exact(upright);
  ASSERT_GE(straight.size(), 5U);
  upright.natural_strains = {Eigen::Vector3d::Zero()};
  for (const Equilibrium& shape : straight) {
    const Equilibrium curved = solve_exact(upright, {.start = &shape});
    EXPECT_LT(test::largest_point_distance(shape, curved), 1e-10);
    EXPECT_EQ(shape.status, curved.status);
  }
}

TEST(ExactNatural, UnitsAndPlaceDoNotMatter) {
  const Problem own = random_curved_rod(3);
  const Eigen::AngleAxisd turn(1.1, Eigen::Vector3d(1, 2, 2).normalized());
  const test::Placement other{0.7, 3e-3, turn.toRotationMatrix(), {1, 2, -3}};
  const Equilibrium expected = test::converged(solve_exact(own));
  const Equilibrium result = test::converged(solve_exact(other.of(own)));
  const auto found = other.differences(expected, result);
  EXPECT_LT(found.points, 1e-10);
  EXPECT_LT(found.curvature, 7e-9);
  EXPECT_LT(found.energy, 2e-10);
  EXPECT_LT(std::max(found.force, found.torque), 1e-9);
  EXPECT_NEAR(result.smallest_eigenvalue, expected.smallest_eigenvalue, 1e-6);
}

TEST(ExactNatural, EndsWhenItsTimeIsOver) {
  Problem problem = hanging_rod(6, 20);
  problem.grips.push_back({1, {0.2, -0.3, 0}, Eigen::Vector3d(0, 1, 0), {}});
  for (const double limit : {1e-3, 0.1}) {
    const Equilibrium result = solve_exact(problem, {.time_limit = limit});
    if (limit > 0.01 && result.status == SolveStatus::converged) continue;  // fast enough
    EXPECT_EQ(result.status, SolveStatus::time_limit);
    EXPECT_LT(result.seconds, limit + 0.5);
    if (!result.sample) continue;
    EXPECT_LT(test::balance_of(problem, result, 0.02).worst(), 1e-9);
  }
}

TEST(ExactNatural, RefusesWhatItCannotKnow) {
  Problem lost = curved_rod({0, 2, 0});
  lost.grips[0].frame.reset();
  lost.weight_per_length = {1, 0, 0};
  lost.loads = {{1, {0, 1, 0}}};
  EXPECT_THROW(static_cast<void>(solve_exact(lost)), std::invalid_argument);
  Problem pinned = curved_rod({0, 2, 0});
  pinned.grips = {{0, Eigen::Vector3d::Zero(), {}, {}}, {1, {0.5, 0, 0}, {}, {}}};
  pinned.weight_per_length = {0, -1, 0};
  const Equilibrium found = test::converged(solve_exact(pinned));
  EXPECT_THROW(static_cast<void>(solve_exact(pinned, {.start = &found})), std::invalid_argument);
}

}  // namespace
}  // namespace dlo::energy_model
