// Tests of moving rods that meet rigid obstacles, against a polygon with another contact law,
// shapes at rest on the obstacles, and the balance of energy.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "dlo/energy_model/dynamics.hpp"
#include "dlo/energy_model/energy.hpp"
#include "problems.hpp"
#include "rigid_polygon.hpp"
#include "solved.hpp"

namespace dlo::energy_model {
namespace {

const obstacle::Body low_floor = obstacle::Body::half_space({0, -0.2, 0}, {0, 1, 0});

MovingRod cantilever_over(double gamma, const obstacle::Body& body) {
  MovingRod rod;
  rod.problem = test::heavy_cantilever(gamma, 0);
  rod.inertia.mass_per_length = 1;
  rod.material_damping = 0.01;
  rod.problem.obstacles = {{body}};
  return rod;
}

/// Arc lengths whose spacing is much smaller than that of the points at which the model evaluates
/// contact.
const std::vector<double> dense_arc_lengths = equal_arc_lengths(1, 4001);

/// Checks what all motions satisfy: no penetration beyond `depth`, losses that never decrease, the
/// energy balance and, for a half-space, contact forces that only push.
void expect_contact(const MovingRod& rod, const Dynamics& result, double depth, double balance) {
  EXPECT_EQ(result.status, SolveStatus::converged) << result.message;
  EXPECT_LE(result.deepest_contact, depth);
  EXPECT_LT(result.energy_error, balance);
  double lost = 0;
  for (const MovingFrame& frame : result.frames) {
    Vector3d moved = Vector3d::Zero();
    if (!rod.obstacle_motions.empty()) {
      moved = rod.obstacle_motions[0](frame.time).position - rod.obstacle_motions[0](0).position;
    }
    const Eigen::Matrix3Xd points = frame.sample(dense_arc_lengths).points.colwise() - moved;
    EXPECT_GE(rod.problem.obstacles[0].body.clearances(points).minCoeff(), -depth) << frame.time;
    EXPECT_GE(frame.energy.lost, lost - 1e-12) << frame.time;
    lost = frame.energy.lost;
    const Vector3d force = frame.obstacles[0];
    if (rod.problem.obstacles[0].body.is_half_space()) {
      EXPECT_GE(force.dot(rod.problem.obstacles[0].body.normal()), 0) << frame.time;
    }
  }
}

Dynamics fall(const MovingRod& rod, const std::vector<double>& times, double depth,
              int terms = 12) {
  return simulate(rod, straight_rod(Vector3d::UnitX()), times,
                  {.terms = terms, .tolerance = 1e-6, .contact_depth = depth});
}

// The polygon's floor consists of springs and dashpots under its points. With 60 points the shapes
// still differ by 2.6e-4.
TEST(RigidContactDynamics, ACantileverFallsOnAFloorAsAPolygon) {
  constexpr double gamma = 10;
  constexpr double depth = 1e-4;
  const std::vector<double> times = equal_times(6, 0.1);
  const MovingRod rod = cantilever_over(gamma, low_floor);
  const Dynamics result = fall(rod, times, depth, 14);
  expect_contact(rod, result, depth, 1e-5);
  EXPECT_GT(result.frames.back().energy.lost, 0.01);
  double before = 0;
  for (const auto& [count, allowed] :
       {std::pair(10, 5e-3), std::pair(20, 1.2e-3), std::pair(40, 3e-4)}) {
    test::RigidPolygon polygon(count, gamma, {.material_damping = 0.01, .floor = -0.2});
    const std::vector<Eigen::Matrix2Xd> shapes = polygon.shapes_at(times);
    double apart = 0;
    for (std::size_t k = 0; k < times.size(); ++k) {
      std::vector<double> at;
      for (Eigen::Index i = 2; i < shapes[k].cols(); ++i) {
        at.push_back(std::min(1.0, polygon.arc_length(i)));
      }
      const Eigen::Matrix2Xd points = result.frames[k].sample(at).points.topRows<2>();
      apart = std::max(apart,
                       (points - shapes[k].rightCols(points.cols())).colwise().norm().maxCoeff());
    }
    EXPECT_LT(apart, allowed) << count;
    if (before > 0) {
      EXPECT_GT(before / apart, 2.5) << count;
    }
    before = apart;
  }
}

TEST(RigidContactDynamics, DampedItComesToRestAsInEquilibrium) {
  const obstacle::Body peg = obstacle::Body::cylinder({0.5, -0.11, 0}, {0, 0, 1}, 0.05);
  // Where a part lies on the floor the curvature has a kink, which takes more terms.
  for (const auto& [body, gamma, terms] :
       {std::tuple(low_floor, 10.0, 12), std::tuple(low_floor, 100.0, 24),
        std::tuple(peg, 2.0, 16)}) {
    MovingRod rod = cantilever_over(gamma, body);
    rod.material_damping = 0.05;
    const Equilibrium rest = test::require_usable(solve_energy(rod.problem));
    ASSERT_GT(rest.obstacles[0].norm(), 0.1 * gamma);
    double before = 0;
    for (const double depth : {1e-3, 1e-4}) {
      const Dynamics result = fall(rod, {0.2, 10}, depth, terms);
      expect_contact(rod, result, depth, 1e-5);
      const MovingFrame& last = result.frames.back();
      EXPECT_LT(last.energy.kinetic, 1e-8);
      const double apart = test::largest_point_distance(last, rest, dense_arc_lengths);
      EXPECT_LT(apart, depth / 2);
      // The position of a force at 0.5 is known to `depth`, so the force has a relative error of 3
      // depth / 0.5.
      const double allowed = 6 * depth * gamma;
      EXPECT_LT((last.obstacles[0] - rest.obstacles[0]).norm(), allowed);
      EXPECT_LT((last.grips[0].force - rest.grips[0].force).norm(), allowed);
      if (before > 0) {
        EXPECT_LT(apart, before / 2);
      }
      before = apart;
    }
  }
}

TEST(RigidContactDynamics, ARodOnAPinFallsOnAFloorAndKeepsItsBalance) {
  MovingRod rod = cantilever_over(20, low_floor);
  rod.problem.grips[0].direction.reset();
  const Dynamics result = fall(rod, equal_times(16, 0.05), 1e-3);
  expect_contact(rod, result, 1e-3, 1e-5);
  EXPECT_GT(result.frames.back().obstacles[0].y(), 1);
  EXPECT_LT(result.frames.back().grips[0].torque.norm(), 1e-8);
}

TEST(RigidContactDynamics, NoPegAndNoEdgeComesBetweenThePointsOfContact) {
  const std::array<obstacle::Body, 3> bodies = {
      obstacle::Body::cylinder({0.7, -0.1, 0}, {0, 0, 1}, 0.005),
      obstacle::Body::cylinder({0.4, -0.1, 0.05}, {0.3, 0, 1}, 0.05),
      obstacle::Body::box({0.6, -0.5, 0}, Eigen::Matrix3d::Identity(), {0.1, 0.8, 1}, 0.002)};
  for (const obstacle::Body& body : bodies) {
    const MovingRod rod = cantilever_over(10, body);
    const Dynamics result = fall(rod, equal_times(4, 0.1), 1e-3);
    expect_contact(rod, result, 2e-3, 1e-5);
    EXPECT_GT(result.frames.back().energy.lost, 1e-4);
  }
}

// The work of a floor that rises slowly equals the increase of the energy of the rod at rest, to
// 2 %.
TEST(RigidContactDynamics, AFloorThatRisesDoesWork) {
  MovingRod rod = cantilever_over(10, low_floor);
  rod.material_damping = 0.05;
  const Equilibrium low = solve_energy(rod.problem);
  MovingRod higher = rod;
  higher.problem.obstacles = {{obstacle::Body::half_space({0, -0.1, 0}, {0, 1, 0})}};
  const Equilibrium high = solve_energy(higher.problem);
  const double expected = high.energy.total() - low.energy.total();
  ASSERT_GT(expected, 0.05);
  double before = 0;
  for (const double takes : {20.0, 80.0}) {
    rod.obstacle_motions = {moving(Vector3d::Zero(), Vector3d::UnitY(), smooth_step(0, takes, 0.1),
                                   Vector3d::UnitZ(), {})};
    const Dynamics result = simulate(rod, low.sample, std::vector<double>{takes / 2, takes + 1},
                                     {.tolerance = 1e-6, .contact_depth = 1e-4});
    expect_contact(rod, result, 1e-4, 1e-5);
    const double missed = std::abs(result.frames.back().energy.work / expected - 1);
    EXPECT_LT(missed, 0.02);
    if (before > 0) {
      EXPECT_LT(missed, before);
    }
    before = missed;
  }
}

// The obstacle rotates by 0.5 rad within a second, about a point 0.1 below the clamp.
TEST(RigidContactDynamics, AnObstacleThatTurnsCarriesTheRod) {
  const obstacle::Body bar =
      obstacle::Body::box({0.5, -0.1, 0}, Eigen::Matrix3d::Identity(), {0.8, 0.1, 1}, 0.02);
  MovingRod rod = cantilever_over(1, bar);
  rod.problem.weight_per_length.setZero();
  rod.obstacle_motions = {
      moving({0, -0.1, 0}, Vector3d::UnitX(), {}, Vector3d::UnitZ(), smooth_step(0, 1, 0.5))};
  const Dynamics result = test::converged(fall(rod, {0.5, 1, 1.5}, 1e-3));
  EXPECT_LT(result.energy_error, 1e-5);
  EXPECT_LE(result.deepest_contact, 1e-3);
  const Eigen::AngleAxisd turn(0.5, Vector3d::UnitZ());
  const Vector3d pivot(0, -0.1, 0);
  Eigen::Matrix3Xd points = result.frames.back().sample(dense_arc_lengths).points.colwise() - pivot;
  points = (turn.inverse().toRotationMatrix() * points).colwise() + pivot;
  EXPECT_GE(bar.clearances(points).minCoeff(), -2e-3);
  EXPECT_GT(result.frames.back().energy.work, 0.05);
}

TEST(RigidContactDynamics, RefusesARodThatBeginsWithinAnObstacle) {
  const MovingRod rod = cantilever_over(1, obstacle::Body::half_space({0, 0.1, 0}, {0, 1, 0}));
  const Dynamics result = fall(rod, {0.1}, 1e-3);
  EXPECT_EQ(result.status, SolveStatus::failed);
  EXPECT_NE(result.message.find("begins within a rigid obstacle"), std::string::npos)
      << result.message;
  MovingRod more = cantilever_over(1, low_floor);
  more.obstacle_motions.resize(2);
  EXPECT_THROW((void)fall(more, {0.1}, 1e-3), std::invalid_argument);
  EXPECT_THROW((void)fall(cantilever_over(1, low_floor), {0.1}, 0), std::invalid_argument);
}

}  // namespace
}  // namespace dlo::energy_model
