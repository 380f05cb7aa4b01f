// Tests of intrinsically curved rods, in the plane and in space, against circles and helices, first
// integrals, published critical weights, the intrinsically straight rod, and Kirchhoff's equations
// integrated along the rod from the reaction of its first clamp.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "base/sized_samples.hpp"
#include "base/spin.hpp"
#include "dlo/energy_model/exact.hpp"
#include "equilibrium_balance.hpp"
#include "kirchhoff/rod_span.hpp"
#include "kirchhoff_rod.hpp"
#include "placement.hpp"
#include "problem/rod_law.hpp"
#include "problems.hpp"
#include "random_problems.hpp"
#include "shooting/second_variation.hpp"
#include "solved.hpp"

namespace dlo::energy_model {
namespace {

using test::heavy_cantilever;

/// A rod of constant strains from the origin, its first frame the axes.
struct FreeHelix {
  Eigen::Vector3d u;

  [[nodiscard]] Eigen::Matrix3d frame(double s) const {
    return Eigen::AngleAxisd(u.norm() * s, u.normalized()).toRotationMatrix();
  }
  [[nodiscard]] Eigen::Vector3d point(double s) const {
    const double w = u.norm();
    const Eigen::Matrix3d hat = test::hat_of(u);
    const Eigen::Matrix3d integral = s * Eigen::Matrix3d::Identity() +
                                     (1 - std::cos(w * s)) / (w * w) * hat +
                                     (s - std::sin(w * s) / w) / (w * w) * hat * hat;
    return integral.col(2);
  }
};

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

TEST(ExactNatural, ACurvatureWithoutLoadIsACircle) {
  constexpr double curvature = 2.5;
  Problem problem = heavy_cantilever(0, 0);
  problem.torsional_stiffness = 1;
  problem.natural_strains = {{0, curvature, 0}};
  const Equilibrium result = test::converged(solve_exact(problem));
  EXPECT_GT(result.smallest_eigenvalue, 0);
  EXPECT_NEAR(result.energy.total(), 0, 1e-20);
  EXPECT_LT(result.grips[0].torque.norm() + result.grips[0].force.norm(), 1e-11);
  const Samples samples = result.sample(equal_arc_lengths(1, 11));
  for (Eigen::Index i = 0; i < 11; ++i) {
    // To the left of a rod along x in the plane whose normal is z.
    const double angle = curvature * samples.arc_length[static_cast<std::size_t>(i)];
    const Eigen::Vector3d expected(std::sin(angle), 1 - std::cos(angle), 0);
    EXPECT_LT((samples.points.col(i) - expected / curvature).norm(), 1e-12);
    EXPECT_NEAR(samples.curvature.col(i).norm(), curvature, 1e-11);
  }
}

TEST(ExactNatural, StrainsWithoutLoadAreAHelix) {
  const FreeHelix helix{{0.6, 2, 1.5}};
  const Equilibrium result = test::converged(solve_exact(curved_rod(helix.u)));
  const Samples samples = result.sample(equal_arc_lengths(1, 11));
  for (Eigen::Index i = 0; i < 11; ++i) {
    const double s = samples.arc_length[static_cast<std::size_t>(i)];
    EXPECT_LT((samples.points.col(i) - helix.point(s)).norm(), 1e-12);
    EXPECT_LT((samples.tangents.col(i) - helix.frame(s).col(2)).norm(), 1e-12);
  }
}

/// int f dtheta from a to b by Gauss-Legendre on panels.
template <class Function>
double quadrature(double a, double b, Function f) {
  constexpr std::array<double, 3> node = {0.238619186083196909, 0.661209386466264514,
                                          0.932469514203152028};
  constexpr std::array<double, 3> weight = {0.467913934572691047, 0.360761573048138608,
                                            0.171324492379170345};
  constexpr int panels = 60;
  double sum = 0;
  for (int p = 0; p < panels; ++p) {
    const double half = (b - a) / panels / 2;
    const double middle = a + (2 * p + 1) * half;
    for (std::size_t k = 0; k < 3; ++k) {
      sum += half * weight[k] * (f(middle - half * node[k]) + f(middle + half * node[k]));
    }
  }
  return sum;
}

TEST(ExactNatural, ATipLoadInThePlaneIsAQuadrature) {
  // (EI kappa0 + m)^2 / 2 + F.t is the same all along and m is zero at the tip: ds = dtheta /
  // kappa.
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

/// A helix of strains u with the force lambda u and the moment mu u + lambda e3 in its frame, which
/// a rod of the natural strains u0 has: K (u - u0) = mu u + lambda e3.
struct KirchhoffHelix {
  FreeHelix helix{{0.4, 2.2, 1.3}};
  double lambda = 3;
  double mu = -0.4;
  double torsion = 0.8;

  [[nodiscard]] Problem problem() const {
    const Eigen::Vector3d stiffness(1, 1, torsion);
    Problem problem = curved_rod(helix.u - own_moment().cwiseQuotient(stiffness), torsion);
    problem.grips.push_back({.at = 1,
                             .position = helix.point(1),
                             .direction = Eigen::Vector3d(helix.frame(1).col(2)),
                             .frame = FrameHold{.d1 = Eigen::Vector3d(helix.frame(1).col(0))}});
    return problem;
  }
  [[nodiscard]] Eigen::Vector3d own_moment() const {
    return mu * helix.u + lambda * Eigen::Vector3d::UnitZ();
  }
  [[nodiscard]] Eigen::Vector3d force() const { return lambda * helix.u; }
  /// Returns the helix as an initial guess with errors.
  [[nodiscard]] Equilibrium shape(double error) const {
    Equilibrium shape;
    shape.grips = {{-force(), -own_moment()}, {force(), helix.frame(1) * own_moment()}};
    shape.grips[0].force.x() += error;
    shape.sample = [*this, error](std::span<const double> arc_lengths) {
      Samples samples = sized_samples(arc_lengths, 1);
      const auto count = static_cast<Eigen::Index>(arc_lengths.size());
      for (Eigen::Index i = 0; i < count; ++i) {
        const double s = arc_lengths[static_cast<std::size_t>(i)];
        samples.points.col(i) = helix.point(s) + error * Eigen::Vector3d(0, std::sin(5 * s), 0);
        samples.tangents.col(i) = helix.frame(s).col(2);
        samples.curvature.col(i) = helix.frame(s) * helix.u.cross(Eigen::Vector3d::UnitZ());
      }
      return samples;
    };
    return shape;
  }
};

TEST(ExactNatural, KirchhoffsHelixIsHeldByItsWrench) {
  const KirchhoffHelix expected;
  const Equilibrium start = expected.shape(0.01);
  const Equilibrium result = solve_exact(expected.problem(), {.start = &start});
  ASSERT_TRUE(result.sample) << result.message;
  for (const double s : {0.0, 0.3, 0.77, 1.0}) {
    EXPECT_LT((test::point_at(result, s) - expected.helix.point(s)).norm(), 1e-11);
  }
  EXPECT_LT((result.grips[1].force - expected.force()).norm(), 1e-9);
  EXPECT_LT((result.grips[0].torque + expected.own_moment()).norm(), 1e-9);
  const Eigen::Vector3d end_moment = expected.helix.frame(1) * expected.own_moment();
  EXPECT_LT((result.grips[1].torque - end_moment).norm(), 1e-9);
  ASSERT_EQ(result.twists.size(), 1U);
  EXPECT_NEAR(result.twists[0].angle, expected.helix.u.z(), 1e-10);
  EXPECT_NEAR(result.twists[0].torque, expected.own_moment().z(), 1e-9);
  // And the search comes no higher.
  const Equilibrium lowest = test::converged(solve_exact(expected.problem()));
  EXPECT_LT(lowest.energy.total(), result.energy.total() + 1e-9);
}

/// The equilibrium of a hanging rod in its plane next to another one.
Equilibrium planar_shape(double curvature, double gamma, const Equilibrium& near) {
  Equilibrium shape = solve_exact(hanging_rod(curvature, gamma), {.start = &near});
  EXPECT_TRUE(shape.sample) << shape.message;
  EXPECT_LT(shape.sample(equal_arc_lengths(1, 9)).points.row(2).cwiseAbs().maxCoeff(), 1e-9);
  return shape;
}

/// Gamma at which the smallest eigenvalue of the planar shape is zero, between two.
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

/// The weights at which the hanging rod leaves its plane and returns to it.
void expect_critical_weights(double curvature, double leaves, double returns) {
  Equilibrium light = solve_exact(hanging_rod(curvature, 0));
  for (double gamma = 4; gamma < leaves; gamma += 4) light = planar_shape(curvature, gamma, light);
  EXPECT_NEAR(critical_gamma(curvature, leaves - 0.5, leaves + 0.5, light), leaves, 1e-6);
  const double above = 1.05 * returns;
  const Equilibrium heavy = test::converged(solve_exact(hanging_rod(curvature, above)));
  EXPECT_NEAR(critical_gamma(curvature, above, 1.03 * returns, heavy), returns, 1e-6);
}

// 8/l and 10/l leave the plane and return to it on different branches.
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
  // Its mirror image is one too.
  Samples mirrored = all[0].sample(s);
  mirrored.points.row(2) *= -1;
  EXPECT_LT((all[1].sample(s).points - mirrored.points).cwiseAbs().maxCoeff(), 1e-10);
}

TEST(ExactNatural, StrainsOfZeroAreTheStraightRod) {
  Problem cantilever = heavy_cantilever(12, 20);
  cantilever.torsional_stiffness = 0.7;
  cantilever.loads = {{0.4, {1, 2, 0}}};
  cantilever.sections = {{0.3, 0.6, 2, 0.4, {0, -20, 0}}};
  const Equilibrium straight = solve_exact(cantilever);
  cantilever.natural_strains = {Eigen::Vector3d::Zero()};
  const Equilibrium curved = test::converged(solve_exact(cantilever));
  EXPECT_LT(test::gap_between(straight, curved), 1e-11);
  EXPECT_NEAR(straight.energy.total(), curved.energy.total(), 1e-11);
  EXPECT_LT((straight.grips[0].torque - curved.grips[0].torque).norm(), 1e-10);

  Problem twisted = test::two_clamps(10, 0.8);
  twisted.torsional_stiffness = 0.7;
  twisted.sections = {{0.3, 0.6, 2, 0.4, {0, -20, 0}}};
  for (Grip& grip : twisted.grips) grip.frame = FrameHold{};
  twisted.grips[0].frame->roll = 0.5;
  twisted.grips[1].frame->roll = 2.5;
  const Equilibrium one = solve_exact(twisted);
  twisted.natural_strains = {Eigen::Vector3d::Zero()};
  const Equilibrium other = test::converged(solve_exact(twisted));
  EXPECT_NEAR(one.energy.total(), other.energy.total(), 1e-10);
  EXPECT_NEAR(one.twists.at(0).torque, other.twists.at(0).torque, 1e-9);
  EXPECT_NEAR(one.twists.at(0).angle, other.twists.at(0).angle, 1e-9);
}

/// Grips that a random curve goes through, natural strains of up to two Legendre terms, sections.
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
    const test::RodEnd end = test::carried_along(problem, result, first_frame(problem));
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
  // The end's frame where it is now, so that it stays when the clamp moves.
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
    EXPECT_LT(test::gap_between(shape, curved), 1e-10);
    EXPECT_EQ(shape.status, curved.status);
  }
}

TEST(ExactNatural, AStraightClampedRodBucklesUnderItsTwist) {
  // tan(M l / 2 EI) = M l / 2 EI without tension (Greenhill).
  constexpr double known = 8.986818916;
  const RodSpan span = uncut(KirchhoffHelix().problem());
  const ClampFrames frames = {Eigen::Matrix3d::Identity(), Eigen::Matrix3d::Identity()};
  const auto smallest = [&](double torque) {
    return second_variation(span, {}, frames, torque * torque,
                            [&](const std::vector<double>& arc) {
                              std::vector<RodState> states(arc.size());
                              for (std::size_t i = 0; i < arc.size(); ++i) {
                                states[i].R = from_rotation_vector({0, 0, torque / 0.8 * arc[i]});
                                states[i].m = {0, 0, torque};
                              }
                              return states;
                            })
        .smallest;
  };
  EXPECT_GT(smallest(known - 1e-6), 0);
  EXPECT_LT(smallest(known + 1e-6), 0);
  EXPECT_NEAR(smallest(known), 0, 1e-7);
}

TEST(ExactNatural, TheOtherWayRoundItIsTheSameRod) {
  Problem problem = curved_rod({0.5, 2, 1});
  problem.natural_strains.emplace_back(-0.3, 0.7, 0.4);
  problem.weight_per_length = {1, -2, -3};
  problem.loads = {{0.3, {1, 1, 0}}};
  problem.sections = {{0.5, 0.8, 2, 1.2, {0, -4, 0}}};
  const Equilibrium one = test::converged(solve_exact(problem));
  // d2 and t point backwards, and so do the strains but for the signs of d2 and t.
  Problem reversed = problem;
  reversed.grips[0].at = 1;
  reversed.grips[0].direction = -*problem.grips[0].direction;
  reversed.loads[0].at = 0.7;
  reversed.sections[0].begin = 0.2;
  reversed.sections[0].end = 0.5;
  const Eigen::Vector3d signs(-1, 1, 1);
  reversed.natural_strains[0] = problem.natural_strains[0].cwiseProduct(signs);
  reversed.natural_strains[1] = -problem.natural_strains[1].cwiseProduct(signs);
  const Equilibrium other = test::converged(solve_exact(reversed));
  const std::vector<double> s = equal_arc_lengths(1, 22);  // none where sections meet
  const std::vector<double> backwards(s.rbegin(), s.rend());
  const Samples a = one.sample(s);
  const Samples b = other.sample(backwards);
  EXPECT_LT((a.points - b.points).cwiseAbs().maxCoeff(), 1e-11);
  EXPECT_LT((a.tangents + b.tangents).cwiseAbs().maxCoeff(), 1e-11);
  EXPECT_LT((a.curvature - b.curvature).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_NEAR(one.energy.total(), other.energy.total(), 1e-11);
  EXPECT_LT((one.grips[0].force - other.grips[0].force).norm(), 1e-10);
  EXPECT_LT((one.grips[0].torque - other.grips[0].torque).norm(), 1e-10);
}

TEST(ExactNatural, AClampInTheMiddleHoldsTwoRods) {
  Problem problem = curved_rod({0.5, 2, 1});
  problem.weight_per_length = {1, -2, -3};
  problem.grips[0].at = 0.4;
  const Equilibrium both = test::converged(solve_exact(problem));
  Problem right = problem;
  right.length = 0.6;
  right.grips[0].at = 0;
  Problem left = problem;
  left.length = 0.4;
  const Equilibrium after = solve_exact(right);
  const Equilibrium before = solve_exact(left);
  const std::vector<double> ends = {0, 1};
  const Samples tips = both.sample(ends);
  EXPECT_LT((tips.points.col(0) - test::point_at(before, 0)).norm(), 1e-11);
  EXPECT_LT((tips.points.col(1) - test::point_at(after, 0.6)).norm(), 1e-11);
  EXPECT_NEAR(both.energy.total(), before.energy.total() + after.energy.total(), 1e-11);
  const Eigen::Vector3d torque = before.grips[0].torque + after.grips[0].torque;
  EXPECT_LT((both.grips[0].torque - torque).norm(), 1e-10);
}

TEST(ExactNatural, UnitsAndPlaceDoNotMatter) {
  const Problem own = random_curved_rod(3);
  const Eigen::AngleAxisd turn(1.1, Eigen::Vector3d(1, 2, 2).normalized());
  const test::Placement other{0.7, 3e-3, turn.toRotationMatrix(), {1, 2, -3}};
  const Equilibrium expected = test::converged(solve_exact(own));
  const Equilibrium result = test::converged(solve_exact(other.of(own)));
  const auto found = other.between(expected, result);
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
