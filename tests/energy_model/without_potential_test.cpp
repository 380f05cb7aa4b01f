// Tests of loads without a potential: couples in space, loads that follow the rod, and drag.
// References are closed forms and independent integrations.

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include "base/spin.hpp"
#include "dlo/energy_model/drag.hpp"
#include "dlo/energy_model/energy.hpp"
#include "dlo/energy_model/exact.hpp"
#include "dlo/energy_model/vibrations.hpp"
#include "kirchhoff/rod_mesh.hpp"
#include "kirchhoff/rod_span.hpp"
#include "problems.hpp"
#include "random_problems.hpp"
#include "runge_kutta.hpp"
#include "shooting/shooting_system.hpp"
#include "solved.hpp"

namespace dlo::energy_model {
namespace {

/// A rod of unit length and stiffnesses about d1, d2 and t, as this file integrates it.
struct TipRod {
  Eigen::Vector3d stiffness = {1, 1, 1};
  Eigen::Vector3d weight = Eigen::Vector3d::Zero();
  std::function<Eigen::Vector3d(const Eigen::Vector3d& t)> on_tangent;  // per length; none: empty
};

/// Cross-section: r, R by columns, m, n.
using TipState = Eigen::Matrix<double, 18, 1>;

TipState tip_state(const Eigen::Matrix3d& R, const Eigen::Vector3d& m, const Eigen::Vector3d& n) {
  TipState y;
  y << Eigen::Vector3d::Zero(), R.col(0), R.col(1), R.col(2), m, n;
  return y;
}

TipState tip_rates(const TipRod& rod, const TipState& y) {
  Eigen::Matrix3d R;
  R << y.segment<3>(3), y.segment<3>(6), y.segment<3>(9);
  const Eigen::Vector3d m = y.segment<3>(12);
  const Eigen::Vector3d n = y.segment<3>(15);
  const Eigen::Vector3d t = R.col(2);
  const Eigen::Vector3d omega = R * (R.transpose() * m).cwiseQuotient(rod.stiffness);
  TipState rate;
  rate << t, omega.cross(Eigen::Vector3d(R.col(0))), omega.cross(Eigen::Vector3d(R.col(1))),
      omega.cross(t), n.cross(t), -rod.weight;
  if (rod.on_tangent) rate.tail<3>() -= rod.on_tangent(t);
  return rate;
}

/// Runge and Kutta's classical method from the tip to the clamp.
TipState integrated_to_clamp(const TipRod& rod, TipState y, int steps = 2000) {
  const double h = -1.0 / steps;
  const auto rates = [&rod](double, const TipState& at) { return tip_rates(rod, at); };
  for (int i = 0; i < steps; ++i) y = test::runge_kutta(rates, 1 + i * h, y, h);
  return y;
}

Eigen::Matrix3d frame_at(const TipState& y) {
  Eigen::Matrix3d R;
  R << y.segment<3>(3), y.segment<3>(6), y.segment<3>(9);
  return R;
}

/// Returns the tip of a weightless rod that is clamped at the origin with a frame, under a tip load
/// given in the axes of the tip. The rod is integrated in those axes and then rotated to the
/// clamp's frame.
Eigen::Vector3d tip_under_follower_load(const TipRod& rod, const Eigen::Matrix3d& clamp,
                                        const Eigen::Vector3d& force,
                                        const Eigen::Vector3d& torque) {
  const TipState y =
      integrated_to_clamp(rod, tip_state(Eigen::Matrix3d::Identity(), torque, force));
  return clamp * frame_at(y).transpose() * -y.head<3>();
}

/// Returns the tip under loads on the tangent, by Newton's method on the direction of the tip.
Eigen::Vector3d tip_under_drag(const TipRod& rod, const Eigen::Vector3d& direction,
                               Eigen::Vector3d tangent) {
  const auto reached = [&](const Eigen::Vector3d& t) {
    Eigen::Matrix3d R;
    R << t.unitOrthogonal(), t.cross(t.unitOrthogonal()), t;
    return integrated_to_clamp(rod, tip_state(R, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()));
  };
  for (int iteration = 0; iteration < 12; ++iteration) {
    const std::array<Eigen::Vector3d, 2> across = {tangent.unitOrthogonal(),
                                                   tangent.cross(tangent.unitOrthogonal())};
    const Eigen::Vector3d missed = reached(tangent).segment<3>(9) - direction;
    if (missed.norm() < 1e-13) break;
    Eigen::Matrix<double, 3, 2> by;
    constexpr double h = 1e-6;
    for (Eigen::Index k = 0; k < 2; ++k) {
      const Eigen::Vector3d e = h * across[static_cast<std::size_t>(k)];
      by.col(k) = (reached((tangent + e).normalized()) - reached((tangent - e).normalized()))
                      .segment<3>(9) /
                  (2 * h);
    }
    const Eigen::Vector2d step = -by.colPivHouseholderQr().solve(missed);
    tangent = (tangent + step[0] * across[0] + step[1] * across[1]).normalized();
  }
  return -reached(tangent).head<3>();
}

Eigen::Vector3d tip_tangent_of(const Equilibrium& shape) {
  return test::sample_at(shape, 1).tangents.col(0);
}

Problem cantilever_along(const Eigen::Vector3d& direction) {
  Problem problem = heavy_cantilever(0, 0);
  problem.grips[0].direction = direction.normalized();
  return problem;
}

void expect_balance_alone(const Equilibrium& shape) {
  ASSERT_EQ(shape.status, SolveStatus::not_verified) << shape.message;
  EXPECT_NE(shape.message.find("not judged"), std::string::npos) << shape.message;
  EXPECT_TRUE(std::isnan(shape.smallest_eigenvalue));
  EXPECT_LT(shape.residual, 1e-10);
}

TEST(WithoutPotential, DragHasTheDerivativeOfItsForce) {
  RandomNumbers random(1);
  for (int i = 0; i < 20; ++i) {
    const Drag drag{2 * random.direction(test::RandomSpace::space), random.uniform(0, 3),
                    random.uniform(0, 1)};
    const Eigen::Vector3d t = random.direction(test::RandomSpace::space);
    constexpr double h = 1e-6;
    for (const Eigen::Vector3d& across : {t.unitOrthogonal(), t.cross(t.unitOrthogonal()).eval()}) {
      const Eigen::Vector3d apart =
          drag.force((t + h * across).normalized()) - drag.force((t - h * across).normalized());
      EXPECT_LT((drag.by_tangent(t) * across - apart / (2 * h)).norm(), 1e-8);
    }
    EXPECT_LE(drag.force(t).norm(), drag.largest());
  }
  const Drag along{{2, 0, 0}, 1, 0.5};
  EXPECT_EQ(along.force({1, 0, 0}), Eigen::Vector3d(2, 0, 0));
  EXPECT_TRUE(along.by_tangent({1, 0, 0}).allFinite());
  EXPECT_EQ(along.force({0, 1, 0}), Eigen::Vector3d(4, 0, 0));
}

TEST(WithoutPotential, ShootingHasTheDerivativesOfItsEquations) {
  Problem problem = heavy_cantilever(3, 20);
  problem.torsional_stiffness = 0.7;
  problem.bending_stiffness_2 = 1.6;
  problem.drag = Drag{{1, 0.4, -0.8}, 2, 0.6};
  problem.loads = {{0.4, {1, -2, 0.5}, {0.3, 0.2, -0.4}, true},
                   {1, {0.7, 0.1, 2}, {-0.5, 0.4, 0.3}, true}};
  for (const bool held_inside : {false, true}) {
    if (held_inside) {  // so that the begin is free, under a load too
      problem.grips[0].at = 0.6;
      problem.loads.push_back({0, {0.5, 1, 0.5}, {0.3, -0.6, 0.4}, true});
    }
    problem.grips[0].frame = FrameHold{.d1 = Eigen::Vector3d(0.3, 1, 0.4)};
    const RodSpan span = whole_span_with_axes(problem);
    const RodMesh mesh = make_mesh(span, 0.25);
    RandomNumbers random(7);
    std::vector<RodState> nodes;
    for (Eigen::Index i = 0; i < mesh.s.size(); ++i) {
      RodState node;
      node.r = {mesh.s[i], 0.1 * random.uniform(-1, 1), 0.1 * random.uniform(-1, 1)};
      node.R =
          from_rotation_vector(0.3 * random.direction(test::RandomSpace::space)) * span.first_frame;
      node.m = random.direction(test::RandomSpace::space);
      node.n = 2 * random.direction(test::RandomSpace::space);
      nodes.push_back(node);
    }
    const ShootingSystem system(span, mesh, released_frames(span), {}, nodes);
    Eigen::VectorXd equations;
    Triplets triplets;
    ASSERT_TRUE(system.evaluate(system.start(), equations, &triplets));
    Eigen::MatrixXd derivatives = Eigen::MatrixXd::Zero(system.equations(), system.unknowns());
    for (const auto& entry : triplets) derivatives(entry.row(), entry.col()) += entry.value();
    constexpr double h = 1e-5;
    for (Eigen::Index k = 0; k < system.unknowns(); ++k) {
      Eigen::VectorXd ahead;
      Eigen::VectorXd behind;
      const Eigen::VectorXd step = h * Eigen::VectorXd::Unit(system.unknowns(), k);
      ASSERT_TRUE(system.evaluate(system.moved(system.start(), step), ahead, nullptr));
      ASSERT_TRUE(system.evaluate(system.moved(system.start(), -step), behind, nullptr));
      EXPECT_LT(((ahead - behind) / (2 * h) - derivatives.col(k)).cwiseAbs().maxCoeff(), 2e-8) << k;
    }
  }
}

TEST(WithoutPotential, ACoupleAcrossAClampInAnyPlaneRollsTheRodUp) {
  const Eigen::Vector3d direction = Eigen::Vector3d(1, -2, 0.5).normalized();
  const Eigen::Vector3d axis = direction.cross(Eigen::Vector3d(0.3, 0.2, 1)).normalized();
  for (const double lambda : {0.8, 2.0}) {
    Problem problem = cantilever_along(direction);
    problem.loads = {{1, {0, 0, 0}, lambda * pi * axis}};
    const Equilibrium result = test::require_usable(solve_exact(problem));
    const double angle = lambda * pi;
    const Eigen::Vector3d expected =
        std::sin(angle) / angle * direction + (1 - std::cos(angle)) / angle * axis.cross(direction);
    EXPECT_LT((test::point_at(result, 1) - expected).norm(), 1e-11);
    // A couple that follows the section is equal to this dead couple, because its axis does not
    // rotate.
    problem.loads = {{1, {0, 0, 0}, {0, angle, 0}, true}};
    problem.grips[0].frame = FrameHold{.d1 = axis.cross(direction)};
    problem.torsional_stiffness = 0.8;
    const Equilibrium follows = solve_exact(problem);
    // d2 = t x d1 = t x (axis x t) = axis
    expect_balance_alone(follows);
    EXPECT_LT((test::point_at(follows, 1) - expected).norm(), 1e-10);
    EXPECT_LT((follows.grips[0].torque + angle * axis).norm(), 1e-9);
  }
}

TEST(WithoutPotential, AnObliqueCoupleWindsTheRodIntoAHelix) {
  // Without forces m is the couple everywhere, and t turns about it at the rate |m|.
  const Eigen::Vector3d direction = Eigen::Vector3d(1, 0.3, -0.4).normalized();
  Problem problem = cantilever_along(direction);
  // A helix alone lies in no plane: two couples about different axes.
  const Eigen::Vector3d first(6, -3, 4);
  const Eigen::Vector3d last(-2, 5, 7);
  problem.loads = {{0.35, {0, 0, 0}, first}, {1, {0, 0, 0}, last}};
  const Equilibrium result = solve_exact(problem);
  expect_balance_alone(result);
  const auto rotated_along = [](const Eigen::Vector3d& m, double s) {
    return Eigen::AngleAxisd(s * m.norm(), m.normalized()).toRotationMatrix();
  };
  // int of the rotation about e: s e e^T + sin/|m| (1 - e e^T) + (1 - cos)/|m| e x
  const auto integral = [](const Eigen::Vector3d& m, double s, const Eigen::Vector3d& t) {
    const Eigen::Vector3d e = m.normalized();
    const double w = m.norm();
    const Eigen::Vector3d along = e.dot(t) * e;
    return Eigen::Vector3d(s * along + std::sin(s * w) / w * (t - along) +
                           (1 - std::cos(s * w)) / w * e.cross(t));
  };
  const Eigen::Vector3d m = first + last;
  const Eigen::Vector3d middle = integral(m, 0.35, direction);
  const Eigen::Vector3d t = rotated_along(m, 0.35) * direction;
  EXPECT_LT((test::point_at(result, 0.35) - middle).norm(), 1e-10);
  EXPECT_LT((test::point_at(result, 1) - middle - integral(last, 0.65, t)).norm(), 1e-10);
  EXPECT_LT((result.grips[0].torque + m).norm(), 1e-9);
}

TEST(WithoutPotential, LoadsThatFollowInSpaceTwistAndBendEveryRod) {
  const Eigen::Vector3d force(1.5, -2, 0.7);
  const Eigen::Vector3d torque(0.4, 0.9, -1.1);
  const Eigen::Vector3d direction = Eigen::Vector3d(0.2, 1, -0.7).normalized();
  for (const double second : {1.0, 2.5}) {
    Problem problem = cantilever_along(direction);
    problem.torsional_stiffness = 0.6;
    if (second != 1) problem.bending_stiffness_2 = second;
    problem.grips[0].frame = FrameHold{.d1 = Eigen::Vector3d(1, 0.1, 0.3), .roll = 0.4};
    problem.loads = {{1, force, torque, true}};
    const Equilibrium result = solve_exact(problem);
    expect_balance_alone(result);
    const Eigen::Matrix3d clamp = rolled(frame_along(direction, Eigen::Vector3d(1, 0.1, 0.3)), 0.4);
    const TipRod rod{{1, second, 0.6}, Eigen::Vector3d::Zero(), {}};
    EXPECT_LT(
        (test::point_at(result, 1) - tip_under_follower_load(rod, clamp, force, torque)).norm(),
        1e-9);
    // The result is found again from itself as the initial guess, with fewer evaluations.
    const Equilibrium again = solve_exact(problem, {.start = &result});
    expect_balance_alone(again);
    EXPECT_LT((test::point_at(again, 1) - test::point_at(result, 1)).norm(), 1e-9);
    EXPECT_LT(again.evaluations, result.evaluations);
  }
}

TEST(WithoutPotential, DragAlongAndAcrossWithWeightIsThatOfAnIntegrationFromTheTip) {
  const Eigen::Vector3d direction = Eigen::Vector3d(1, 0.5, 0.2).normalized();
  for (const Eigen::Vector3d& velocity :
       {Eigen::Vector3d(1.5, 0, 0), Eigen::Vector3d(-1, 0.5, 2)}) {
    const Drag drag{velocity, 2.5, 0.8};
    Problem problem = cantilever_along(direction);
    problem.weight_per_length = {0, -4, 0};
    problem.drag = drag;
    const Equilibrium result = solve_exact(problem);
    expect_balance_alone(result);
    const TipRod rod{
        {1, 1, 1}, {0, -4, 0}, [&](const Eigen::Vector3d& t) { return drag.force(t); }};
    const Eigen::Vector3d expected = tip_under_drag(rod, direction, tip_tangent_of(result));
    EXPECT_LT((test::point_at(result, 1) - expected).norm(), 1e-9);
  }
}

TEST(WithoutPotential, DirectorsStayWhereThePlaneWithAllLoadsSays) {
  // Only the stream determines that d2 is along y: the strip bends about it.
  Problem problem = cantilever_along({1, 0, 0});
  problem.torsional_stiffness = 0.6;
  problem.bending_stiffness_2 = 3;
  problem.drag = Drag{{0, 0, -1.5}, 2, 0};
  const Equilibrium result = solve_exact(problem);
  expect_balance_alone(result);
  const TipRod rod{
      {3, 3, 3}, {0, 0, 0}, [&](const Eigen::Vector3d& t) { return problem.drag->force(t); }};
  const Eigen::Vector3d expected = tip_under_drag(rod, {1, 0, 0}, tip_tangent_of(result));
  EXPECT_LT((test::point_at(result, 1) - expected).norm(), 1e-9);
}

TEST(WithoutPotential, ALineOnPinsInACurrentBalances) {
  Problem problem = two_clamps(10, 0.8);
  for (Grip& grip : problem.grips) grip.direction.reset();
  problem.drag = Drag{{0.5, 0, 2}, 1.5, 0.3};
  const Equilibrium result = solve_exact(problem);
  expect_balance_alone(result);
  // int f ds by Simpson's rule on the shape.
  const std::vector<double> s = equal_arc_lengths(1, 401);
  const Eigen::Matrix3Xd t = result.sample(s).tangents;
  Eigen::Vector3d sum(0, -10, 0);
  for (Eigen::Index i = 0; i < t.cols(); ++i) {
    const double weight = (i == 0 || i == 400) ? 1 : (i % 2 == 1 ? 4 : 2);
    sum += weight / 1200 * problem.drag->force(t.col(i));
  }
  EXPECT_LT((sum + result.grips[0].force + result.grips[1].force).norm(), 1e-8);
  EXPECT_GT(test::point_at(result, 0.5).z(), 0.05);
  EXPECT_LT((test::point_at(result, 1) - Eigen::Vector3d(0.8, 0, 0)).norm(), 1e-9);
}

TEST(WithoutPotential, DragThatIsNothingChangesNothing) {
  const Problem problem = heavy_cantilever(5, 30);
  Problem still = problem;
  still.drag = Drag{{0, 0, 0}, 1, 1};
  EXPECT_LT(
      (test::point_at(solve_exact(problem), 1) - test::point_at(solve_exact(still), 1)).norm(),
      1e-10);
  still.loads = {{1, {0, 0, 0}, {0, 0, 0}, true}};
  still.drag.reset();
  EXPECT_LT(
      (test::point_at(solve_exact(problem), 1) - test::point_at(solve_exact(still), 1)).norm(),
      1e-10);
}

TEST(WithoutPotential, WhatNeedsAPotentialRefusesThem) {
  Problem dragged = heavy_cantilever(1, 0);
  dragged.drag = Drag{{1, 0, 0}, 1, 0};
  EXPECT_FALSE(has_potential(dragged));
  EXPECT_THROW((void)solve_energy(dragged), std::invalid_argument);
  Problem following = heavy_cantilever(1, 0);
  following.loads = {{1, {1, 0, 0}, {0, 0, 0}, true}};
  EXPECT_FALSE(has_potential(following));
  EXPECT_THROW((void)solve_energy(following), std::invalid_argument);
  const Equilibrium rest = solve_energy(heavy_cantilever(1, 0));
  for (const Problem& problem : {dragged, following}) {
    EXPECT_THROW((void)vibrations(problem, {.mass_per_length = 1}, rest), std::invalid_argument);
  }
  following.loads[0].at = 0;
  EXPECT_THROW((void)solve_exact(following), std::invalid_argument);
  following.loads[0] = {1, {0, 1, 0}, {0, 0, 0}, true};  // along d2, out of the plane: no GJ
  EXPECT_THROW((void)solve_exact(following), std::invalid_argument);
  dragged.obstacles = {{obstacle::Body::half_space({0, -1, 0}, Eigen::Vector3d::UnitY())}};
  EXPECT_THROW((void)solve_exact(dragged), std::invalid_argument);
}

}  // namespace
}  // namespace dlo::energy_model
