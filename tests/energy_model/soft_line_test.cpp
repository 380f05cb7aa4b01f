// Tests of catenaries with bending layers: against closed forms, and against the rod's own models
// where these still resolve the layers.

#include "dlo/energy_model/soft_line.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "dlo/energy_model/energy.hpp"
#include "dlo/energy_model/exact.hpp"
#include "dlo/energy_model/taut_line.hpp"
#include "solved.hpp"

namespace dlo::energy_model {
namespace {

/// Returns a line with l = 1, w = 1 along -z, EI = `stiffness`.
Problem line(double stiffness) {
  Problem problem;
  problem.length = 1;
  problem.bending_stiffness = stiffness;
  problem.weight_per_length = {0, 0, -1};
  return problem;
}

Problem between_pins(double stiffness, const Vector3d& end) {
  Problem problem = line(stiffness);
  problem.grips = {{0, {0.1, 0.2, 0.3}, {}, {}}, {1, Vector3d(0.1, 0.2, 0.3) + end, {}, {}}};
  return problem;
}

/// Returns a line between clamps whose directions are out of the plane of the catenary.
Problem between_clamps(double stiffness) {
  Problem problem = between_pins(stiffness, {0.7, 0.1, 0.2});
  problem.grips[0].direction = Vector3d(0.3, 1, 0.4);
  problem.grips[1].direction = Vector3d(1, -0.4, -0.1);
  return problem;
}

/// Returns the largest distance of two shapes at equal arc lengths, for l = 1.
double largest_line_distance(const Equilibrium& a, const Equilibrium& b) {
  return test::largest_point_distance(a, b, equal_arc_lengths(1, 501));
}

// Neither a catenary nor a line that is pulled straight includes a stream.
TEST(SoftLine, IsNoneOfLoadsWithoutAPotential) {
  Problem dragged = between_pins(1e-12, {0.7, 0, 0.1});
  dragged.drag = Drag{.velocity = {0, 1, 0}, .normal = 0.2};
  EXPECT_FALSE(catenary_limit(dragged).has_value());
  EXPECT_THROW((void)solve_energy(dragged), std::invalid_argument);
  Problem taut = between_pins(1, {0, 0, -1});  // hangs, so that no force is across it
  EXPECT_TRUE(taut_line(taut).has_value());
  taut.drag = dragged.drag;
  EXPECT_FALSE(taut_line(taut).has_value());
  EXPECT_THROW((void)solve_energy(taut), std::invalid_argument);
}

// The sanitizers report an access to a destroyed problem.
TEST(SoftLine, OutlivesItsProblem) {
  Equilibrium kept;
  {
    const Problem problem = between_clamps(1e-12);
    kept = solve_exact(problem);
  }
  EXPECT_EQ(largest_line_distance(kept, solve_exact(between_clamps(1e-12))), 0);
}

TEST(SoftLine, HasTheTensionOfTheCatenary) {
  // End of a catenary with the parameter a = 0.4, for arc lengths from -0.3 to 0.7.
  const double a = 0.4;
  const Vector3d end((std::asinh(0.7 / a) + std::asinh(0.3 / a)) * a, 0,
                     std::hypot(a, 0.7) - std::hypot(a, 0.3));
  const Problem problem = between_pins(1e-12, end);
  for (const Equilibrium& solved : {solve_energy(problem), solve_exact(problem)}) {
    ASSERT_EQ(solved.status, SolveStatus::converged) << solved.message;
    EXPECT_LT((solved.grips[0].force - Vector3d(-a, 0, 0.3)).norm(), 1e-12);
    EXPECT_LT((solved.grips[1].force - Vector3d(a, 0, 0.7)).norm(), 1e-12);
    EXPECT_LT(solved.error_estimate, 1e-10);
    EXPECT_NEAR(test::point_at(solved, 0.3).z(), 0.3 + a - std::hypot(a, 0.3), 1e-12);
  }
}

TEST(SoftLine, IsAsNearToTheRodAsItSays) {
  for (const auto& make : {between_clamps, +[](double stiffness) {
                             return between_pins(stiffness, {0.6, 0, -0.3});
                           }}) {
    double before = 0;
    for (const double stiffness : {1e-5, 1e-6, 1e-7}) {
      const Problem problem = make(stiffness);
      const std::optional<Equilibrium> soft = catenary_limit(problem);
      ASSERT_TRUE(soft);
      const Equilibrium rod = test::converged(solve_energy(problem));
      const double missed = largest_line_distance(*soft, rod);
      EXPECT_LT(missed, soft->error_estimate) << stiffness;
      // The error is of second order in the length of the bending layers; this length is
      // proportional to EI^(1/2).
      if (before > 0) {
        EXPECT_GT(before / missed, 7) << stiffness;
      }
      before = missed;
      const double share = 30 * std::sqrt(stiffness);
      EXPECT_LT((soft->grips[0].force - rod.grips[0].force).norm(), 3 * soft->error_estimate);
      EXPECT_NEAR(soft->energy.bending / rod.energy.bending, 1, share);
      EXPECT_NEAR(soft->energy.total(), rod.energy.total(), 3 * soft->error_estimate);
      for (const std::size_t i : {0U, 1U}) {
        EXPECT_LE((soft->grips[i].torque - rod.grips[i].torque).norm(),
                  share * rod.grips[i].torque.norm() + 1e-12);
      }
    }
  }
}

TEST(SoftLine, HangsFromAClamp) {
  double before = 0;
  for (const double stiffness : {1e-4, 1e-5}) {
    Problem problem = line(stiffness);
    problem.grips = {{1, {0, 0, 0}, Vector3d(-1, 0, 0.3), {}}};
    const std::optional<Equilibrium> soft = catenary_limit(problem);
    ASSERT_TRUE(soft);
    const Equilibrium rod = solve_energy(problem);
    const double missed = largest_line_distance(*soft, rod);
    EXPECT_LT(missed, soft->error_estimate);
    if (before > 0) {
      EXPECT_GT(before / missed, 7);
    }
    before = missed;
    EXPECT_NEAR(soft->grips[0].torque.y() / rod.grips[0].torque.y(), 1, 10 * std::sqrt(stiffness));
    EXPECT_NEAR(soft->grips[0].force.z(), 1, 1e-14);
  }
}

/// Returns a line with a pin on the floor at the origin and one above it.
Problem on_floor(double stiffness) {
  Problem problem = line(stiffness);
  problem.grips = {{0, {0, 0, 0}, {}, {}}, {1, {0.9, 0, 0.3}, {}, {}}};
  problem.obstacles = {{obstacle::Body::half_space({0, 0, 0}, Vector3d::UnitZ())}};
  return problem;
}

TEST(SoftLine, LiesOnAFloor) {
  const Equilibrium soft = test::converged(solve_energy(on_floor(1e-12)));
  ASSERT_EQ(soft.contacts.size(), 1U);
  const ContactPart& part = soft.contacts[0];
  // The end of the contact interval and the pin bound the free arm, a catenary. Its length equals
  // its weight.
  const double arm = 1 - part.end;
  const double a = soft.grips[1].force.x();
  EXPECT_NEAR(soft.grips[1].force.z(), arm, 2e-6);
  EXPECT_NEAR(std::hypot(a, arm) - a, 0.3, 2e-6);
  EXPECT_NEAR(part.end + a * std::asinh(arm / a), 0.9, 2e-6);
  EXPECT_NEAR(part.force.z(), part.end, 2e-6);
  EXPECT_NEAR(part.end_force, std::sqrt(1e-12 / a), 1e-15);
  EXPECT_EQ(part.begin, 0);
}

TEST(SoftLine, LiftsOffAsTheRodDoes) {
  const Problem problem = on_floor(1e-5);
  const std::optional<Equilibrium> soft = catenary_limit(problem);
  ASSERT_TRUE(soft);
  const Equilibrium rod = test::require_usable(solve_energy(problem));
  EXPECT_LT(largest_line_distance(*soft, rod), soft->error_estimate);
  ASSERT_EQ(rod.contacts.size(), 1U);
  EXPECT_NEAR(soft->contacts[0].end, rod.contacts[0].end, 1e-3);
  EXPECT_NEAR(soft->contacts[0].end_force / rod.contacts[0].end_force, 1, 0.05);
}

// A rod that is pulled straight along (3, 4, 0), 1e10 m from the origin: its ends are numbers of
// double precision there, but the point at which its load acts is rounded by up to 1e-6, so that
// the moments do not balance.
TEST(LineWithoutSearch, IsNotVerifiedWhereItsForcesDoNotBalance) {
  Problem problem = line(1);
  problem.length = 5;
  problem.weight_per_length.setZero();
  problem.loads = {{1, Vector3d(3, 4, 0)}};
  for (const double far : {0.0, 1e10}) {
    problem.grips = {{0, {far, far, 0}, {}, {}}, {5, {far + 3, far + 4, 0}, {}, {}}};
    const std::optional<Equilibrium> taut = shape_without_search(problem);
    ASSERT_TRUE(taut);
    if (far == 0) {
      EXPECT_EQ(taut->status, SolveStatus::converged) << taut->message;
    } else {
      EXPECT_EQ(taut->status, SolveStatus::not_verified);
      EXPECT_NE(taut->message.find("unbalanced force"), std::string::npos) << taut->message;
    }
  }
}

TEST(SoftLine, TakesNothingElse) {
  EXPECT_FALSE(is_catenary_limit(line(1e-9)));
  Problem upright = line(1e-12);
  upright.grips = {{0, {0, 0, 0}, Vector3d::UnitZ(), {}}};
  EXPECT_FALSE(catenary_limit(upright));
  Problem loaded = between_clamps(1e-12);
  loaded.loads = {{0.5, {0, 0, -1}}};
  EXPECT_FALSE(catenary_limit(loaded));
  Problem folded = between_pins(1e-12, {0, 0, 0.2});
  EXPECT_FALSE(catenary_limit(folded));
}

}  // namespace
}  // namespace dlo::energy_model
