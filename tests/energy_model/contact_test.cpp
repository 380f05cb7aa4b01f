// Rods on rigid and on soft obstacles.

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "../sanitized.hpp"
#include "contact/penetration.hpp"
#include "dlo/energy_model/energy.hpp"
#include "equilibrium_balance.hpp"
#include "problems.hpp"
#include "random_contact.hpp"
#include "runge_kutta.hpp"
#include "solved.hpp"

namespace dlo::energy_model {
namespace {

using test::BalanceDefects;
using test::heavy_cantilever;
using test::random_touching_problem;

Problem over_floor(double gamma, double height) {
  Problem problem = heavy_cantilever(gamma, 0);
  problem.obstacles = {{obstacle::Body::half_space({0, -height, 0}, {0, 1, 0})}};
  return problem;
}

/// A rod held above a floor, worked out from its shear force alone. Where it lies it is straight
/// and its weight is carried on the spot; up to the touch-down at s = b it hangs free:
///     theta'' = (w (b - s) - R) cos(theta),  theta = theta' = 0 at s = b,
/// R the floor's force at the touch-down. b and R follow from the height and from theta = 0
/// (clamped level) or theta' = 0 (hinged) at s = 0.
class LyingRod {
 public:
  LyingRod(double gamma, double height, bool hinged) : gamma_(gamma), hinged_(hinged) {
    // From small slopes on, higher and higher.
    const double linear = hinged ? 24 : 72;
    double h = std::min(height, 1e-3);
    Eigen::Vector2d unknown(std::pow(linear * h / gamma, 0.25), 0);
    unknown[1] = gamma * unknown[0] / (hinged ? 2 : 3);
    for (;; h = std::min(1.1 * h, height)) {
      solve(unknown, h);
      if (h == height) break;
    }
    b = unknown[0];
    R = unknown[1];
    residual = shoot(unknown, height).norm();
    tip = width_ + 1 - b;
  }

  double b = 0, R = 0, tip = 0, residual = 0;

 private:
  void solve(Eigen::Vector2d& unknown, double height) {
    for (int step = 0; step < 20; ++step) {
      const Eigen::Vector2d miss = shoot(unknown, height);
      if (miss.norm() < 1e-13) return;
      Eigen::Matrix2d jacobian;
      for (int k = 0; k < 2; ++k) {
        Eigen::Vector2d moved = unknown;
        const double h = 1e-6 * unknown[k];
        moved[k] += h;
        jacobian.col(k) = (shoot(moved, height) - miss) / h;
      }
      const Eigen::Vector2d way = -jacobian.partialPivLu().solve(miss);
      double share = 1;
      while (share > 1e-3 && !(shoot(unknown + share * way, height).norm() < miss.norm())) {
        share /= 2;
      }
      unknown += share * way;
    }
  }

  /// Angle or curvature, and height, missed at the start; Runge-Kutta 4 backwards from the
  /// touch-down.
  Eigen::Vector2d shoot(const Eigen::Vector2d& unknown, double height) {
    using State = Eigen::Array4d;  // theta, theta', x, y
    const auto rate = [&](double back, const State& z) {
      return State(-z[1], -(gamma_ * back - unknown[1]) * std::cos(z[0]), -std::cos(z[0]),
                   -std::sin(z[0]));
    };
    State z = State::Zero();
    constexpr int steps = 1500;
    const double h = unknown[0] / steps;
    for (int i = 0; i < steps; ++i) z = test::runge_kutta(rate, i * h, z, h);
    width_ = -z[2];
    return {hinged_ ? z[1] * unknown[0] : z[0], z[3] - height};
  }

  double gamma_;
  bool hinged_;
  double width_ = 0;
};

TEST(Contact, LyingRodIsThatOfTheElastica) {
  int looked = 0;
  for (const double gamma : {10.0, 100.0, 1e3, 1e4, 1e5}) {
    for (const double height : {0.01, 0.1, 0.3}) {
      const LyingRod exact(gamma, height, false);
      if (!(exact.residual < 1e-10) || exact.b > 1) continue;  // its tip touches
      SCOPED_TRACE("Gamma " + std::to_string(gamma) + ", height " + std::to_string(height));
      ++looked;
      const Equilibrium result = test::converged(solve_energy(over_floor(gamma, height)));
      ASSERT_EQ(result.contacts.size(), 1);
      const ContactPart& contact = result.contacts[0];
      EXPECT_EQ(contact.kind, ContactKind::lying);
      EXPECT_NEAR(contact.begin, exact.b, 1e-8);
      EXPECT_EQ(contact.end, 1);
      EXPECT_NEAR(contact.begin_force, exact.R, 1e-7 * gamma);
      EXPECT_NEAR(contact.end_force, 0, 1e-7 * gamma);
      EXPECT_NEAR(contact.largest_pressure, gamma, 1e-4 * gamma);  // a difference
      EXPECT_NEAR(result.obstacles[0].y(), exact.R + gamma * (1 - exact.b), 1e-7 * gamma);
      EXPECT_NEAR(result.grips[0].force.y(), gamma * exact.b - exact.R, 1e-7 * gamma);
      const Samples tip = test::sample_at(result, 1);
      EXPECT_NEAR(tip.points(0, 0), exact.tip, 1e-8);
      EXPECT_NEAR(tip.points(1, 0), -height, 1e-12);
    }
  }
  EXPECT_GE(looked, 11);
}

// A rod that touches with its tip alone: theta'' = (w (1 - s) - R) cos(theta), theta'(1) = 0.
TEST(Contact, TouchingTipIsThatOfTheElastica) {
  const double gamma = 20;
  const double height = 0.3;
  const Equilibrium result = test::converged(solve_energy(over_floor(gamma, height)));
  ASSERT_EQ(result.contacts.size(), 1);
  EXPECT_EQ(result.contacts[0].kind, ContactKind::tip);
  const double R = result.contacts[0].force.y();
  EXPECT_NEAR(result.grips[0].force.y() + R, gamma, 1e-9);
  // Integrates forwards from the clamp with the torque of the solver.
  double theta = 0;
  double kappa = -result.grips[0].torque.z();
  Eigen::Vector2d point(0, 0);
  constexpr int steps = 4000;
  const double h = 1.0 / steps;
  using State = Eigen::Array4d;
  const auto rate = [&](double s, const State& z) {
    return State(z[1], (gamma * (1 - s) - R) * std::cos(z[0]), std::cos(z[0]), std::sin(z[0]));
  };
  State z(theta, kappa, point.x(), point.y());
  for (int i = 0; i < steps; ++i) z = test::runge_kutta(rate, i * h, z, h);
  EXPECT_NEAR(z[1], 0, 1e-8);
  EXPECT_NEAR(z[3], -height, 1e-9);
  const Samples tip = test::sample_at(result, 1);
  EXPECT_NEAR(tip.points(0, 0), z[2], 1e-9);
}

// Small slopes: lift-off at (72 EI h / w)^(1/4) clamped level and (24 EI h / w)^(1/4) hinged, with
// w b / 3 and w b / 2 concentrated there; they are approached with the square of the slope.
TEST(Contact, SmallSlopesLiftOffWhereBeamTheorySays) {
  const double gamma = 100;
  double before = 0;
  for (const double height : {1e-3, 1e-4, 1e-5}) {
    const Equilibrium clamped = test::converged(solve_energy(over_floor(gamma, height)));
    const double b = std::pow(72 * height / gamma, 0.25);
    ASSERT_EQ(clamped.contacts.size(), 1);
    const double away = std::abs(clamped.contacts[0].begin / b - 1);
    const double slope = height / b;
    EXPECT_LT(away, slope * slope);
    EXPECT_NEAR(clamped.contacts[0].begin_force / (gamma * b / 3), 1, slope * slope);
    if (before > 0) {
      EXPECT_LT(away, before / 10);  // 10^1.5
    }
    before = away;
  }
}

// Hinged at its start and clamped on the floor at its end, where the rod without the clamp is.
TEST(Contact, HingedRodLiesUpToItsClamp) {
  const double gamma = 100;
  for (const double height : {1e-4, 0.01}) {
    const LyingRod exact(gamma, height, true);
    ASSERT_LT(exact.residual, 1e-10);
    Problem problem = over_floor(gamma, height);
    problem.grips[0].direction.reset();
    problem.grips.push_back({1, {exact.tip, -height, 0}, Eigen::Vector3d(1, 0, 0)});
    const Equilibrium result = test::converged(solve_energy(problem));
    ASSERT_EQ(result.contacts.size(), 1);
    EXPECT_NEAR(result.contacts[0].begin, exact.b, 1e-7);
    EXPECT_NEAR(result.contacts[0].begin_force, exact.R, 1e-5 * gamma);
    if (height < 1e-3) {
      EXPECT_NEAR(exact.b, std::pow(24 * height / gamma, 0.25), 1e-4);
      EXPECT_NEAR(exact.R, gamma * exact.b / 2, 1e-2);
    }
  }
}

/// Returns a twist-free rod with its contacts as loads: forces at single points, and along contact
/// intervals the pressure, which equals the weight.
Problem with_contacts_as_loads(const Problem& problem, const Equilibrium& shape) {
  Problem loaded = problem;
  loaded.obstacles.clear();
  for (const ContactPart& contact : shape.contacts) {
    const Eigen::Vector3d n = problem.obstacles[contact.obstacle].body.normal();
    if (contact.kind != ContactKind::lying) {
      loaded.loads.push_back({contact.begin, contact.force});
      continue;
    }
    const Eigen::Vector3d w = problem.weight_per_length;
    const double pressed = -w.dot(n) * (contact.end - contact.begin);
    const Eigen::Vector3d begin_force = contact.force - (pressed + contact.end_force) * n;
    loaded.loads.push_back({contact.begin, begin_force});
    loaded.loads.push_back({contact.end, contact.end_force * n});
    loaded.sections.push_back({contact.begin, contact.end, problem.bending_stiffness,
                               problem.torsional_stiffness, w - w.dot(n) * n});
  }
  return loaded;
}

/// Checks the claims of `converged` for a rod on obstacles, from its samples and forces alone.
void expect_rests(const Problem& problem, const Equilibrium& shape, double panel) {
  const double l = problem.length;
  const Samples dense = shape.sample(equal_arc_lengths(l, 7919));
  double forces = problem.weight_per_length.norm() * l + problem.bending_stiffness / (l * l);
  for (const Reaction& grip : shape.grips) forces = std::max(forces, grip.force.norm());
  for (std::size_t w = 0; w < problem.obstacles.size(); ++w) {
    const Eigen::Vector3d n = problem.obstacles[w].body.normal();
    const Eigen::RowVectorXd clearance =
        n.transpose() * (dense.points.colwise() - problem.obstacles[w].body.centre());
    EXPECT_GT(clearance.minCoeff(), -1e-8 * l);
    EXPECT_NEAR(shape.obstacles[w].norm(), std::abs(shape.obstacles[w].dot(n)), 1e-9 * forces);
  }
  for (const ContactPart& contact : shape.contacts) {
    const Obstacle& obstacle = problem.obstacles[contact.obstacle];
    const Eigen::Vector3d n = obstacle.body.normal();
    EXPECT_GE(contact.force.dot(n), -1e-6 * forces);
    EXPECT_GE(contact.begin_force, -1e-6 * forces);
    EXPECT_GE(contact.end_force, -1e-6 * forces);
    for (const double at : {contact.begin, (contact.begin + contact.end) / 2, contact.end}) {
      EXPECT_NEAR(n.dot(test::point_at(shape, at) - obstacle.body.centre()), 0, 1e-8 * l);
    }
  }
  const BalanceDefects defects =
      test::balance_of(with_contacts_as_loads(problem, shape), shape, panel);
  EXPECT_LT(defects.force, 1e-8);
  // Forces concentrated at the ends of a contact interval are at the end of a series, which is less
  // accurate.
  EXPECT_LT(defects.worst(), 1e-5)
      << "force " << defects.force << ", torque " << defects.torque << ", moment " << defects.moment
      << ", grips " << defects.grips << ", integral " << defects.integral;
}

// A converged shape is an equilibrium on obstacles that only push, checked by its samples. Hardly
// any scene is refused, and none without a reason.
TEST(Contact, RandomScenesRestOrSayWhyNot) {
  constexpr int scenes = test::draws(40);
  for (const bool space : {false, true}) {
    int converged = 0;
    int touching = 0;
    for (int seed = 0; seed < scenes; ++seed) {
      SCOPED_TRACE("seed " + std::to_string(seed) + (space ? " in space" : " in the plane"));
      const Problem problem = random_touching_problem(static_cast<unsigned>(seed), space, 300);
      const Equilibrium result = solve_energy(problem, {.time_limit = 60});
      if (result.status != SolveStatus::converged) {
        EXPECT_FALSE(result.message.empty());
        continue;
      }
      ++converged;
      touching += result.contacts.empty() ? 0 : 1;
      const double load = problem.weight_per_length.norm();
      expect_rests(problem, result, 0.06 / std::sqrt(std::max(load, 10.0)));
    }
    EXPECT_GE(converged, scenes - 1);
    EXPECT_GE(touching, test::draws(10));
  }
}

// A rod that is clamped level on the floor needs no force of the clamp.
TEST(Contact, AClampOnTheFloorCarriesNothingOfWhatLies) {
  for (const double at : {0.0, 1.0}) {
    SCOPED_TRACE(at);
    Problem problem = over_floor(50, 0);
    problem.grips[0].at = at;
    const Equilibrium rod = test::converged(solve_energy(problem));
    ASSERT_EQ(rod.contacts.size(), 1);
    EXPECT_EQ(rod.contacts[0].begin, 0);
    EXPECT_EQ(rod.contacts[0].end, 1);
    EXPECT_NEAR(rod.contacts[0].force.y(), 50, 1e-6);
    EXPECT_LT(rod.grips[0].force.norm(), 1e-6);
    EXPECT_LT(rod.grips[0].torque.norm(), 1e-6);
  }
}

// An obstacle that yields less and less is another solver's way to the same shape.
TEST(Contact, StifferAndStifferObstaclesLeadToTheRigidOne) {
  Problem problem = heavy_cantilever(40, 0);
  problem.grips.push_back({1, {0.6, 0.02, 0.3}, Eigen::Vector3d(0.2, 0.3, 1)});
  problem.obstacles = {{obstacle::Body::half_space({0, -0.05, 0}, {0.1, 1, 0.05})}};
  const Equilibrium rigid = test::converged(solve_energy(problem));
  ASSERT_FALSE(rigid.contacts.empty());
  const std::vector<double> s = equal_arc_lengths(1, 101);
  double before = 1;
  for (const double stiffness : {1e4, 1e5, 1e6}) {
    problem.obstacles[0].stiffness = stiffness;
    const Equilibrium soft = test::converged(solve_energy(problem));
    EXPECT_EQ(soft.penetration, 0);  // only a rigid obstacle is penetrated, a soft one yields
    const double away = test::gap_between(soft, rigid, s);
    EXPECT_LT(away, before / 2) << stiffness;
    before = away;
  }
  EXPECT_LT(before, 1e-3);
}

// A rod does not know from which end it is counted.
TEST(Contact, ReversedRodRestsAsTheOther) {
  for (unsigned seed = 0; seed < 12; ++seed) {
    const Problem problem = random_touching_problem(100 + seed, seed % 2 == 0, 100);
    Problem reversed = problem;
    for (Grip& grip : reversed.grips) {
      grip.at = problem.length - grip.at;
      if (grip.direction) grip.direction = Eigen::Vector3d(-*grip.direction);
    }
    const Equilibrium there = solve_energy(problem);
    const Equilibrium back = solve_energy(reversed);
    if (!succeeded(there.status) || !succeeded(back.status)) continue;
    // Else they are two minima.
    const double scale = 1 + problem.weight_per_length.norm();
    if (std::abs(there.energy.total() - back.energy.total()) > 1e-3 * scale) continue;
    SCOPED_TRACE("seed " + std::to_string(seed));
    EXPECT_NEAR(there.energy.total(), back.energy.total(), 1e-8 * scale);
    ASSERT_EQ(there.contacts.size(), back.contacts.size());
    for (std::size_t i = 0; i < there.contacts.size(); ++i) {
      const ContactPart& a = there.contacts[i];
      const ContactPart& b = back.contacts[back.contacts.size() - 1 - i];
      EXPECT_NEAR(a.begin, 1 - b.end, 1e-6);
      EXPECT_NEAR(a.begin_force, b.kind == ContactKind::lying ? b.end_force : b.begin_force,
                  1e-5 * scale);
    }
  }
}

// A search whose time is over returns what it has computed, at any stage.
TEST(Contact, EndsWithNumbersWheneverTheTimeEnds) {
  Problem problem;
  problem.length = 1;
  problem.bending_stiffness = 1;
  problem.weight_per_length = {0, -2, 0};
  problem.grips = {{0, {0, 0.03, 0}, Eigen::Vector3d(-0.33, -0.94, 0).normalized()},
                   {1, {0.48, 0.18, 0}, Eigen::Vector3d(0.8, 0.6, 0).normalized()}};
  problem.obstacles = {{}};
  for (double limit = 1e-6; limit < 0.3; limit *= 1.4) {
    const Equilibrium result = solve_energy(problem, {.time_limit = limit});
    for (const Reaction& grip : result.grips) {
      EXPECT_TRUE(grip.force.allFinite() && grip.torque.allFinite()) << limit;
    }
    if (succeeded(result.status) || result.seconds < limit) continue;
    EXPECT_NE(result.message.find("time limit"), std::string::npos) << result.message;
  }
}

TEST(Contact, OutOfReachChangesNothing) {
  Problem problem = heavy_cantilever(20, 0);
  problem.obstacles = {{obstacle::Body::half_space({0, -2, 0}, {0, 1, 0})}};
  const std::vector<double> s = equal_arc_lengths(1, 101);
  const Equilibrium free = test::converged(solve_energy(problem));
  EXPECT_EQ(free.penetration, 0);
  EXPECT_TRUE(free.contacts.empty());
  const Equilibrium without = solve_energy(heavy_cantilever(20, 0));
  EXPECT_LT((free.sample(s).points - without.sample(s).points).norm(), 1e-9);
  EXPECT_EQ(free.obstacles[0].norm(), 0);
  EXPECT_EQ(free.evaluations, without.evaluations);
}

// From a rod that touches at a point: kept there, the obstacle would pull with three times the way
// over l^3, in EI/l^2, at the tip.
TEST(Contact, APointIsLetGoByAnObstacleThatMovesAway) {
  const Problem free = heavy_cantilever(0.3, 0);
  const double reach = -test::point_at(solve_energy(free), 1).y();
  const std::vector<double> at = equal_arc_lengths(free.length, 10001);
  const Eigen::Matrix3Xd alone = solve_energy(free).sample(at).points;
  // Where the peg's top has to be for its surface to be next to the rod.
  const auto from_peg = [&](double top) {
    const Eigen::Vector3d centre(0.7, -top - 0.1, 0);
    return (alone.colwise() - centre).colwise().norm().minCoeff() - 0.1;
  };
  double clear_peg = 0;
  while (from_peg(clear_peg) < 0) clear_peg += 1e-6;
  for (const bool peg : {false, true}) {
    const auto over = [&](double depth) {
      Problem problem = free;
      const Eigen::Vector3d top(peg ? 0.7 : 0.0, -depth * (peg ? 0.5 : 1.0), 0);
      problem.obstacles = {
          {peg ? obstacle::Body::cylinder(top - Eigen::Vector3d(0, 0.1, 0), {0, 0, 1}, 0.1)
               : obstacle::Body::half_space(top, {0, 1, 0})}};
      return problem;
    };
    const Equilibrium touching = test::converged(solve_energy(over(reach - 0.008)));
    ASSERT_EQ(touching.contacts.size(), 1U);
    for (const double way : {1e-6, 1e-5, 1e-4, 3e-4, 1e-3, 3e-3, 0.02, 0.1}) {
      SCOPED_TRACE((peg ? "peg " : "floor ") + std::to_string(way));
      const double depth = peg ? 2 * clear_peg : reach;
      for (const Equilibrium* start : {static_cast<const Equilibrium*>(nullptr), &touching}) {
        const Equilibrium left = test::converged(solve_energy(over(depth + way), {.start = start}));
        EXPECT_TRUE(left.contacts.empty());
        EXPECT_LT((left.sample(at).points - alone).colwise().norm().maxCoeff(), 1e-8);
      }
    }
  }
}

/// A straight rod along a level floor, so deep below its top, in lengths.
Equilibrium judged_below_a_floor(double length, double depth) {
  Problem problem = heavy_cantilever(1, 0);
  problem.length = length;
  problem.obstacles = {{obstacle::Body::half_space({0, depth * length, 0}, {0, 1, 0})}};
  Equilibrium shape;
  shape.status = SolveStatus::converged;
  shape.sample = [](std::span<const double> arc_lengths) {
    Samples samples;
    samples.arc_length.assign(arc_lengths.begin(), arc_lengths.end());
    const auto count = static_cast<Eigen::Index>(arc_lengths.size());
    samples.points.setZero(3, count);
    samples.points.row(0) = Eigen::Map<const Eigen::RowVectorXd>(arc_lengths.data(), count);
    samples.tangents = Eigen::Vector3d::UnitX().replicate(1, count);
    samples.curvature.setZero(3, count);
    return samples;
  };
  judge_penetration(problem, shape);
  return shape;
}

TEST(Penetration, IsAllowedAsAShareOfTheLength) {
  for (const double length : {0.02, 1.0, 50.0}) {
    for (const double share : {0.5, 2.0}) {
      const double depth = share * allowed_penetration;
      const Equilibrium shape = judged_below_a_floor(length, depth);
      EXPECT_NEAR(shape.penetration, depth * length, 1e-6 * depth * length);
      EXPECT_EQ(shape.status, share < 1 ? SolveStatus::converged : SolveStatus::not_verified)
          << length << ": " << shape.message;
    }
  }
}

}  // namespace
}  // namespace dlo::energy_model
