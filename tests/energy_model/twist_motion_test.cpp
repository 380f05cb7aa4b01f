// Rods that move and twist: clamps that hold frames, natural curvature, two bending stiffnesses.

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "dlo/energy_model/dynamics.hpp"
#include "dlo/energy_model/energy.hpp"
#include "runge_kutta.hpp"
#include "solved.hpp"

namespace dlo::energy_model {
namespace {

using std::numbers::pi;

/// A cable of 0.8 m, EI 0.01 N m^2, 50 g/m, in SI units.
Problem cable() {
  Problem problem;
  problem.length = 0.8;
  problem.bending_stiffness = 0.01;
  problem.torsional_stiffness = 0.008;
  problem.weight_per_length = {0, 0, -0.05 * 9.81};
  return problem;
}

MovingRod moving_rod(const Problem& problem) {
  MovingRod rod;
  rod.problem = problem;
  rod.inertia.mass_per_length = 0.05;
  return rod;
}

Grip framed(double at, const Eigen::Vector3d& position, const Eigen::Vector3d& direction,
            const Eigen::Vector3d& d1) {
  Grip grip{.at = at, .position = position, .direction = direction};
  grip.frame = FrameHold{.d1 = d1};
  return grip;
}

double farthest(const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b) {
  return (a - b).colwise().norm().maxCoeff();
}

/// Turns a clamp about its direction, and holds it.
GripMotion rolling(const Grip& grip, double angle, double until) {
  return moving(grip.position, {}, {}, *grip.direction, smooth_step(0, until, angle));
}

/// Compares the state of a rod, after a clamp has been rolled and drag has stopped the motion, with
/// an equilibrium.
void expect_comes_to(const MovingRod& rod, const Problem& rolled, const char* what) {
  const Equilibrium before = solve_energy(rod.problem);
  ASSERT_TRUE(succeeded(before.status)) << what;
  const Dynamics moved = simulate(rod, before.sample, std::vector<double>{2, 30});
  ASSERT_EQ(moved.status, SolveStatus::converged) << what << ": " << moved.message;
  EXPECT_LT(moved.energy_error, 1e-5) << what;
  const Equilibrium after = solve_energy(rolled);
  ASSERT_TRUE(succeeded(after.status)) << what;
  const std::vector<double> s = equal_arc_lengths(rod.problem.length, 33);
  const Samples last = moved.frames.back().sample(s);
  const Samples at_rest = after.sample(s);
  EXPECT_GT(farthest(before.sample(s).points, at_rest.points), 0.02) << what;
  EXPECT_LT(farthest(last.points, at_rest.points), 2e-5 * rod.problem.length) << what;
  EXPECT_LT(farthest(last.d1, at_rest.d1), 2e-4) << what;
  const double unit = rod.problem.bending_stiffness / rod.problem.length;
  EXPECT_NEAR(moved.frames.back().energy.twisting, after.energy.twisting, 1e-4 * unit) << what;
  EXPECT_NEAR(moved.frames.back().energy.bending, after.energy.bending, 1e-4 * unit) << what;
  for (std::size_t i = 0; i < rod.problem.grips.size(); ++i) {
    EXPECT_LT((moved.frames.back().grips[i].torque - after.grips[i].torque).norm(), 2e-4 * unit)
        << what << ", grip " << i;
  }
}

TEST(TwistMotion, ARolledClampLeavesTheEquilibriumThatItHolds) {
  Problem problem = cable();
  problem.grips = {framed(0, {0, 0, 0}, Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY()),
                   framed(0.8, {0.6, 0.1, 0}, Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY())};
  // A part that yields more to twist than it does to bending.
  Section part;
  part.begin = 0.3;
  part.end = 0.5;
  part.bending_stiffness = 0.02;
  part.torsional_stiffness = 0.003;
  part.weight_per_length = problem.weight_per_length;
  problem.sections = {part};
  MovingRod rod = moving_rod(problem);
  rod.inertia.of_sections = {rod.inertia.mass_per_length};
  rod.air_drag = 0.5;
  rod.breaks = {0, 1};
  rod.motions = {nullptr, rolling(problem.grips[1], 2.8, 1)};
  problem.grips[1].frame->roll = 2.8;
  expect_comes_to(rod, problem, "round");
}

TEST(TwistMotion, AWristTurnsACurvedWire) {
  for (const bool flat : {false, true}) {
    Problem problem = cable();
    problem.natural_strains = {{1, 2, 0.5}, {0.4, 0, 0}};
    if (flat) problem.bending_stiffness_2 = 0.02;
    problem.grips = {framed(0, {0, 0, 0}, Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY())};
    MovingRod rod = moving_rod(problem);
    rod.air_drag = 0.5;
    rod.breaks = {0, 1};
    rod.motions = {rolling(problem.grips[0], 1.2, 1)};
    problem.grips[0].frame->roll = 1.2;
    expect_comes_to(rod, problem, flat ? "flat" : "round");
  }
}

constexpr double material_damping = 0.005;  // s

/// Links of equal length, the first one held, with springs of natural angles; Runge and Kutta.
class SpringingLinks {
 public:
  SpringingLinks(int links, double mass_per_length, double stiffness, double natural_curvature)
      : h_(1.0 / links), mass_(mass_per_length), stiffness_(stiffness), bend_(natural_curvature) {
    state_.setZero(2 * links);
  }

  void advance(double to, double longest_step) {
    const int steps = static_cast<int>(std::ceil((to - time_) / longest_step));
    const double dt = (to - time_) / steps;
    const auto rate = [this](double, const Eigen::VectorXd& state) { return rates(state); };
    for (int k = 0; k < steps; ++k) state_ = test::runge_kutta(rate, 0.0, state_, dt);
    time_ = to;
  }

  [[nodiscard]] Eigen::Vector2d tip() const {
    const auto a = state_.head(state_.size() / 2).array();
    return {h_ * a.cos().sum(), h_ * a.sin().sum()};
  }

 private:
  /// Returns the moment of the joint before a link.
  template <class Angles>
  [[nodiscard]] double moment(const Angles& angle, const Angles& rate, Eigen::Index link) const {
    const double h = link > 0 ? h_ : h_ / 2;
    const double bent = angle[link] - (link > 0 ? angle[link - 1] : 0);
    const double bending = rate[link] - (link > 0 ? rate[link - 1] : 0);
    return stiffness_ * ((bent + material_damping * bending) / h - bend_);
  }
  /// Masses in the middle of links with the inertia of bars; the clamp's joint is half a link away.
  [[nodiscard]] Eigen::VectorXd rates(const Eigen::VectorXd& state) const {
    const Eigen::Index n = state.size() / 2;
    const auto a = state.head(n);
    const auto rate = state.tail(n);
    const double m = mass_ * h_;
    Eigen::MatrixXd inertia(n, n);
    Eigen::VectorXd force(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const double before = moment(a, rate, i);
      const double after = i + 1 < n ? moment(a, rate, i + 1) : 0;
      force[i] = after - before;
      for (Eigen::Index j = 0; j < n; ++j) {
        const double beyond = static_cast<double>(n - 1 - std::max(i, j));
        const double both = m * h_ * h_ * (i == j ? beyond + 1.0 / 3 : beyond + 0.5);
        inertia(i, j) = both * std::cos(a[i] - a[j]);
        force[i] -= both * std::sin(a[i] - a[j]) * rate[j] * rate[j];
      }
    }
    Eigen::VectorXd result(2 * n);
    result << rate, inertia.ldlt().solve(force);
    return result;
  }

  double h_, mass_, stiffness_, bend_;
  double time_ = 0;
  Eigen::VectorXd state_;
};

/// A wire of 1 m with curvature 2 1/m, straight when it is let go, in an oblique plane.
MovingRod straightened_wire() {
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()));
  Problem problem;
  problem.length = 1;
  problem.bending_stiffness = 0.02;
  problem.torsional_stiffness = 0.015;
  problem.natural_strains = {{2, 0, 0}};
  problem.grips = {
      framed(0, {0, 0, 0}, turn * Eigen::Vector3d::UnitX(), turn * Eigen::Vector3d::UnitZ())};
  MovingRod rod = moving_rod(problem);
  rod.inertia.mass_per_length = 0.1;
  rod.material_damping = material_damping;
  return rod;
}

TEST(TwistMotion, AStraightenedWireCurlsAsAChainOfLinks) {
  const std::vector<double> times = {0.1, 0.2, 0.3, 0.5, 0.8};
  const MovingRod rod = straightened_wire();
  const Eigen::Vector3d along = *rod.problem.grips[0].direction;
  const Eigen::Vector3d across = rod.problem.grips[0].frame->d1->cross(along);
  SpringingLinks coarse(12, 0.1, 0.02, 2);
  SpringingLinks fine(24, 0.1, 0.02, 2);
  std::vector<Eigen::Vector2d> expected;
  for (const double time : times) {
    coarse.advance(time, 5e-5);
    fine.advance(time, 5e-5);
    expected.emplace_back((4 * fine.tip() - coarse.tip()) / 3);  // errors go with h^2
  }
  for (const bool spatial : {false, true}) {
    const Dynamics moved =
        test::converged(simulate(rod, straight_rod(along), times, {.spatial = spatial}));
    EXPECT_LT(moved.energy_error, 1e-6);
    for (std::size_t k = 0; k < times.size(); ++k) {
      const Eigen::Vector3d tip = moved.frames[k].sample(std::vector<double>{1.0}).points.col(0);
      EXPECT_NEAR(tip.dot(along), expected[k].x(), 1e-3) << spatial << ", " << times[k];
      EXPECT_NEAR(tip.dot(across), expected[k].y(), 1e-3) << spatial << ", " << times[k];
      EXPECT_NEAR(tip.dot(*rod.problem.grips[0].frame->d1), 0, 1e-9);
      EXPECT_LT(moved.frames[k].energy.twisting, 1e-12);
    }
  }
}

// A torque is the same all along a straight rod, and twist has no inertia to change that.
TEST(TwistMotion, TorqueOfASlackRodIsThatOfItsTurns) {
  Problem problem = cable();
  problem.weight_per_length.setZero();
  problem.grips = {framed(0, {0, 0, 0}, Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY()),
                   framed(0.8, {0.799, 0, 0}, Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY())};
  MovingRod rod = moving_rod(problem);
  rod.breaks = {0, 1};
  rod.motions = {nullptr, rolling(problem.grips[1], 1, 1)};
  const Equilibrium rest = test::usable(solve_energy(problem));
  const Dynamics moved =
      test::converged(simulate(rod, rest.sample, std::vector<double>{0.25, 0.5, 1}));
  for (const MovingFrame& frame : moved.frames) {
    const Samples ends = frame.sample(std::vector<double>{0, 0.8});
    const double turned = std::atan2(ends.d1.col(1).z(), ends.d1.col(1).y());
    EXPECT_NEAR(frame.grips[1].torque.x(), problem.torsional_stiffness * turned / 0.8,
                0.02 * std::abs(problem.torsional_stiffness * turned / 0.8));
  }
  EXPECT_NEAR(moved.frames.back().energy.work,
              moved.frames.back().energy.total() - rest.energy.total(), 1e-6);
}

}  // namespace
}  // namespace dlo::energy_model
