// Tests of rods that stretch by N / EA against closed forms and an independent integration.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <stdexcept>

#include "../says.hpp"
#include "dlo/energy_model/energy.hpp"
#include "dlo/energy_model/exact.hpp"
#include "runge_kutta.hpp"
#include "solved.hpp"

namespace dlo::energy_model {
namespace {

Problem rod(double EA) {
  Problem problem;
  problem.length = 1;
  problem.bending_stiffness = 1;
  problem.axial_stiffness = EA;
  return problem;
}

TEST(Stretch, OfARodThatHangsIsTheIntegralOfItsTension) {
  Problem problem = rod(40);
  problem.length = 2;
  problem.weight_per_length = {0, -3, 0};
  problem.grips = {{0, {1, 1, 0}, -Vector3d::UnitY(), {}}};
  problem.loads = {{2, {0, -1.5, 0}}};
  const Equilibrium solved = test::converged(solve_exact(problem));
  const std::vector<double> s = {0, 0.7, 2};
  const Samples shape = solved.sample(s);
  for (std::size_t i = 0; i < s.size(); ++i) {
    // N = P + w (l - s)
    const double longer = (1.5 * s[i] + 3 * (2 * s[i] - s[i] * s[i] / 2)) / 40;
    EXPECT_NEAR(shape.points(1, static_cast<Eigen::Index>(i)), 1 - s[i] - longer, 1e-11);
  }
  EXPECT_NEAR(solved.energy.stretch, (std::pow(7.5, 3) - std::pow(1.5, 3)) / (6 * 3 * 40), 1e-11);
  EXPECT_NEAR(solved.energy.load, -1.5 * (2 + (3 + 6) / 40.0), 1e-10);
  EXPECT_NEAR(solved.grips[0].force.y(), 7.5, 1e-11);
}

/// Returns the end of a line without EI, of unstretched length 1 and weight w per length along -y,
/// that is pulled at its begin by (-H, -V). x = H s/EA + H/w (asinh((V + w s)/H) - asinh(V/H)), and
/// y has a similar formula (Irvine, ch. 1).
Vector3d end_of_elastic_catenary(double H, double V, double w, double EA) {
  return {H / EA + H / w * (std::asinh((V + w) / H) - std::asinh(V / H)),
          (V + w / 2) / EA + (std::hypot(H, V + w) - std::hypot(H, V)) / w, 0};
}

TEST(Stretch, OfALineIsTheElasticCatenarys) {
  // The neglected EI has a first-order effect, which extrapolation from two weights removes.
  std::array<double, 2> tension{};
  const std::array<double, 2> weights = {2e4, 4e4};
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const double w = weights[i];
    Problem problem = rod(30 * w);
    problem.weight_per_length = {0, -w, 0};
    problem.grips = {{0, {0, 0, 0}, {}, {}},
                     {1, end_of_elastic_catenary(0.5 * w, -0.4 * w, w, 30 * w), {}, {}}};
    Problem rigid = problem;
    rigid.axial_stiffness.reset();
    const Equilibrium start = solve_energy(rigid);
    const Equilibrium solved = test::converged(solve_exact(problem, {.start = &start}));
    tension[i] = solved.grips[1].force.norm() / w;
  }
  const double closed = std::hypot(0.5, 0.6);
  EXPECT_NEAR((2 * tension[1] - tension[0]) / closed, 1, 1e-6);
  EXPECT_NEAR(tension[1] / closed, 1, 1e-3);
}

/// Rates of theta, m, x and y by s in the plane, of a rod that stretches.
struct PlanarStep {
  double EI, EA, w;
  Eigen::Vector2d begin_force;  // n at s = 0

  [[nodiscard]] Eigen::Vector4d rate(double s, const Eigen::Vector4d& y) const {
    const Eigen::Vector2d n = begin_force + Eigen::Vector2d(0, w * s);
    const Eigen::Vector2d t(std::cos(y[0]), std::sin(y[0]));
    const Eigen::Vector2d along = (1 + n.dot(t) / EA) * t;
    return {y[1] / EI, n.x() * along.y() - n.y() * along.x(), along.x(), along.y()};
  }
};

TEST(Stretch, OfACantileverIsThatOfAnIntegrationFromItsClamp) {
  Problem problem = rod(60);
  problem.bending_stiffness = 1.3;
  problem.weight_per_length = {0, -2, 0};
  problem.grips = {{0, {0, 0, 0}, Vector3d::UnitX(), {}}};
  problem.loads = {{1, {4, -3, 0}}};
  const Equilibrium solved = test::converged(solve_exact(problem));
  const PlanarStep step{1.3, 60, 2, -solved.grips[0].force.head<2>()};
  Eigen::Vector4d y(0, -solved.grips[0].torque.z(), 0, 0);
  constexpr int steps = 2000;
  const auto rate = [&step](double s, const Eigen::Vector4d& at) { return step.rate(s, at); };
  for (int i = 0; i < steps; ++i) y = test::runge_kutta(rate, 1.0 * i / steps, y, 1.0 / steps);
  const std::vector<double> tip = {1};
  const Vector3d point = solved.sample(tip).points.col(0);
  EXPECT_NEAR(y[1], 0, 1e-10);
  EXPECT_NEAR(y[2], point.x(), 1e-10);
  EXPECT_NEAR(y[3], point.y(), 1e-10);
  // The tip of the inextensible rod is elsewhere.
  problem.axial_stiffness.reset();
  const Vector3d rigid = solve_exact(problem).sample(tip).points.col(0);
  EXPECT_GT((rigid - point).norm(), 0.02);
}

TEST(Stretch, HoldsARodBetweenClampsThatAreFartherApart) {
  Problem problem = rod(2000);
  problem.length = 2;
  problem.grips = {{0, {1, 0, 0}, Vector3d::UnitX(), {}}, {2, {3.02, 0, 0}, Vector3d::UnitX(), {}}};
  const Equilibrium solved = test::converged(solve_exact(problem));
  EXPECT_NEAR(solved.grips[1].force.x(), 20, 1e-9);
  EXPECT_NEAR(solved.grips[0].force.x(), -20, 1e-9);
  EXPECT_NEAR(solved.energy.stretch, 0.2, 1e-11);
  // The distance of the clamps equals the unstretched length, and the weight bends the rod.
  problem.grips[1].position.x() = 3;
  problem.weight_per_length = {0, -1, 0};
  const Equilibrium sags = test::converged(solve_exact(problem));
  // The deflection is less than a beam's w l^4 / (384 EI), by the effect of stretch.
  const double beam = std::pow(2.0, 4) / 384;
  EXPECT_NEAR(test::point_at(sags, 1).y(), -beam, 0.5 * beam);
  EXPECT_LT(-test::point_at(sags, 1).y(), beam);
  EXPECT_GT(sags.grips[1].force.x(), 0);
}

TEST(Stretch, MovesTheLoadThatBucklesAColumn) {
  // P (1 - P / EA) = pi^2 EI / (4 l^2): 2.6031 of EA = 50, 2.4674 without.
  for (const double load : {2.59, 2.62}) {
    Problem problem = rod(50);
    problem.grips = {{0, {0, 0, 0}, Vector3d::UnitX(), {}}};
    problem.loads = {{1, {-load, 0, 0}}};
    const Equilibrium solved = test::converged(solve_exact(problem));
    const Vector3d point = test::point_at(solved, 1);
    if (load < 2.6) {
      EXPECT_NEAR(point.x(), 1 - load / 50, 1e-10);
      EXPECT_GT(solved.smallest_eigenvalue, 0);
    } else {
      EXPECT_GT(point.tail<2>().norm(), 0.02);
    }
  }
}

TEST(Stretch, IsRefusedByNameByWhatDoesNotStretch) {
  Problem problem = rod(60);
  problem.grips = {{0, {0, 0, 0}, Vector3d::UnitX(), {}}};
  EXPECT_TRUE(
      test::has_all(test::error_of<std::invalid_argument>([&] { return solve_energy(problem); }),
                    {"only solve_exact()"}));
  problem.obstacles = {{obstacle::Body::half_space({0, -1, 0}, Vector3d::UnitY())}};
  EXPECT_THROW((void)solve_exact(problem), std::invalid_argument);
}

}  // namespace
}  // namespace dlo::energy_model
