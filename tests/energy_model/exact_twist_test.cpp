// Tests of the exact solver with twist: closed forms of shapes and of their buckling, balances, and
// the frames that clamps hold.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <string>

#include "../says.hpp"
#include "base/spin.hpp"
#include "dlo/energy_model/energy.hpp"
#include "dlo/energy_model/exact.hpp"
#include "dlo/energy_model/turns.hpp"
#include "equilibrium_balance.hpp"
#include "kirchhoff/rod_span.hpp"
#include "problems.hpp"
#include "random_problems.hpp"
#include "rolled_clamps.hpp"
#include "shooting/second_variation.hpp"
#include "solved.hpp"

namespace dlo::energy_model {
namespace {

/// Returns the first span of a rod between clamps.
RodSpan span_of(const Problem& problem) { return cut_at_clamps(problem).front(); }

SpanStates states_of(const std::function<RodState(double)>& state) {
  return [state](const std::vector<double>& s) {
    std::vector<RodState> states;
    states.reserve(s.size());
    for (const double at : s) states.push_back(state(at));
    return states;
  };
}

/// Returns the zero of a smooth function, by the inverse polynomial through its values at x + k h,
/// k = 1 .. 5.
double extrapolated_root(double x, double h, const std::function<double(double)>& value) {
  constexpr int count = 5;
  std::array<double, count> at{};
  std::array<double, count> own{};
  for (int k = 0; k < count; ++k) {
    at[k] = x + h * (k + 1);
    own[k] = value(at[k]);
  }
  double root = 0;
  for (int k = 0; k < count; ++k) {
    double part = at[k];
    for (int j = 0; j < count; ++j) {
      if (j != k) part *= own[j] / (own[j] - own[k]);
    }
    root += part;
  }
  return root;
}

ClampFrames any_frames() { return {Eigen::Matrix3d::Identity(), Eigen::Matrix3d::Identity()}; }

TEST(TwistedSecondVariation, VanishesWhereAStraightRodBuckles) {
  // Without tension between clamps: tan(M / 2) = M / 2.
  const RodSpan span = span_of(rolled_clamps({0.5, 0, 0}, {1, 0, 0}, 0.01, 0));
  const auto smallest = [&](double torque) {
    return second_variation(span, {}, any_frames(), torque * torque, states_of([&](double) {
                              RodState state;
                              state.R =
                                  frame_along(Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY());
                              state.m = torque * state.t();
                              return state;
                            }))
        .smallest;
  };
  constexpr double critical = 8.986818916;
  EXPECT_GT(smallest(critical - 1e-3), 0);
  EXPECT_LT(smallest(critical + 1e-3), 0);
  EXPECT_NEAR(extrapolated_root(critical, -0.01, smallest), critical, 1e-8);
  EXPECT_NEAR(extrapolated_root(critical, 0.01, smallest), critical, 1e-8);
}

/// Returns the state of a planar ring that is twisted by an angle. The torque requires a force
/// perpendicular to the plane.
RodState ring_state(double c, double angle, double s) {
  const double k = 2 * pi;
  const Eigen::Vector3d t(std::cos(k * s), std::sin(k * s), 0);
  RodState state;
  state.r = Eigen::Vector3d(std::sin(k * s), 1 - std::cos(k * s), 0) / k;
  state.R = frame_along(t, Eigen::Vector3d::UnitZ());
  state.m = c * angle * t + k * Eigen::Vector3d::UnitZ();
  state.n = {0, 0, k * c * angle};
  return state;
}

TEST(TwistedSecondVariation, VanishesWhereMichellsRingBuckles) {
  // The ring becomes unstable at a twist of 2 pi 3^(1/2) / c, in two directions. Below that,
  // rotation about the line of the clamps is its only zero mode.
  for (const double c : {0.6, 1.0, 1.5}) {
    const RodSpan span = span_of(rolled_clamps({0, 0, 0}, {1, 0, 0}, c, 0));
    const auto stability = [&](double angle) {
      return second_variation(span, {}, any_frames(), std::pow(2 * pi + c * angle, 2),
                              states_of([&](double s) { return ring_state(c, angle, s); }));
    };
    const double critical = 2 * pi * std::sqrt(3.0) / c;
    EXPECT_EQ(stability(critical * (1 - 1e-5)).negative, 0);
    EXPECT_EQ(stability(critical * (1 - 1e-5)).neutral, 1);
    EXPECT_EQ(stability(critical * (1 + 1e-5)).negative, 2);
    const double root = extrapolated_root(critical, 1e-3 * critical,
                                          [&](double angle) { return stability(angle).smallest; });
    EXPECT_NEAR(root / critical, 1, 1e-7) << c;
  }
}

/// Rod whose frames are a given function of s under a force, with natural strains such that it
/// carries a given moment. It computes the energy of changes of the frames, by differences.
struct FramedCurve {
  std::function<Eigen::Matrix3d(double)> frame;
  std::function<Eigen::Vector3d(double)> moment;
  Eigen::Vector3d stiffness;
  Eigen::Vector3d n;

  static constexpr int parts = 2000;

  static Eigen::Vector3d strain(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
    const Eigen::AngleAxisd rotation(Eigen::Matrix3d(a.transpose() * b));
    return parts * rotation.angle() * rotation.axis();
  }

  /// Returns the energy of the frames exp(hat(spin)) R minus that of the frames R.
  [[nodiscard]] double cost(const std::function<Eigen::Vector3d(double)>& spin) const {
    double energy = 0;
    for (int i = 0; i < parts; ++i) {
      const double s = static_cast<double>(i) / parts;
      const double next = (i + 1.0) / parts;
      const double middle = (s + next) / 2;
      const Eigen::Matrix3d a = from_rotation_vector(spin(s)) * frame(s);
      const Eigen::Matrix3d b = from_rotation_vector(spin(next)) * frame(next);
      const Eigen::Vector3d own = frame(middle).transpose() * moment(middle);
      const Eigen::Vector3d change = strain(a, b) - strain(frame(s), frame(next));
      energy += own.dot(change) / parts + change.dot(stiffness.cwiseProduct(change)) / (2 * parts);
      energy -= n.dot(a.col(2) + b.col(2)) / (2 * parts);
    }
    return energy;
  }
};

/// Returns a mode of the second variation at s, by polynomials through the nodes of each element.
Eigen::Vector3d evaluate_mode(const SecondVariation& mode, double s) {
  constexpr Eigen::Index order = 4;
  Eigen::Index first = 0;
  while (first + 2 * order < mode.s.size() && mode.s[first + order] < s) first += order;
  Eigen::Vector3d value = Eigen::Vector3d::Zero();
  for (Eigen::Index k = first; k <= first + order; ++k) {
    double part = 1;
    for (Eigen::Index j = first; j <= first + order; ++j) {
      if (j != k) part *= (s - mode.s[j]) / (mode.s[k] - mode.s[j]);
    }
    value += part * mode.spin.col(k);
  }
  return value;
}

TEST(TwistedSecondVariation, IsTheSecondDifferenceOfTheEnergy) {
  // The frames are arbitrary and not an equilibrium: force and moment do not balance.
  const auto frame = [](double s) {
    const Eigen::Vector3d turn(1.5 * std::sin(2 * s), 2 * s * s - 1, 5 * s + std::cos(3 * s));
    return from_rotation_vector(turn).toRotationMatrix();
  };
  const auto moment = [](double s) { return Eigen::Vector3d(2 - s, std::sin(4 * s), 3 * s * s); };
  for (const double size : {-9.0, 0.0, 4.0, 13.0}) {
    Problem problem = rolled_clamps({0.4, 0.3, 0.2}, frame(1).col(2), 0.8, 0);
    problem.grips[0].direction = Eigen::Vector3d(frame(0).col(2));
    const FramedCurve curve{frame,
                            [&](double s) { return Eigen::Vector3d(size * moment(s)); },
                            {1, 1, 0.8},
                            {2, -3, 5}};
    const SecondVariation found =
        second_variation(span_of(problem), {}, any_frames(), 200, states_of([&](double s) {
                           RodState state;
                           state.R = frame(s);
                           state.m = curve.moment(s);
                           state.n = curve.n;
                           return state;
                         }));
    const auto cost = [&](double amount) {
      return curve.cost(
          [&](double s) { return Eigen::Vector3d(amount * evaluate_mode(found, s)); });
    };
    double norm = 0;
    for (int i = 0; i < FramedCurve::parts; ++i) {
      const Eigen::Vector3d here =
          evaluate_mode(found, static_cast<double>(i) / FramedCurve::parts);
      const Eigen::Vector3d next = evaluate_mode(found, (i + 1.0) / FramedCurve::parts);
      norm += (next - here).squaredNorm() * FramedCurve::parts +
              (here.squaredNorm() + next.squaredNorm()) / (2 * FramedCurve::parts);
    }
    constexpr double h = 1e-3;
    const double second = (cost(h) - 2 * cost(0) + cost(-h)) / (h * h);
    // Differences of the polygon are accurate to 1e-6 of their terms.
    EXPECT_NEAR(second / norm, found.smallest, 1e-5 * (1 + std::abs(found.smallest))) << size;
  }
}

Eigen::Vector3d turned(const Eigen::Vector3d& d, const Eigen::Vector3d& axis, double angle) {
  return Eigen::AngleAxisd(angle, axis) * d;
}

TEST(ExactTwist, ConfirmsTheLocalisedBuckleOfALongRod) {
  // EI 1.345, GJ 0.789 N m^2 (van der Heijden, Neukirch, Goss, Thompson 2003), 27 turns, 3 % slack.
  const double c = 0.789 / 1.345;
  Problem problem = rolled_clamps({0.97, 0, 0}, {1, 0, 0}, c, 54 * pi);
  problem.grips[0].frame->d1 = Eigen::Vector3d::UnitY();
  problem.grips[1].frame->d1 = Eigen::Vector3d::UnitY();
  // The buckle slides along the rod and rotates about the line between the clamps for less than
  // rounding. These zero modes do not count as neutral directions.
  const Equilibrium energy = test::converged(solve_energy(problem));
  EXPECT_EQ(energy.neutral_directions, 0);
  const Equilibrium exact = solve_exact(problem, {.start = &energy});
  ASSERT_TRUE(static_cast<bool>(exact.sample)) << exact.message;
  for (const Equilibrium& result : {energy, exact}) {
    EXPECT_NEAR(result.twists.at(0).torque, 98.541496171, 98.54e-7);
    EXPECT_NEAR(result.grips[1].force.x(), 2900.993206, 2901e-7);
  }
}

/// Returns the director that is carried along a shape without twist.
Eigen::Vector3d transported_director(const Equilibrium& shape, Eigen::Vector3d d) {
  const Samples samples = shape.sample(equal_arc_lengths(1, 2001));
  for (Eigen::Index i = 0; i + 1 < samples.points.cols(); ++i) d = test::carried(samples, i, d);
  return d;
}

/// Clamps that do not fit each other, and weight.
Problem rod_with_misaligned_clamps(double roll) {
  Problem problem = rolled_clamps({0.6, 0.2, 0.1}, {0.8, 0.3, -0.5}, 0.7, roll);
  problem.weight_per_length = {0, -5, 0};
  return problem;
}

TEST(ExactTwist, PutsTheFrameAtTheEndWhereTheRollSays) {
  const Problem unrolled = rod_with_misaligned_clamps(0);
  const Eigen::Vector3d start = held_d1(unrolled, unrolled.grips[0]);
  const Eigen::Vector3d d1 = held_d1(unrolled, unrolled.grips[1]);
  const Eigen::Vector3d t = Eigen::Vector3d(0.8, 0.3, -0.5).normalized();
  for (const double roll : {-2.0, 1.0, 6.0, 12.0}) {
    const Equilibrium result = test::converged(solve_exact(rod_with_misaligned_clamps(roll)));
    const Eigen::Vector3d end =
        turned(transported_director(result, start), t, result.twists.at(0).angle);
    EXPECT_LT((end - turned(d1, t, roll)).norm(), 1e-9) << roll;
  }
}

TEST(ExactTwist, OfSeveralPartsIsInBalance) {
  // A clamp in the middle holds a frame and a later one does not, so the last part of the rod is
  // not twisted.
  Problem problem = rod_with_misaligned_clamps(2);
  problem.length = 2;
  problem.bending_stiffness = 3;
  problem.torsional_stiffness = 2;
  problem.grips.push_back({1.5, {0.7, 0.5, 0.1}, Eigen::Vector3d(0, 1, 1)});
  problem.grips.push_back({0.6, {0.35, 0.1, 0.15}, std::nullopt});
  const Equilibrium result = test::converged(solve_exact(problem));
  ASSERT_EQ(result.twists.size(), 1U);
  EXPECT_EQ(result.twists[0].begin, 0);
  EXPECT_EQ(result.twists[0].end, 1);
  EXPECT_NEAR(result.twists[0].torque, problem.torsional_stiffness * result.twists[0].angle, 1e-12);
  EXPECT_NEAR(result.energy.twisting, result.twists[0].torque * result.twists[0].angle / 2, 1e-12);
  EXPECT_LT(test::balance_of(problem, result, 0.01).worst(), 1e-10);
}

TEST(ExactTwist, StartsFromAnEquilibriumWithoutContinuation) {
  for (const bool known : {false, true}) {
    Problem problem = rod_with_misaligned_clamps(5);
    if (known) {
      problem.grips[0].frame->d1 = Eigen::Vector3d(0.3, 0, 1);
      problem.grips[1].frame->d1 = Eigen::Vector3d(0.1, -2, 1);
    }
    const Equilibrium cold = test::converged(solve_exact(problem));
    const Equilibrium again = test::converged(solve_exact(problem, {.start = &cold}));
    EXPECT_LT(again.evaluations, 6);
    EXPECT_NEAR(again.twists.at(0).angle, cold.twists.at(0).angle, 1e-9);
    EXPECT_LT(test::largest_point_distance(again, cold), 2e-11);
  }
}

TEST(ExactTwist, RefusesWhatItCannotTwist) {
  const auto refusal = [](const Problem& problem) {
    return test::error_of<std::invalid_argument>([&] { return solve_exact(problem); });
  };
  Problem soft = rod_with_misaligned_clamps(1);
  soft.torsional_stiffness = 0;
  EXPECT_NE(refusal(soft).find("torsional_stiffness"), std::string::npos) << refusal(soft);
  Problem pin = rod_with_misaligned_clamps(1);
  pin.grips[1].direction.reset();
  EXPECT_NE(refusal(pin).find("grip with a frame but no direction"), std::string::npos);
  Problem open = rod_with_misaligned_clamps(1);
  open.grips.push_back({0.5, {0.3, 0, 0}, Eigen::Vector3d::UnitX()});
  EXPECT_NE(refusal(open).find("clamp without a frame between"), std::string::npos);
}

TEST(ExactTwist, ReportsTheRollThatItReached) {
  const Equilibrium result = solve_exact(rod_with_misaligned_clamps(1e7), {.time_limit = 1});
  EXPECT_EQ(result.status, SolveStatus::time_limit);
  EXPECT_NE(result.message.find("of 1000000"), std::string::npos) << result.message;
}

// With a gradient flow of the tangents alone the solver did not converge, because the roll has no
// equilibrium nearby for any fixed tangents.
TEST(ExactTwist, FollowsAStripWhoseRollSnaps) {
  const Problem problem = test::random_problem(500003, test::RandomSpace::strip);
  const Equilibrium result = test::converged(solve_exact(problem));
}

}  // namespace
}  // namespace dlo::energy_model
