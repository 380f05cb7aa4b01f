// Tests of the balance of solvers' results: sums of forces and moments, and their dependence on
// every one of them.

#include "dlo/energy_model/balance.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "dlo/energy_model/energy.hpp"
#include "dlo/energy_model/exact.hpp"
#include "problems.hpp"
#include "rolled_clamps.hpp"
#include "solved.hpp"

namespace dlo::energy_model {
namespace {

const Action zero_action;

TEST(Imbalance, IsTheSumOfForcesAndOfMomentsAboutTheFirstPoint) {
  const Imbalance lever = imbalance_of(
      {{{1, 0, 0}, {0, 2, 0}, {0, 0, 0}}, {{4, 0, 0}, {0, -1.5, 0}, {0, 0, 4}}}, zero_action);
  EXPECT_DOUBLE_EQ(lever.force, 0.5);
  EXPECT_DOUBLE_EQ(lever.moment, 0.5);  // 4 - 3 * 1.5
  EXPECT_DOUBLE_EQ(lever.largest_force, 2);
  EXPECT_DOUBLE_EQ(lever.largest_moment, 6);
  EXPECT_DOUBLE_EQ(lever.share(), 0.25);
  const Imbalance couple = imbalance_of(
      {{{0, 0, 0}, {1e-3, 0, 0}, {0, 0, 2}}, {{1, 0, 0}, {-1e-3, 0, 0}, {0, 0, -1}}}, zero_action);
  EXPECT_DOUBLE_EQ(couple.share(), 0.5);
  EXPECT_NE(couple.text().find("1 N m (0.5 of the largest moment)"), std::string::npos)
      << couple.text();
  const Imbalance rounded =
      imbalance_of({{{0, 0, 0}, {1e-3, 0, 0}, {0, 0, 1e-3}}}, {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}});
  EXPECT_DOUBLE_EQ(rounded.share(), 1e-3);
  EXPECT_TRUE(std::isnan(imbalance_of({{{0, 0, 0}, {NAN, 0, 0}, {0, 0, 0}}}, zero_action).share()));
  EXPECT_TRUE(std::isnan(imbalance_of({{{0, 0, 0}, {1, 0, 0}, {0, NAN, 0}}}, zero_action).share()));
  const Imbalance force_only{.force = NAN, .moment = 0, .largest_force = 1, .largest_moment = 1};
  EXPECT_TRUE(std::isnan(force_only.share()));
}

/// Rod at rest, solved by a model that accepts it.
struct BalancedRod {
  std::string name;
  Problem problem;
  Equilibrium shape;
};

/// Returns rods with all kinds of loads and constraints; some are solved by both models.
std::vector<BalancedRod> balanced_rods() {
  using obstacle::Body;
  std::vector<BalancedRod> rods;
  const auto add = [&](const char* name, const Problem& problem, bool by_exact) {
    const bool touches = !problem.obstacles.empty();
    const Equilibrium start = by_exact && !touches ? Equilibrium() : solve_energy(problem);
    const ExactOptions options{.start = touches ? &start : nullptr};
    rods.push_back({name, problem, by_exact ? solve_exact(problem, options) : start});
  };
  Problem loaded = two_clamps(8, 0.8);
  loaded.loads = {{0.6, {1, -2, 3}}};
  loaded.line_loads = {{0.3, 0.9, {0, 2, 1}, {5, 0, -1}}};
  loaded.sections = {{0.1, 0.45, 3, 0, {0, -20, 0}}};
  add("loads", loaded, false);
  add("loads by shooting", loaded, true);
  Problem pinned = heavy_cantilever(5, 0);
  pinned.grips = {{0.2, {0, 0, 0}}, {0.9, {0.5, 0.1, 0.2}}};
  add("pins", pinned, false);
  Problem couple = heavy_cantilever(3, 20);
  couple.loads = {{0.7, {0, 0, 0}, {0, 0, 2}}, {0, {1, 1, 0}, {0, 0, 3}}};
  add("couples", couple, false);
  add("couples by shooting", couple, true);
  const Problem lying = test::over_floor(30, 0.1);
  add("a rod that lies", lying, false);
  add("a rod that lies by shooting", lying, true);
  Problem peg = heavy_cantilever(20, 0);
  peg.obstacles = {{Body::cylinder({0.5, -0.3, 0}, {0, 0, 1}, 0.2)}};
  add("a rod that touches", peg, false);
  Problem yielding = heavy_cantilever(12, 0);
  yielding.obstacles = {{Body::half_space({0, -0.17, 0}, {0, 1, 0}), 130}};
  add("a floor that yields", yielding, false);
  yielding.obstacles[0].body = Body::half_space({0, -0.1228, 0}, {0, 1, 0});
  add("contact that begins at 0.502, just behind the middle of the rod", yielding, false);
  add("a twisted rod", test::framed_clamps(4, 0.7, 0.8, 2), false);
  Problem stretched = two_clamps(8, 0.99);
  stretched.axial_stiffness = 100;
  add("a rod that stretches", stretched, true);
  Problem stream = heavy_cantilever(2, 0);
  stream.drag = Drag{{1, 2, 3}, 1, 0.2};
  add("a rod in a stream", stream, true);
  Problem follower = heavy_cantilever(1, 0);
  follower.torsional_stiffness = 0.8;
  follower.loads = {{0.8, {0.5, 1, -0.3}, {0.2, 0, 0.1}, true}};
  add("a load that follows", follower, true);
  return rods;
}

TEST(Balance, HoldsForResultsOfBothModels) {
  for (const BalancedRod& rod : balanced_rods()) {
    SCOPED_TRACE(rod.name + ": " + rod.shape.message);
    const bool unjudged = !has_potential(rod.problem);
    EXPECT_EQ(rod.shape.status, unjudged ? SolveStatus::not_verified : SolveStatus::converged);
    EXPECT_EQ(rod.shape.message.find("unbalanced"), std::string::npos);
    EXPECT_LT(imbalance_of(rod.problem, rod.shape).share(), 1e-9);
  }
}

bool has_lost_balance(const Equilibrium& shape) {
  return shape.status == SolveStatus::not_verified &&
         shape.message.find("unbalanced force") != std::string::npos;
}

/// Whether a result that has been changed is refused with both sums in its message.
bool is_refused(const Problem& problem, Equilibrium shape) {
  judge_balance(problem, shape);
  return has_lost_balance(shape) && shape.message.find("and moment") != std::string::npos;
}

// Each force and torque in turn is changed by ten times the allowed imbalance: of grips, contacts
// and obstacles. At last the shape is displaced by 3e-6.
TEST(Balance, IsLostWithEveryForceAndTorqueThatIsReturned) {
  constexpr double share = 10 * allowed_imbalance;
  for (const BalancedRod& rod : balanced_rods()) {
    SCOPED_TRACE(rod.name);
    const Imbalance good = imbalance_of(rod.problem, rod.shape);
    const Eigen::Vector3d force = share * good.largest_force * Eigen::Vector3d(1, 2, 2) / 3;
    const Eigen::Vector3d torque = share * good.largest_moment * Eigen::Vector3d(2, 1, 2) / 3;
    EXPECT_FALSE(is_refused(rod.problem, rod.shape));
    const auto refused = [&](const auto& change) {
      Equilibrium changed = rod.shape;
      change(changed);
      return is_refused(rod.problem, changed);
    };
    for (std::size_t i = 0; i < rod.shape.grips.size(); ++i) {
      EXPECT_TRUE(refused([&](Equilibrium& shape) { shape.grips[i].force += force; })) << i;
      EXPECT_TRUE(refused([&](Equilibrium& shape) { shape.grips[i].torque += torque; })) << i;
    }
    for (std::size_t i = 0; i < rod.shape.contacts.size(); ++i) {
      EXPECT_TRUE(refused([&](Equilibrium& shape) { shape.contacts[i].force += force; })) << i;
      EXPECT_TRUE(refused([&](Equilibrium& shape) { shape.contacts[i].moment += torque; })) << i;
    }
    for (std::size_t i = 0; i < rod.shape.obstacles.size(); ++i) {
      EXPECT_TRUE(refused([&](Equilibrium& shape) { shape.obstacles[i] += force; })) << i;
    }
    EXPECT_TRUE(refused([&](Equilibrium& shape) {
      shape.sample = [sample = rod.shape.sample](std::span<const double> s) {
        Samples moved = sample(s);
        moved.points.colwise() += Eigen::Vector3d(1e-6, 2e-6, 2e-6);
        return moved;
      };
    }));
  }
}

TEST(Balance, IsLostWithEverythingThatActsOnTheRod) {
  for (const BalancedRod& rod : balanced_rods()) {
    SCOPED_TRACE(rod.name);
    const auto refused = [&](const std::function<void(Problem&)>& change) {
      Problem changed = rod.problem;
      change(changed);
      return is_refused(changed, rod.shape);
    };
    const Eigen::Vector3d bit = 1e-5 * Eigen::Vector3d(1, 2, 3);
    EXPECT_TRUE(refused([&](Problem& problem) { problem.weight_per_length += bit; }));
    for (std::size_t i = 0; i < rod.problem.loads.size(); ++i) {
      EXPECT_TRUE(refused([&](Problem& problem) { problem.loads[i].force += bit; })) << i;
      EXPECT_TRUE(refused([&](Problem& problem) { problem.loads[i].torque += bit; })) << i;
    }
    for (std::size_t i = 0; i < rod.problem.line_loads.size(); ++i) {
      EXPECT_TRUE(refused([&](Problem& problem) { problem.line_loads[i].at_end += bit; })) << i;
    }
    for (std::size_t i = 0; i < rod.problem.sections.size(); ++i) {
      EXPECT_TRUE(refused([&](Problem& problem) { problem.sections[i].weight_per_length += bit; }))
          << i;
    }
    if (rod.problem.drag) {
      EXPECT_TRUE(refused([&](Problem& problem) { problem.drag->normal += 1e-5; }));
      EXPECT_TRUE(refused([&](Problem& problem) { problem.drag->tangential += 1e-5; }));
    }
    for (std::size_t i = 0; i < rod.problem.obstacles.size(); ++i) {
      if (!std::isfinite(rod.problem.obstacles[i].stiffness)) continue;
      EXPECT_TRUE(refused([&](Problem& problem) { problem.obstacles[i].stiffness *= 1 + 1e-5; }));
    }
  }
}

// The force of an obstacle is compared with that of its contacts only, so that it has no moment.
// The second obstacle, which is in balance, is compared after the first.
TEST(Balance, IsLostWithAnObstaclesForceThatIsNaN) {
  using obstacle::Body;
  Problem peg = heavy_cantilever(20, 0);
  peg.obstacles = {{Body::cylinder({0.5, -0.3, 0}, {0, 0, 1}, 0.2)},
                   {Body::half_space({0, -2, 0}, {0, 1, 0})}};
  Equilibrium shape = test::converged(solve_energy(peg));
  shape.obstacles = {{NAN, 0, 0}, {0, 0, 0}};
  EXPECT_TRUE(std::isnan(imbalance_of(peg, shape).share()));
  EXPECT_TRUE(is_refused(peg, shape));
}

// Both results are too inaccurate to be in balance. Two terms do not resolve where contact with a
// soft peg begins; a loose shooting tolerance does not resolve natural strains of high order.
TEST(Balance, IsRequiredOfResultsOfBothModels) {
  Problem peg = heavy_cantilever(12, 0);
  peg.obstacles = {{obstacle::Body::cylinder({0.5, -0.4, 0}, {0, 0, 1}, 0.1), 130}};
  EnergyOptions few;
  few.terms = 2;
  const Equilibrium coarse = solve_energy(peg, few);
  EXPECT_TRUE(has_lost_balance(coarse)) << coarse.message;
  EXPECT_EQ(solve_energy(peg).status, SolveStatus::converged);
  Problem hanging = heavy_cantilever(12, 10);
  hanging.torsional_stiffness = 1;
  hanging.natural_strains.assign(40, Eigen::Vector3d::Zero());
  hanging.natural_strains.back().y() = 3;
  const Equilibrium loose = solve_exact(hanging, {.tolerance = 1});
  EXPECT_TRUE(has_lost_balance(loose)) << loose.message;
  EXPECT_EQ(solve_exact(hanging).status, SolveStatus::converged);
}

// A shape whose status is not that of an equilibrium keeps its message; a saddle is an equilibrium.
TEST(Balance, IsCheckedForEquilibriaOnly) {
  const Problem problem = heavy_cantilever(5, 10);
  Equilibrium shape = test::converged(solve_energy(problem));
  shape.grips[0].force += Eigen::Vector3d(1, 0, 0);
  for (const SolveStatus status : {SolveStatus::saddle, SolveStatus::roundoff_limited}) {
    shape.status = status;
    EXPECT_TRUE(is_refused(problem, shape)) << to_string(status);
  }
  for (const SolveStatus status : {SolveStatus::failed, SolveStatus::evaluation_limit,
                                   SolveStatus::near_singular, SolveStatus::not_verified}) {
    Equilibrium other = shape;
    other.status = status;
    judge_balance(problem, other);
    EXPECT_EQ(other.status, status);
    EXPECT_EQ(other.message, shape.message);
  }
}

}  // namespace
}  // namespace dlo::energy_model
