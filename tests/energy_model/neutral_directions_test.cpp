// Tests of the number of neutral directions that is reported for shapes near a fold or a
// bifurcation. Rigid-body modes do not count.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "dlo/energy_model/energy.hpp"
#include "dlo/energy_model/exact.hpp"
#include "problems.hpp"
#include "rolled_clamps.hpp"
#include "solved.hpp"

namespace dlo::energy_model {
namespace {

/// Short of self-buckling, at Gamma = 7.8373474, by this share and 6e-8.
Problem upright(double below) { return heavy_cantilever(7.837347 * (1 - below), 90); }

Problem strip(Problem problem, double about_d1, double about_d2, double torsion) {
  problem.bending_stiffness = about_d1;
  problem.bending_stiffness_2 = about_d2;
  problem.torsional_stiffness = torsion;
  return problem;
}

void expect_singular(const Equilibrium& found, int directions) {
  EXPECT_EQ(found.status, SolveStatus::near_singular) << found.message;
  EXPECT_EQ(found.neutral_directions, directions) << found.smallest_eigenvalue;
  EXPECT_NE(found.message.find(std::to_string(directions) + " neutral direction"),
            std::string::npos)
      << found.message;
}

void expect_regular(const Equilibrium& found) {
  EXPECT_EQ(found.status, SolveStatus::converged) << found.message;
  EXPECT_EQ(found.neutral_directions, 0);
}

TEST(NeutralDirections, AnUprightRoundRodHasTwoNextToBuckling) {
  // A plain cantilever, and one with a section like the rest of it, which is solved in another way.
  for (const bool plain : {true, false}) {
    const auto solved = [&](double below) {
      Problem problem = upright(below);
      if (!plain) problem.sections = {{0.4, 0.7, 1, 0, problem.weight_per_length}};
      return solve_energy(problem);
    };
    SCOPED_TRACE(plain);
    for (const double below : {1e-8, 1e-9}) expect_singular(solved(below), 2);
    for (const double below : {1e-3, 1e-6}) expect_regular(solved(below));
  }
}

TEST(NeutralDirections, AStripHasOneWhicheverWayItIsWeak) {
  // The direction of the smaller stiffness is in the plane of the solver, or perpendicular to it.
  expect_singular(solve_energy(strip(upright(1e-9), 4, 1, 1)), 1);
  expect_singular(solve_energy(strip(upright(1e-9), 1, 4, 1)), 1);
  expect_regular(solve_energy(strip(upright(1e-6), 1, 4, 1)));
}

TEST(NeutralDirections, EulersColumnHasTwoAtItsLoadAndIsNoBetterDeterminedThere) {
  // The smallest eigenvalue is 1 - P / (pi/2)^2. It still counts as zero if the load is below
  // buckling by half of `zero_eigenvalue_limit`.
  const auto column = [](double below) {
    Problem problem = heavy_cantilever(0, 90);
    problem.grips[0].direction = Eigen::Vector3d::UnitX();
    problem.loads = {{1, {-pi * pi / 4 * (1 - below), 0, 0}}};
    return solve_energy(problem);
  };
  for (const double below : {0.0, 1e-12, 5e-8}) expect_singular(column(below), 2);
  expect_regular(column(2e-7));
}

TEST(NeutralDirections, AnArchThatSnapsHasOneAtItsFold) {
  // The strip is stiff sideways. The load is off the middle, so that the branch ends at a fold,
  // near which the smallest eigenvalue is proportional to the root of the distance of the load.
  const auto arch = [](double force) {
    Problem problem = strip(two_clamps(0, 0.9), 50, 1, 50);
    problem.loads = {{0.45, {0, -force, 0}}};
    return problem;
  };
  const auto height = [](const Equilibrium& equilibrium) {
    return equilibrium.sample ? test::point_at(equilibrium, 0.5).y() : -1;
  };
  const std::vector<Equilibrium> all = all_energy(arch(20));
  const auto up = std::find_if(all.begin(), all.end(), [&](const Equilibrium& found) {
    return succeeded(found.status) && height(found) > 0;
  });
  ASSERT_NE(up, all.end());
  Equilibrium on_branch = *up;
  double low = 20;
  double high = 40;
  while (succeeded(on_branch.status)) {
    const double force = (low + high) / 2;
    ASSERT_TRUE(low < force && force < high) << "no shape between the last stable one and none";
    Equilibrium next = solve_energy(arch(force), {.start = &on_branch});
    const bool holds = next.status != SolveStatus::saddle && height(next) > 0.1;
    (holds ? low : high) = force;
    if (holds) on_branch = std::move(next);
  }
  expect_singular(on_branch, 1);
  EXPECT_NEAR(on_branch.smallest_eigenvalue, 0, 1e-6);
}

TEST(NeutralDirections, RigidBodyModesAreNotCounted) {
  for (const double gamma : {0.0, 1.0, 30.0}) {
    // The rod hangs between pins above each other, between clamps along that line, or twisted
    // between such clamps. It may rotate about the line.
    Problem problem = heavy_cantilever(gamma, 0);
    problem.torsional_stiffness = 0.8;
    for (const int kind : {0, 1, 2}) {
      SCOPED_TRACE(testing::Message() << "Gamma " << gamma << ", " << kind);
      const Eigen::Vector3d down = -Eigen::Vector3d::UnitY();
      problem.grips = {{0, {0, 0, 0}}, {1, 0.7 * down}};
      for (Grip& grip : problem.grips) {
        if (kind > 0) grip.direction = down;
      }
      if (kind == 2) {
        problem.grips[0].frame = FrameHold{};
        problem.grips[1].frame = FrameHold{.roll = 1};
      }
      const Equilibrium found = solve_energy(problem);
      expect_regular(found);
      EXPECT_NEAR(found.smallest_eigenvalue, 0, 1e-9);
      EXPECT_LT(found.error_estimate, 1e-6);
    }
  }
  // The weight prevents rotation about the line of the two pins, so there is no zero mode.
  Problem across = heavy_cantilever(10, 0);
  across.grips = {{0, {0, 0, 0}}, {1, {0.7, 0, 0}}};
  EXPECT_GT(solve_energy(across).smallest_eigenvalue, 1e-3);
  // Rotation of a straight rod about its own line does not change its shape and is no zero mode.
  expect_regular(solve_energy(heavy_cantilever(3, -90)));
}

// For an infinite rod, cos(theta) = M / (2 (B T)^(1/2)) gives the homoclinic helix a slack D = 4
// sin(theta) (B / T)^(1/2) and ends that are rotated by M L / C + 4 theta (Coyne 1990). The
// curvature decreases by exp(2 sin(theta)^2 / D) from the middle to the ends.
void expect_sliding_helix(double slack, const char* message) {
  SCOPED_TRACE(slack);
  constexpr double theta = 0.4;
  constexpr double torsion = 0.8;
  const double tension = std::pow(4 * std::sin(theta) / slack, 2);
  const double torque = 2 * std::cos(theta) * std::sqrt(tension);
  const double roll = torque / torsion + 4 * theta;
  const Equilibrium found = solve_energy(test::framed_clamps(0, 1 - slack, torsion, roll));
  ASSERT_EQ(found.status, SolveStatus::converged) << found.message;
  EXPECT_TRUE(found.message.starts_with(message)) << found.message;
  EXPECT_EQ(found.neutral_directions, 0);
  EXPECT_NEAR(found.smallest_eigenvalue, 0, 1e-7);
  // The clamps change the forces by the square of the curvature at the ends.
  const double share = 1e-6 + 40 * std::exp(-4 * std::pow(std::sin(theta), 2) / slack);
  EXPECT_NEAR(found.twists.at(0).torque, torque, share * torque);
  EXPECT_NEAR(found.grips[1].force.x(), tension, share * tension);
  EXPECT_NEAR(found.twists.at(0).angle, torque / torsion, share * torque);
}

TEST(NeutralDirections, AHelixThatMaySlideAlongTheRodHasAZeroMode) {
  // The second zero mode is rotation about the line between the clamps.
  expect_sliding_helix(0.025, "converged, 2 zero modes");
}

// The straight rod with few coefficients is unstable at 24 turns. The helix needs twice as many.
TEST(NeutralDirections, TheHelixOf25TurnsIsListed) {
  constexpr double slack = 0.03;
  constexpr double torsion = 0.789 / 1.345;
  constexpr double roll = 50 * std::numbers::pi;
  Problem problem = two_clamps(0, 1 - slack);
  problem.torsional_stiffness = torsion;
  problem.grips[0].direction = Eigen::Vector3d::UnitX();
  problem.grips[0].frame = FrameHold{};
  problem.grips[1].frame = FrameHold{.roll = roll};
  const Equilibrium found = all_energy(problem).front();
  ASSERT_EQ(found.status, SolveStatus::converged) << found.message;
  const double tension = found.grips[1].force.x();
  const double torque = found.twists.at(0).torque;
  const double theta = std::acos(torque / (2 * std::sqrt(tension)));
  EXPECT_NEAR(4 * std::sin(theta) / std::sqrt(tension), slack, 1e-3 * slack);
  EXPECT_NEAR(torque / torsion + 4 * theta, roll, 1e-3 * roll);
}

// The eigenvalue of the shift is small, of the order of exp(-4 sin(theta)^2 / D), but not zero.
TEST(NeutralDirections, AHelixThatSlidesAgainstItsEndsIsDetermined) {
  for (const double slack : {0.0361, 0.0353, 0.0345, 0.033}) {
    expect_sliding_helix(slack, "converged, ");
  }
}

TEST(NeutralDirections, MessagesOfBothSolversCountZeroModes) {
  Problem arch = heavy_cantilever(0, 0);
  arch.grips = {{0, {0, 0, 0}, std::nullopt}, {1, {0.8, 0, 0}, std::nullopt}};
  Problem pendant = heavy_cantilever(20, 0);
  pendant.grips = {{0, {0, 0, 0}, std::nullopt}, {1, {0, -0.6, 0}, std::nullopt}};
  for (const Problem& problem :
       {arch, pendant, heavy_cantilever(8, 90), heavy_cantilever(20, 90)}) {
    const Equilibrium energy = test::converged(solve_energy(problem));
    EXPECT_EQ(energy.message, "converged, 1 zero mode");
    EXPECT_EQ(energy.message, solve_exact(problem).message);
  }
  // A load across the line of two pins prevents rotation about it.
  Problem pushed = arch;
  pushed.loads = {{0.4, {0, -3, 0}}};
  for (const Problem& problem : {pushed, heavy_cantilever(1, 0), heavy_cantilever(1, -90)}) {
    EXPECT_EQ(solve_energy(problem).message, "converged");
    EXPECT_EQ(solve_exact(problem).message, "converged");
  }
}

}  // namespace
}  // namespace dlo::energy_model
