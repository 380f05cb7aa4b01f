// Tests of rods on rigid obstacles between clamps that hold their frames, and of rods with material
// directors there: balance, derivatives of the energy by the floor's height and a clamp's roll,
// and elastic polygons.

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "contact_samples.hpp"
#include "dlo/energy_model/energy.hpp"
#include "dlo/energy_model/polygon.hpp"
#include "equilibrium_balance.hpp"
#include "polygon_of_rod.hpp"
#include "problems.hpp"
#include "rolled_clamps.hpp"
#include "solved.hpp"

namespace dlo::energy_model {
namespace {

/// Returns a rod between two clamps on one line, 0.7 l apart; the second is rotated by `roll`.
Problem framed_rod(double gamma, double roll) {
  return test::framed_clamps(gamma, 0.7, 0.75, roll);
}

Obstacle floor_at(double height) { return {obstacle::Body::half_space({0, height, 0}, {0, 1, 0})}; }

Problem with_floor_at(Problem problem, double height) {
  problem.obstacles = {floor_at(height)};
  return problem;
}

Equilibrium solved_touching(const Problem& problem) {
  Equilibrium result = test::require_usable(solve_energy(problem));
  EXPECT_FALSE(result.contacts.empty());
  EXPECT_LE(result.penetration, allowed_penetration * problem.length);
  test::expect_only_pushed(problem, result);
  return result;
}

/// Returns the derivative of the energy by a parameter of the problem, by differences of
/// neighbouring solutions.
template <typename Make>
double energy_rate(const Make& make, double at) {
  constexpr double h = 1e-4;
  return (solved_touching(make(at + h)).energy.total() -
          solved_touching(make(at - h)).energy.total()) /
         (2 * h);
}

/// Returns the balance with contacts replaced by loads; expects that all contacts are at points.
test::BalanceDefects balance_with_contacts(Problem problem, const Equilibrium& shape) {
  for (const ContactPart& contact : shape.contacts) {
    EXPECT_NE(contact.kind, ContactKind::lying);
    problem.loads.push_back({contact.begin, contact.force});
  }
  return test::balance_of(problem, shape, 0.01);
}

TEST(TwistedContact, ForcesAndTorquesBalanceOverAPeg) {
  for (const double roll : {0.5, 2.0, 4.0}) {
    SCOPED_TRACE("roll " + std::to_string(roll));
    Problem problem = framed_rod(30, roll);
    const Equilibrium free = solve_energy(problem);
    const Eigen::Vector3d middle = test::point_at(free, 0.5);
    problem.obstacles = {
        {obstacle::Body::cylinder(middle - Eigen::Vector3d(0, 0.03, 0), {0.2, 0, 1}, 0.08)}};
    const Equilibrium result = solved_touching(problem);
    EXPECT_LT(balance_with_contacts(problem, result).worst(), 1e-8);
  }
}

TEST(TwistedContact, EnergyChangesByTheFloorsForceAndTheClampsTorque) {
  for (const double roll : {0.3, 1.5, 3.0}) {
    SCOPED_TRACE("roll " + std::to_string(roll));
    const double height = -0.15;
    const Equilibrium result = solved_touching(with_floor_at(framed_rod(100, roll), height));
    const auto with_floor = [&](double at) { return with_floor_at(framed_rod(100, roll), at); };
    const auto with_roll = [&](double at) { return with_floor_at(framed_rod(100, at), height); };
    EXPECT_NEAR(energy_rate(with_floor, height), result.obstacles[0].y(),
                1e-4 * result.obstacles[0].norm());
    EXPECT_NEAR(energy_rate(with_roll, roll), result.twists.at(0).torque, 1e-4);
    Eigen::Vector3d forces(0, -100, 0);
    for (const Reaction& grip : result.grips) forces += grip.force;
    EXPECT_LT((forces + result.obstacles[0]).norm(), 1e-7);
  }
}

TEST(TwistedContact, PolygonsOfMoreSegmentsComeNearer) {
  const Problem problem = with_floor_at(framed_rod(60, 2), -0.15);
  const Equilibrium rod = solved_touching(problem);
  double before = 1;
  for (const Eigen::Index segments : {32, 64, 128}) {
    const test::PolygonOfRod polygon(problem, rod, segments);
    const PolygonResult rest = test::require_usable(polygon.at_rest());
    const double moved = (rest.points - polygon.points).colwise().norm().maxCoeff();
    EXPECT_LT(moved, before / 2);
    before = moved;
  }
  EXPECT_LT(before, 1e-3);
}

TEST(TwistedContact, WhatTouchesOnlyOnceItIsTwistedIsFound) {
  // Without twist the rod hangs in its plane; the wall is next to it.
  Problem problem = framed_rod(5, 6);
  const Equilibrium free = test::require_usable(solve_energy(problem));
  const auto s = equal_arc_lengths(1, 101);
  const Eigen::VectorXd z = free.sample(s).points.row(2);
  const double side = z.maxCoeff() > -z.minCoeff() ? 1 : -1;
  const double farthest = side > 0 ? z.maxCoeff() : -z.minCoeff();
  ASSERT_GT(farthest, 0.05);
  problem.obstacles = {{obstacle::Body::half_space({0, 0, side * farthest / 2}, {0, 0, -side})}};
  const Equilibrium result = solved_touching(problem);
  EXPECT_LT(side * result.obstacles[0].z(), 0);
}

TEST(TwistedContact, IsFollowedWhileTheFloorRisesAndTheClampTurns) {
  EnergySolver solver;
  ASSERT_TRUE(succeeded(solver.solve(with_floor_at(framed_rod(60, 1), -0.15)).status));
  for (int i = 1; i <= 5; ++i) {
    const Problem problem = with_floor_at(framed_rod(60, 1 + 0.1 * i), -0.15 + 0.005 * i);
    const Equilibrium followed = test::require_usable(solver.follow(problem));
    EXPECT_NEAR(followed.energy.total(), solved_touching(problem).energy.total(), 1e-8);
  }
  EXPECT_TRUE(solver.followed());
}

TEST(TwistedContact, StartedFromItsOwnShapeItIsConfirmed) {
  const Problem problem = with_floor_at(framed_rod(60, 2), -0.15);
  const Equilibrium rod = solved_touching(problem);
  const Equilibrium again = test::require_usable(solve_energy(problem, {.start = &rod}));
  EXPECT_NEAR(again.energy.total(), rod.energy.total(), 1e-9);
  EXPECT_LT(again.evaluations, rod.evaluations);
}

enum class Held { one_clamp, two_clamps, frames };

Problem rod_held_by(Held held) {
  Problem problem = test::heavy_cantilever(60, 0);
  problem.torsional_stiffness = 0.75;
  if (held != Held::one_clamp) {
    problem.grips.push_back({1, {0.75, 0.02, 0}, Eigen::Vector3d(1, 0, 0)});
  }
  if (held != Held::frames) return problem;
  problem.grips[0].frame = FrameHold{};
  problem.grips[1].frame = FrameHold{};
  problem.grips[1].frame->roll = 0.8;
  return problem;
}

struct MaterialRod {
  const char* name;
  void (*change)(Problem&);
};

const std::vector<MaterialRod>& material_rods() {
  static const std::vector<MaterialRod> all = {
      {"strip", [](Problem& problem) { problem.bending_stiffness_2 = 2; }},
      {"sections",
       [](Problem& problem) {
         problem.sections = {{0.3, 0.6, 2, 1.5, {0, -90, 0}}};
       }},
      {"intrinsically curved in the plane",
       [](Problem& problem) {
         problem.natural_strains = {{0, 0.8, 0}};
       }},
      {"intrinsically curved in space", [](Problem& problem) {
         problem.natural_strains = {{0.5, 0.3, 0.4}};
       }}};
  return all;
}

TEST(TwistedContact, StripsSectionsAndCurvedRodsLieOnFloors) {
  for (const Held held : {Held::one_clamp, Held::two_clamps, Held::frames}) {
    for (const MaterialRod& rod : material_rods()) {
      SCOPED_TRACE(std::string(rod.name) + ", held " + std::to_string(static_cast<int>(held)));
      const auto with_floor = [&](double at) {
        Problem problem = rod_held_by(held);
        rod.change(problem);
        return with_floor_at(problem, at);
      };
      constexpr double height = -0.12;
      const Equilibrium found = solve_energy(with_floor(height));
      // The search may reject an intrinsically curved rod that lies on the floor up to near its
      // free end, where it rises again.
      if (held == Held::one_clamp && !succeeded(found.status)) {
        EXPECT_EQ(found.status, SolveStatus::not_verified) << found.message;
        EXPECT_NE(found.message.find("contacts did not converge"), std::string::npos);
        EXPECT_FALSE(with_floor(height).natural_strains.empty());
        continue;
      }
      const Equilibrium result = solved_touching(with_floor(height));
      EXPECT_NEAR(energy_rate(with_floor, height), result.obstacles[0].y(),
                  1e-4 * result.obstacles[0].norm());
    }
  }
}

}  // namespace
}  // namespace dlo::energy_model
