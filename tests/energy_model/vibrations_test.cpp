// Tests of free vibrations: against closed forms and, about heavy shapes, against the linearised
// equations of a rod in space, integrated from the tip.

#include "dlo/energy_model/vibrations.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "../says.hpp"
#include "dlo/energy_model/energy.hpp"
#include "dlo/energy_model/exact.hpp"
#include "problems.hpp"
#include "runge_kutta.hpp"
#include "solved.hpp"

namespace dlo::energy_model {
namespace {

/// A rod with EI = l = rho A = 1.
Problem unit_rod(const Vector3d& weight, std::vector<Grip> grips) {
  Problem problem;
  problem.length = 1;
  problem.bending_stiffness = 1;
  problem.weight_per_length = weight;
  problem.grips = std::move(grips);
  return problem;
}

Grip clamped(double at, const Vector3d& position, const Vector3d& direction) {
  return {.at = at, .position = position, .direction = direction, .frame = {}};
}

Vibrations modes_of(const Problem& problem, int count, std::vector<PointMass> points = {}) {
  const Equilibrium shape = test::require_usable(solve_energy(problem));
  Inertia inertia;
  inertia.mass_per_length = 1;
  inertia.of_sections.assign(problem.sections.size(), 1);
  inertia.point_masses = std::move(points);
  Vibrations found = test::converged(vibrations(problem, inertia, shape, {.count = count}));
  return found;
}

// (beta l)^2 with cos(beta l) cosh(beta l) = -1, each in and out of the plane.
TEST(Vibrations, OfAStraightCantileverAreThoseOfABeam) {
  const Vibrations found =
      modes_of(unit_rod(Vector3d::Zero(), {clamped(0, Vector3d::Zero(), Vector3d::UnitX())}), 6);
  ASSERT_EQ(found.modes.size(), 6U);
  const std::array<double, 3> roots = {1.8751040687119612, 4.694091132974175, 7.854757438237613};
  for (std::size_t k = 0; k < 6; ++k) {
    const double exact = roots[k / 2] * roots[k / 2];
    EXPECT_NEAR(found.modes[k].omega() / exact, 1, 1e-9) << k;
    EXPECT_LT(found.modes[k].error, 1e-9);
    EXPECT_EQ(found.modes[k].plane, k % 2 == 0 ? ModePlane::in : ModePlane::out);
  }
  const std::vector<double> ends = {0, 1};
  const Eigen::Matrix3Xd moved = found.modes[0].shape(ends);
  EXPECT_NEAR(moved.col(0).norm(), 0, 1e-14);
  EXPECT_NEAR(moved.col(1).norm(), 1, 1e-12);
}

// If its ends are only slightly closer than its length, a rod between two clamps carries the
// buckling load 4 pi^2 EI/l^2. Then w_ssss + 4 pi^2 w_ss = omega^2 w. Modes that are odd about the
// middle consist of sin(a x) and sinh(b x) with a^2 - b^2 = 4 pi^2, a b = omega, and are clamped if
// a cot(a/2) = b coth(b/2). Rotation about the line between the clamps is a zero mode.
TEST(Vibrations, OfAHardlyBuckledRodAreThoseOfAPressedBeam) {
  const double slack = 1e-6;
  const Vibrations found =
      modes_of(unit_rod(Vector3d::Zero(), {clamped(0, Vector3d::Zero(), Vector3d::UnitX()),
                                           clamped(1, {1 - slack, 0, 0}, Vector3d::UnitX())}),
               3);
  ASSERT_EQ(found.modes.size(), 3U);
  EXPECT_NEAR(found.modes[0].omega_squared, 0, 1e-6);
  for (const std::size_t k : {1U, 2U}) {
    const double square = found.modes[k].omega_squared;
    const double half = 2 * std::numbers::pi * std::numbers::pi;
    const double root = std::sqrt(half * half + square);
    const double a = std::sqrt(half + root);
    const double b = std::sqrt(root - half);
    EXPECT_NEAR(a / std::tan(a / 2) / (b / std::tanh(b / 2)), 1, 100 * slack) << square;
  }
}

/// Returns a rod of length 1 that two clamps hold straight along a direction.
Problem taut_rod(const Vector3d& along) {
  return unit_rod(Vector3d::Zero(),
                  {clamped(0, {1, 2, 3}, along), clamped(1, Vector3d(1, 2, 3) + along, along)});
}

// cos(beta l) cosh(beta l) = 1.
TEST(Vibrations, OfARodHeldStraightAreThoseOfAClampedBeam) {
  const std::array<double, 3> roots = {4.730040744862704, 7.853204624095838, 10.995607838001671};
  for (const Vector3d& along : {Vector3d(1, 0, 0), Vector3d(0.48, -0.6, 0.64)}) {
    const Problem rod = taut_rod(along);
    ASSERT_TRUE(is_held_straight(rod));
    const Vibrations found =
        test::converged(taut_vibrations(rod, {.mass_per_length = 1}, 0, {.count = 6}));
    ASSERT_EQ(found.modes.size(), 6U);
    for (std::size_t k = 0; k < 6; ++k) {
      const double exact = roots[k / 2] * roots[k / 2];
      EXPECT_NEAR(found.modes[k].omega() / exact, 1, 1e-9) << k;
    }
    const std::vector<double> at = {0, 0.5, 1};
    const Eigen::Matrix3Xd moved = found.modes[0].shape(at);
    EXPECT_NEAR(moved.col(1).norm(), 1, 1e-9);
    EXPECT_NEAR(moved.col(1).dot(along), 0, 1e-9);
    EXPECT_NEAR(moved.col(0).norm() + moved.col(2).norm(), 0, 1e-9);
  }
}

// w_ssss - T w_ss = omega^2 w: with b^2 - a^2 = T, a b = omega, modes even about the middle have
// a tan(a/2) = -b tanh(b/2), odd ones a cot(a/2) = b coth(b/2). It buckles at -4 pi^2.
TEST(Vibrations, OfARodHeldStraightKnowItsTension) {
  const Problem rod = taut_rod(Vector3d::UnitX());
  for (const double tension : {-30.0, 10.0, 1000.0}) {
    const Vibrations found = taut_vibrations(rod, {.mass_per_length = 1}, tension, {.count = 4});
    ASSERT_EQ(found.modes.size(), 4U);
    for (const std::size_t k : {0U, 2U}) {
      const double root = std::sqrt(tension * tension / 4 + found.modes[k].omega_squared);
      const double a = std::sqrt(root - tension / 2);
      const double b = std::sqrt(root + tension / 2);
      const double miss = k == 0 ? a * std::sin(a / 2) + b * std::tanh(b / 2) * std::cos(a / 2)
                                 : a * std::cos(a / 2) - b / std::tanh(b / 2) * std::sin(a / 2);
      EXPECT_NEAR(miss / (a + b), 0, 1e-8) << tension << ", " << k;
    }
  }
  const double buckles = -4 * std::numbers::pi * std::numbers::pi;
  const Vibrations found = taut_vibrations(rod, {.mass_per_length = 1}, buckles, {.count = 1});
  EXPECT_NEAR(found.modes[0].omega_squared, 0, 1e-7);
}

TEST(Vibrations, OfARodHeldStraightAskForOne) {
  const Inertia inertia{.mass_per_length = 1};
  Problem rod = taut_rod(Vector3d::UnitX());
  rod.weight_per_length = {0, -1, 0};
  EXPECT_THROW((void)taut_vibrations(rod, inertia, 0), std::invalid_argument);
  rod = taut_rod(Vector3d::UnitX());
  rod.loads = {{0.5, {1, 0, 0}}};
  EXPECT_THROW((void)taut_vibrations(rod, inertia, 0), std::invalid_argument);
  rod = taut_rod(Vector3d::UnitX());
  rod.grips[1].position.x() -= 1e-6;
  EXPECT_FALSE(is_held_straight(rod));
  const std::string refusal =
      test::error_of<std::invalid_argument>([&] { (void)taut_vibrations(rod, inertia, 0); });
  EXPECT_TRUE(test::has_all(refusal, {"the grips do not hold the rod between them straight"}));
  rod = taut_rod(Vector3d::UnitX());
  rod.grips[1].direction = Vector3d(std::cos(1e-6), std::sin(1e-6), 0);
  EXPECT_FALSE(is_held_straight(rod));
  rod.grips[1].direction.reset();
  EXPECT_FALSE(is_held_straight(rod));
  rod.grips.pop_back();
  EXPECT_FALSE(is_held_straight(rod));
}

// A mass M at the tip of a beam: 1 + cos cosh + beta M (cos sinh - sin cosh) = 0.
TEST(Vibrations, OfACantileverWithAMassAtItsTip) {
  const double mass = 0.7;
  const Vibrations found =
      modes_of(unit_rod(Vector3d::Zero(), {clamped(0, Vector3d::Zero(), Vector3d::UnitX())}), 4,
               {{1, mass}});
  for (const VibrationMode& mode : found.modes) {
    const double b = std::sqrt(mode.omega());
    const double miss = 1 + std::cos(b) * std::cosh(b) +
                        b * mass * (std::cos(b) * std::sinh(b) - std::sin(b) * std::cosh(b));
    EXPECT_NEAR(miss / std::cosh(b), 0, 1e-8);
  }
}

// Bessel's zero j_0 / 2 = 1.2024127788 of a chain; a stiff layer of (EI/w)^(1/2) at the clamp makes
// a rod as much shorter, to first order: omega = 1.2024 (g / l)^(1/2) (1 + c Gamma^(-1/2) + ..).
TEST(Vibrations, OfAHangingRodComeToThoseOfAChain) {
  const double chain = 1.2024127788;
  std::array<double, 3> over{};
  for (std::size_t i = 0; i < 3; ++i) {
    const double gamma = std::pow(100.0, static_cast<double>(i + 2));
    const Vibrations found =
        modes_of(unit_rod({0, -gamma, 0}, {clamped(0, Vector3d::Zero(), -Vector3d::UnitY())}), 1);
    over[i] = (found.modes[0].omega() / (chain * std::sqrt(gamma)) - 1) * std::sqrt(gamma);
  }
  // The layer shortens the rod by its length, which changes the frequency by half of that share.
  EXPECT_NEAR(over[2], 0.5, 0.01);
  EXPECT_NEAR(over[2] - over[1], (over[1] - over[0]) / 10, 0.3 * std::abs(over[1] - over[0]) / 10);
}

/// State of a rod along its arc length, and its change in a vibration: columns r, t, m, n, dr, dt,
/// dm and dn of points, tangents, and moments and forces of the part beyond; r' = t, m = t x t',
/// m' = n x t, n' = -w - omega^2 dr.
using VibratingState = Eigen::Matrix<double, 3, 8>;

/// Integrates a state from the tip to the clamp by the classical Runge-Kutta method.
VibratingState at_clamp(VibratingState y, const Vector3d& weight, double omega_squared) {
  const auto slope = [&](double, const VibratingState& at) {
    const Vector3d t = at.col(1);
    const Vector3d m = at.col(2);
    const Vector3d n = at.col(3);
    const Vector3d dt = at.col(5);
    const Vector3d dm = at.col(6);
    const Vector3d dn = at.col(7);
    // The moment has no part about the tangent: dm . t + m . dt = 0 keeps itself.
    VibratingState rate;
    rate << t, m.cross(t), n.cross(t), -weight, dt, dm.cross(t) + m.cross(dt),
        dn.cross(t) + n.cross(dt), -omega_squared * at.col(4);
    return rate;
  };
  constexpr int steps = 4000;
  const double h = -1.0 / steps;
  for (int i = 0; i < steps; ++i) y = test::runge_kutta(slope, 0.0, y, h);
  return y;
}

/// Returns a function that is zero at a natural frequency: the determinant of the effects at the
/// clamp of five movements of the tip.
double clamp_determinant(const Vector3d& tip, const Vector3d& tangent,
                         const Vector3d& clamp_direction, const Vector3d& weight,
                         double omega_squared) {
  const Vector3d across = tangent.unitOrthogonal();
  const Vector3d beside = tangent.cross(across);
  const Vector3d here = clamp_direction.unitOrthogonal();
  Eigen::Matrix<double, 5, 5> at;
  for (Eigen::Index k = 0; k < 5; ++k) {
    VibratingState y = VibratingState::Zero();
    y.leftCols<2>() << tip, tangent;
    if (k < 3) y(k, 4) = 1;
    if (k >= 3) y.col(5) = k == 3 ? across : beside;
    y = at_clamp(y, weight, omega_squared);
    at.col(k) << y.col(4), here.dot(y.col(5)), clamp_direction.cross(here).dot(y.col(5));
  }
  return at.determinant();
}

// An independent way, on the tip of `exact`: at each mode's frequency, and at none between, the
// determinant changes its sign.
TEST(Vibrations, AboutHeavyShapesMeetTheLinearisedEquations) {
  for (const double gamma : {3.0, 30.0, 200.0}) {
    const Vector3d weight(0, -gamma, 0);
    const Vector3d direction = Vector3d(std::cos(0.4), std::sin(0.4), 0);
    const Problem problem = unit_rod(weight, {clamped(0, Vector3d::Zero(), direction)});
    const Equilibrium shape = test::require_usable(solve_exact(problem));
    const Samples tip = test::sample_at(shape, 1);
    const auto miss = [&](double omega) {
      return clamp_determinant(tip.points.col(0), tip.tangents.col(0), direction, weight,
                               omega * omega);
    };
    const Vibrations found = modes_of(problem, 6);
    double before = 0.5 * found.modes[0].omega();
    for (const VibrationMode& mode : found.modes) {
      const double omega = mode.omega();
      EXPECT_LT(miss(omega * (1 - 1e-7)) * miss(omega * (1 + 1e-7)), 0) << gamma << " " << omega;
      EXPECT_GT(miss(before) * miss(omega * (1 - 1e-7)), 0) << gamma << " " << omega;
      before = omega * (1 + 1e-7);
      EXPECT_NE(mode.plane, ModePlane::mixed);
    }
  }
}

// Beyond self-buckling the straight vertical rod is unstable; below it the frequency decreases with
// the weight.
TEST(Vibrations, OfAnUprightRodStopWhereItBuckles) {
  const double buckles = test::self_buckling_gamma;
  double before = 1e9;
  for (const double share : {0.5, 0.9, 0.99}) {
    const Vibrations found = modes_of(
        unit_rod({0, -share * buckles, 0}, {clamped(0, Vector3d::Zero(), Vector3d::UnitY())}), 1);
    EXPECT_GT(found.modes[0].omega_squared, 0);
    EXPECT_LT(found.modes[0].omega_squared, before);
    before = found.modes[0].omega_squared;
  }
  const Problem problem =
      unit_rod({0, -1.05 * buckles, 0}, {clamped(0, Vector3d::Zero(), Vector3d::UnitY())});
  for (const Equilibrium& shape : all_energy(problem)) {
    if (shape.status != SolveStatus::saddle) continue;
    const Vibrations found =
        vibrations(problem, {.mass_per_length = 1, .of_sections = {}, .point_masses = {}}, shape);
    EXPECT_LT(found.modes.front().omega_squared, 0);
    EXPECT_TRUE(std::isnan(found.modes.front().omega()));
    return;
  }
  FAIL() << "the upright shape was not found";
}

// A clamp in the middle divides the rod into two spans of half the length, with four times the
// frequency.
TEST(Vibrations, OfSpansBetweenClampsAreTheirOwn) {
  const Vibrations found =
      modes_of(unit_rod(Vector3d::Zero(), {clamped(0.5, Vector3d::Zero(), Vector3d::UnitX())}), 4);
  for (const VibrationMode& mode : found.modes) {
    EXPECT_NEAR(mode.omega() / (4 * std::pow(1.8751040687119612, 2)), 1, 1e-9);
    EXPECT_DOUBLE_EQ(mode.end - mode.begin, 0.5);
  }
  const std::vector<double> at = {0.0, 0.25, 0.75, 1.0};
  const Eigen::Matrix3Xd shape = found.modes[0].shape(at);
  const bool first = found.modes[0].begin == 0;
  EXPECT_EQ(shape.col(first ? 3 : 0).norm(), 0);
  EXPECT_NEAR(shape.col(first ? 0 : 3).norm(), 1, 1e-9);
}

TEST(Vibrations, RefuseContactAndZeroMasses) {
  Problem problem = unit_rod({0, -50, 0}, {clamped(0, Vector3d(0, 0.1, 0), Vector3d::UnitX())});
  const Inertia inertia{.mass_per_length = 1, .of_sections = {}, .point_masses = {}};
  problem.obstacles.push_back({obstacle::Body::half_space({0, 0, 0}, {0, 1, 0})});
  const Equilibrium lying = solve_energy(problem);
  ASSERT_FALSE(lying.contacts.empty());
  const Vibrations refused = vibrations(problem, inertia, lying);
  EXPECT_EQ(refused.status, SolveStatus::failed);
  EXPECT_NE(refused.message.find("touches"), std::string::npos);
  EXPECT_THROW((void)vibrations(problem, {}, lying), std::invalid_argument);
  EXPECT_THROW((void)vibrations(problem, inertia, lying, {.count = 0}), std::invalid_argument);
}

}  // namespace
}  // namespace dlo::energy_model
