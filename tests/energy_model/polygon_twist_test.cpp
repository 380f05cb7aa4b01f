// Tests of the twist of polygons between segments that hold the rod's frame.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>
#include <vector>

#include "../differences.hpp"
#include "dlo/energy_model/energy.hpp"
#include "dlo/energy_model/polygon.hpp"
#include "dlo/energy_model/turns.hpp"
#include "polygon/polygon_energy.hpp"
#include "solved.hpp"

namespace dlo::energy_model {
namespace {

/// A rod of unit length and rigidity, GJ = 0.8, under its weight between two clamps that are turned
/// against each other in space.
struct SpatialRod {
  double gamma = 10;
  double roll = 0;
  double GJ = 0.8;
  Eigen::Vector3d first_direction = Eigen::Vector3d(1, 0.3, 0).normalized();
  Eigen::Vector3d last_position = {0.75, 0.1, 0.1};
  Eigen::Vector3d last_direction = Eigen::Vector3d(1, 0, 0.4).normalized();

  [[nodiscard]] Problem rod() const {
    Problem problem;
    problem.length = 1;
    problem.bending_stiffness = 1;
    problem.torsional_stiffness = GJ;
    problem.weight_per_length = {0, -gamma, 0};
    problem.grips = {{0, Eigen::Vector3d::Zero(), first_direction, FrameHold{}},
                     {1, last_position, last_direction, FrameHold{{}, roll}}};
    return problem;
  }

  /// Clamps hold the middles of the end segments.
  [[nodiscard]] PolygonProblem polygon(Eigen::Index points, double stretch_stiffness) const {
    PolygonProblem problem;
    const double L = 1.0 / static_cast<double>(points - 2);
    problem.rest_lengths = Eigen::VectorXd::Constant(points - 1, L);
    problem.stretch_stiffness = stretch_stiffness;
    problem.node_forces.setZero(3, points);
    problem.node_forces.row(1).segment(1, points - 2).setConstant(-gamma * L);
    problem.stiffness = 1;
    problem.held = {{0, -L / 2 * first_direction},
                    {1, L / 2 * first_direction},
                    {points - 2, last_position - L / 2 * last_direction},
                    {points - 1, last_position + L / 2 * last_direction}};
    return problem;
  }

  [[nodiscard]] static std::vector<double> arc_lengths(Eigen::Index points) {
    std::vector<double> s;
    for (Eigen::Index i = 0; i < points; ++i) {
      s.push_back(
          std::clamp((static_cast<double>(i) - 0.5) / static_cast<double>(points - 2), 0.0, 1.0));
    }
    return s;
  }

  /// Returns the twist that the clamps' frames cause in a polygon that is at rest without twist.
  [[nodiscard]] PolygonTwist twist(const Eigen::Matrix3Xd& rest) const {
    PolygonTwist result;
    result.last_segment = rest.cols() - 2;
    const Problem held = rod();
    result.first_d1 = held_d1(held, held.grips[0]);
    result.last_d1 = held_d1(held, held.grips[1]);
    result.compliance = 1 / GJ;
    // The twist is the roll plus the angle, within half a turn, from the transported first frame to
    // the last one.
    result.angle = polygon_twist_angle(result, rest) + roll;
    result.last_d1 = Eigen::AngleAxisd(roll, last_direction) * result.last_d1;
    return result;
  }
};

PolygonProblem random_problem(Eigen::Matrix3Xd& points) {
  constexpr Eigen::Index count = 9;
  PolygonProblem problem = SpatialRod().polygon(count, 50);
  std::mt19937 engine(7);
  std::uniform_real_distribution<double> uniform(-0.06, 0.06);
  points.resize(3, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    points.col(i) << 0.12 * static_cast<double>(i), uniform(engine), uniform(engine);
  }
  for (const HeldPoint& held : problem.held) points.col(held.point) = held.position;
  problem.rest_lengths[3] *= 1.3;
  problem.held.push_back({4, points.col(4)});
  problem.held.push_back({5, points.col(5)});
  problem.twists = {{0, 4, {0, 1, 0.3}, {0.2, 0, 1}, 0.7, 2 * pi},
                    {4, 7, {0.2, 0, 1}, {0, -1, 1}, 1.1}};
  return problem;
}

TEST(PolygonTwist, GradientAndHessianAreDifferences) {
  Eigen::Matrix3Xd points;
  const PolygonProblem problem = random_problem(points);
  const Eigen::Index size = points.size();
  Eigen::MatrixXd hessian = Eigen::MatrixXd::Zero(size, size);
  polygon_hessian(problem, points, HessianTerms::all,
                  [&](Eigen::Index row, Eigen::Index column, const Eigen::Matrix3d& block) {
                    hessian.block<3, 3>(3 * row, 3 * column) += block;
                  });
  const Eigen::MatrixXd columns = twist_columns(problem, points);
  ASSERT_EQ(columns.cols(), 2);
  hessian += columns * columns.transpose();
  Eigen::Matrix3Xd gradient(3, points.cols());
  (void)polygon_energy(problem, points, gradient);
  const auto energy_and_gradient = [&](const Eigen::Matrix3Xd& p) {
    Eigen::Matrix3Xd at(3, p.cols());
    Eigen::VectorXd result(size + 1);
    result[size] = polygon_energy(problem, p, at);
    result.head(size) = at.reshaped();
    return result;
  };
  const Eigen::MatrixXd expected = difference_matrix(energy_and_gradient, points, 1e-6);
  // The points of clamped segments are left out, because their frames would rotate with them.
  for (const Eigen::Index point : {2, 3, 6}) {
    for (Eigen::Index k = 3 * point; k < 3 * point + 3; ++k) {
      EXPECT_NEAR(gradient.reshaped()[k], expected(size, k), 1e-7 * gradient.cwiseAbs().maxCoeff());
      for (const Eigen::Index other : {2, 3, 6}) {
        EXPECT_LT((expected.block<3, 1>(3 * other, k) - hessian.block<3, 1>(3 * other, k)).norm(),
                  1e-7 * hessian.cwiseAbs().maxCoeff())
            << point << ", " << other;
      }
    }
  }
}

/// Equilibrium of a twisted polygon, and its RMS distance from the twisted rod [l].
struct TwistedPolygon {
  PolygonResult result;
  double rms = 0;
};

TwistedPolygon twisted(const SpatialRod& scene, Eigen::Index points, const Equilibrium& rod) {
  const std::vector<double> s = SpatialRod::arc_lengths(points);
  Problem without = scene.rod();
  for (Grip& grip : without.grips) grip.frame.reset();
  PolygonProblem problem = scene.polygon(points, 1e8);
  const Eigen::Matrix3Xd start = solve_energy(without).sample(s).points;
  Eigen::Matrix3Xd held = start;
  for (const HeldPoint& point : problem.held) held.col(point.point) = point.position;
  const PolygonResult rest = test::require_usable(solve_polygon(problem, held));
  problem.twists = {scene.twist(rest.points)};
  TwistedPolygon polygon{twist_polygon(problem, rest.points), 0};
  const Eigen::Matrix3Xd apart = polygon.result.points - rod.sample(s).points;
  polygon.rms = apart.middleCols(1, points - 2).norm() / std::sqrt(static_cast<double>(points - 2));
  return polygon;
}

TEST(PolygonTwist, ApproachesTheRodInSecondOrder) {
  for (const double roll : {-2.0, pi, 2 * pi}) {
    SpatialRod scene;
    scene.roll = roll;
    const Equilibrium rod = test::require_usable(solve_energy(scene.rod()));
    double last_rms = 0;
    double last_twist = 0;
    for (const Eigen::Index points : {20, 40, 80, 160}) {
      const TwistedPolygon polygon = twisted(scene, points, rod);
      ASSERT_TRUE(succeeded(polygon.result.status)) << points << ": " << polygon.result.message;
      ASSERT_EQ(polygon.result.twists.size(), 1);
      const double error = polygon.result.twists[0] - rod.twists[0].angle;
      if (last_rms > 0) {
        EXPECT_NEAR(last_rms / polygon.rms, 4, 0.6) << roll << ", " << points;
        EXPECT_NEAR(last_twist / error, 4, 0.6) << roll << ", " << points;
      }
      last_rms = polygon.rms;
      last_twist = error;
    }
    EXPECT_LT(last_rms, 1e-4);
  }
}

TEST(PolygonTwist, IsRefusedWhereItIsNotHeldOrHasNoLaw) {
  Eigen::Matrix3Xd points;
  const PolygonProblem good = random_problem(points);
  const auto refused = [&](const auto& change) {
    PolygonProblem problem = good;
    change(problem);
    EXPECT_THROW((void)solve_polygon(problem, points), std::invalid_argument);
    EXPECT_THROW((void)twist_polygon(problem, points), std::invalid_argument);
  };
  refused([](PolygonProblem& problem) { problem.twists[0].last_segment = 3; });
  refused([](PolygonProblem& problem) { problem.twists[0].last_segment = 0; });
  refused([](PolygonProblem& problem) { problem.twists[0].first_segment = -1; });
  refused([](PolygonProblem& problem) { problem.twists[0].compliance = 0; });
  refused([](PolygonProblem& problem) { problem.twists[0].angle = NAN; });
  refused([](PolygonProblem& problem) { problem.twists[0].last_d1.setZero(); });
  refused([](PolygonProblem& problem) { problem.law = JointLaw::paper; });
  refused([](PolygonProblem& problem) { problem.natural_turns.setZero(7); });
}

}  // namespace
}  // namespace dlo::energy_model
