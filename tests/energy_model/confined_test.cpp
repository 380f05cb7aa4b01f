// Tests of rods that are confined to their plane. Their shapes are equilibria of the free rod too,
// as the other solver confirms, but may be stable only in the plane.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "../says.hpp"
#include "dlo/energy_model/dynamics.hpp"
#include "dlo/energy_model/energy.hpp"
#include "dlo/energy_model/exact.hpp"
#include "dlo/energy_model/vibrations.hpp"
#include "problems.hpp"
#include "solved.hpp"

namespace dlo::energy_model {
namespace {

/// Returns a rod that is held against its natural curvature: without confinement it turns over.
Problem rod_against_natural_curvature(double gamma, double span) {
  Problem problem = test::two_clamps(gamma, span);
  problem.torsional_stiffness = 0.4;
  problem.natural_strains = {{0, -7, 0}, {0, 1.5, 0}};
  return problem;
}

Problem confined(Problem problem) {
  problem.confined_to_plane = true;
  return problem;
}

double out_of_plane(const Equilibrium& rod) {
  return rod.sample(equal_arc_lengths(1, 41)).points.row(2).cwiseAbs().maxCoeff();
}

TEST(ConfinedRod, IsAnEquilibriumThatIsUnstableWhereNothingConfinesIt) {
  for (const double gamma : {0.0, 30.0, 200.0}) {
    const Problem problem = rod_against_natural_curvature(gamma, 0.6);
    const Equilibrium flat = test::converged(solve_energy(confined(problem)));
    EXPECT_LT(out_of_plane(flat), 1e-14);
    const Equilibrium free = test::converged(solve_energy(problem));
    EXPECT_GT(out_of_plane(free), 0.01);
    EXPECT_LT(free.energy.total(), flat.energy.total());
    const Equilibrium confirmed = solve_exact(problem, {.start = &flat});
    EXPECT_EQ(confirmed.status, SolveStatus::saddle) << confirmed.message;
    EXPECT_NEAR(confirmed.energy.total(), flat.energy.total(), 1e-8);
    EXPECT_LT(test::largest_point_distance(confirmed, flat), 1e-8);
  }
}

// If the free rod is stable in its plane, the confined rod has the same energy.
TEST(ConfinedRod, IsTheFreeOneWhereThatStaysInItsPlane) {
  for (const Problem& problem : {test::heavy_cantilever(12, 30), test::two_clamps(40, 0.7)}) {
    const Equilibrium free = solve_energy(problem);
    const Equilibrium flat = test::converged(solve_energy(confined(problem)));
    EXPECT_NEAR(flat.energy.total(), free.energy.total(), 1e-12 * std::abs(free.energy.total()));
    EXPECT_LT(flat.error_estimate, 1e-6);
  }
}

// Out of its plane a buckled column may rotate about the vertical.
TEST(ConfinedRod, HasNoZeroModeOutOfThePlane) {
  const Problem column = test::heavy_cantilever(40, 90);
  EXPECT_EQ(test::converged(all_energy(column).front()).message, "converged, 1 zero mode");
  EXPECT_EQ(test::converged(all_energy(confined(column)).front()).message, "converged");
}

// A shape out of the plane is not a valid initial guess.
TEST(ConfinedRod, DoesNotFollowAShapeOutOfThePlane) {
  const Problem problem = rod_against_natural_curvature(30, 0.6);
  const Equilibrium free = solve_energy(problem);
  const Equilibrium flat = test::converged(solve_energy(confined(problem), {.start = &free}));
  EXPECT_LT(out_of_plane(flat), 1e-14);
  EXPECT_NEAR(flat.energy.total(), solve_energy(confined(problem)).energy.total(), 1e-9);
}

TEST(ConfinedRod, RefusesWhatHasNoPlane) {
  const auto refused = [](const Problem& problem, auto&& solve) {
    return test::has_all(
        test::error_of<std::invalid_argument>([&] { return solve(confined(problem)); }),
        {"confined_to_plane"});
  };
  const auto energy = [](const Problem& problem) { return solve_energy(problem); };
  Problem twisted = rod_against_natural_curvature(0, 0.6);
  for (Grip& grip : twisted.grips) grip.frame = FrameHold{};
  EXPECT_TRUE(refused(twisted, energy));
  Problem in_space = test::two_clamps(10, 0.6);
  in_space.grips[1].position.z() = 0.1;
  EXPECT_TRUE(refused(in_space, energy));
  const Problem cantilever = test::heavy_cantilever(1, 0);
  EXPECT_TRUE(refused(cantilever, [](const Problem& problem) { return solve_exact(problem); }));
  EXPECT_TRUE(refused(cantilever, [&](const Problem& problem) {
    return vibrations(problem, {.mass_per_length = 1}, solve_energy(cantilever));
  }));
  EXPECT_TRUE(refused(cantilever, [](const Problem& problem) {
    MovingRod rod{.problem = problem, .inertia = {.mass_per_length = 1}};
    return simulate(rod, straight_rod(Eigen::Vector3d::UnitX()), std::vector<double>{0.1});
  }));
}

}  // namespace
}  // namespace dlo::energy_model
