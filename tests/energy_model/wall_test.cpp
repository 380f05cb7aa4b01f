// Rods on walls.

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <string>

#include "dlo/energy_model/energy.hpp"
#include "problems.hpp"

namespace dlo::energy_model {
namespace {

using test::heavy_cantilever;

/// A rod held horizontally above a floor, worked out from its shear force alone. Where it lies it
/// is straight and its weight is carried on the spot; up to the touch-down at s = b it hangs free:
///     theta'' = (w (b - s) - R) cos(theta),  theta = theta' = 0 at s = b,
/// R the floor's force at the touch-down. b and R follow from theta(0) = 0 and the height.
class LyingRod {
 public:
  LyingRod(double gamma, double height) : gamma_(gamma) {
    Eigen::Vector2d unknown(std::min(0.9, std::pow(72 * height / gamma, 0.25)), 0);
    unknown[1] = gamma * unknown[0] / 3;  // both from the linear theory
    for (int step = 0; step < 50; ++step) {
      const Eigen::Vector2d miss = shoot(unknown, height);
      Eigen::Matrix2d jacobian;
      for (int k = 0; k < 2; ++k) {
        Eigen::Vector2d moved = unknown;
        const double h = 1e-6 * unknown[k];
        moved[k] += h;
        jacobian.col(k) = (shoot(moved, height) - miss) / h;
      }
      unknown -= jacobian.partialPivLu().solve(miss);
    }
    b = unknown[0];
    R = unknown[1];
    const Eigen::Vector2d miss = shoot(unknown, height);
    residual = miss.norm();
    tip = width_ + 1 - b;
  }

  double b = 0, R = 0, tip = 0, residual = 0;

 private:
  /// Angle and height missed at the clamp; Runge-Kutta 4 backwards from the touch-down.
  Eigen::Vector2d shoot(const Eigen::Vector2d& unknown, double height) {
    using State = Eigen::Array4d;  // theta, theta', x, y
    const auto rate = [&](double back, const State& z) {
      return State(-z[1], -(gamma_ * back - unknown[1]) * std::cos(z[0]), -std::cos(z[0]),
                   -std::sin(z[0]));
    };
    State z = State::Zero();
    const int steps = 2000;
    const double h = unknown[0] / steps;
    for (int i = 0; i < steps; ++i) {
      const double t = i * h;
      const State k1 = rate(t, z);
      const State k2 = rate(t + h / 2, z + h / 2 * k1);
      const State k3 = rate(t + h / 2, z + h / 2 * k2);
      const State k4 = rate(t + h, z + h * k3);
      z += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    }
    width_ = -z[2];
    return {z[0], z[3] - height};
  }

  double gamma_;
  double width_ = 0;
};

TEST(Wall, CarriesALyingRodAsTheElasticaSays) {
  for (const double gamma : {50.0, 200.0, 1000.0}) {
    const double height = 0.1;
    const LyingRod exact(gamma, height);
    ASSERT_LT(exact.residual, 1e-10);
    Problem problem = heavy_cantilever(gamma, 0);
    problem.walls = {{.point = {0, -height, 0}, .normal = {0, 1, 0}}};
    const Equilibrium result = solve_energy(problem);
    ASSERT_EQ(result.status, SolveStatus::converged) << result.message;
    const std::vector<double> s = equal_arc_lengths(1, 201);
    const Samples shape = result.sample(s);
    EXPECT_NEAR(shape.points(0, 200), exact.tip, 1e-4) << "Gamma " << gamma;
    EXPECT_LE(result.penetration, allowed_penetration) << "Gamma " << gamma;
    const double carried = exact.R + gamma * (1 - exact.b);
    EXPECT_NEAR(result.walls[0].y(), carried, 1e-3 * gamma) << "Gamma " << gamma;
  }
}

/// How deep a shape is behind a floor, on a grid of its own.
double depth_behind(const Equilibrium& shape, double floor) {
  return std::max(0.0, floor - shape.sample(equal_arc_lengths(1, 7919)).points.row(1).minCoeff());
}

TEST(Wall, ConvergedMeansNoDeeperThanAllowedAndElseItIsNotResolved) {
  int converged = 0;
  int unresolved = 0;
  for (const double gamma : {20.0, 50.0, 200.0}) {
    for (const double floor : {-0.1, -0.3, -0.5}) {
      Problem problem = heavy_cantilever(gamma, 0);
      problem.walls = {{.point = {0, floor, 0}, .normal = {0, 1, 0}}};
      const Equilibrium result = solve_energy(problem);
      const bool refused =
          result.status == SolveStatus::failed || result.status == SolveStatus::saddle;
      if (refused) continue;  // and says so
      const double depth = depth_behind(result, floor);
      EXPECT_NEAR(result.penetration, depth, 1e-6) << "Gamma " << gamma << ", floor " << floor;
      if (result.status == SolveStatus::converged) {
        ++converged;
        EXPECT_LE(depth, allowed_penetration + 1e-6);
      } else {
        ++unresolved;
        EXPECT_EQ(result.status, SolveStatus::not_resolved) << result.message;
        EXPECT_NE(result.message.find("behind a rigid wall"), std::string::npos) << result.message;
        EXPECT_GT(depth, allowed_penetration - 1e-6);
      }
    }
  }
  EXPECT_GT(converged, 0);
  // A tip that touches sinks in; once contact is solved this is zero.
  EXPECT_GT(unresolved, 0);
}

TEST(Wall, ForceOfATouchingTipIsReportedAndASoftWallIsNear) {
  Problem problem = heavy_cantilever(20, 0);
  problem.walls = {{.point = {0, -0.3, 0}, .normal = {0, 1, 0}}};
  const Equilibrium rigid = solve_energy(problem);
  const std::vector<double> s = equal_arc_lengths(1, 101);
  EXPECT_GT(rigid.walls[0].y(), 0.5);
  EXPECT_NEAR(rigid.walls[0].y() + rigid.grips[0].force.y(), 20, 1e-6);
  problem.walls[0].stiffness = 1e4;
  const Equilibrium soft = solve_energy(problem);
  ASSERT_EQ(soft.status, SolveStatus::converged) << soft.message;
  EXPECT_EQ(soft.penetration, 0);  // only a rigid wall is penetrated, a soft one yields
  EXPECT_LT((soft.sample(s).points - rigid.sample(s).points).colwise().norm().maxCoeff(), 0.02);
}

// A search that is out of time returns what it has, wherever it was.
TEST(Wall, EndsWithNumbersWheneverTheTimeEnds) {
  Problem problem;
  problem.length = 1;
  problem.bending_stiffness = 1;
  problem.weight_per_length = {0, -2, 0};
  problem.grips = {{0, {0, 0.03, 0}, Eigen::Vector3d(-0.33, -0.94, 0).normalized()},
                   {1, {0.48, 0.18, 0}, Eigen::Vector3d(0.8, 0.6, 0).normalized()}};
  problem.walls = {{}};
  for (double limit = 1e-6; limit < 0.3; limit *= 1.4) {
    const Equilibrium result = solve_energy(problem, {.time_limit = limit});
    for (const Reaction& grip : result.grips) {
      EXPECT_TRUE(grip.force.allFinite() && grip.torque.allFinite()) << limit;
    }
  }
}

TEST(Wall, OutOfReachChangesNothing) {
  Problem problem = heavy_cantilever(20, 0);
  problem.walls = {{.point = {0, -2, 0}, .normal = {0, 1, 0}}};
  const std::vector<double> s = equal_arc_lengths(1, 101);
  const Equilibrium free = solve_energy(problem);
  ASSERT_EQ(free.status, SolveStatus::converged) << free.message;
  EXPECT_EQ(free.penetration, 0);
  const Equilibrium without = solve_energy(heavy_cantilever(20, 0));
  EXPECT_LT((free.sample(s).points - without.sample(s).points).norm(), 1e-9);
  EXPECT_EQ(free.walls[0].norm(), 0);
}

}  // namespace
}  // namespace dlo::energy_model
