// Tests of the material director d1 of a round straight rod that clamps twist: it agrees with the
// clamps, is perpendicular to the tangent, and rotates at a rate that is constant in each section,
// relative to a frame that is transported without twist.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "dlo/energy_model/energy.hpp"
#include "problems.hpp"
#include "solved.hpp"

namespace dlo::energy_model {
namespace {

/// Clamps that do not fit each other, and weight.
Problem rolled_section(double roll) {
  Problem problem = test::heavy_cantilever(3, 0);
  problem.torsional_stiffness = 0.7;
  problem.grips = {
      {0, {0.1, 0, 0}, Vector3d(1, 0.2, 0), FrameHold{Vector3d(0, 0, 1), 0.3}},
      {1, {0.7, 0.2, 0.1}, Vector3d(0.8, 0.3, -0.5), FrameHold{Vector3d(0, 1, 1), roll}}};
  return problem;
}

/// Returns the d1 that a clamp holds: the given d1 without its part along the direction, rotated by
/// the roll.
Vector3d held_d1(const Grip& clamp) {
  const Vector3d t = clamp.direction->normalized();
  const Vector3d d1 = (*clamp.frame->d1 - clamp.frame->d1->dot(t) * t).normalized();
  return Eigen::AngleAxisd(clamp.frame->roll, t) * d1;
}

void expect_unit_and_across(const Samples& samples) {
  ASSERT_EQ(samples.d1.cols(), samples.points.cols());
  for (Eigen::Index i = 0; i < samples.d1.cols(); ++i) {
    EXPECT_NEAR(samples.d1.col(i).norm(), 1, 1e-12);
    EXPECT_NEAR(samples.d1.col(i).dot(samples.tangents.col(i)), 0, 1e-12);
  }
}

/// Returns the angles by which d1 turns from sample to sample against a director that is carried
/// along without twist.
std::vector<double> turns(const Samples& samples) {
  std::vector<double> angles;
  for (Eigen::Index i = 0; i + 1 < samples.points.cols(); ++i) {
    const Vector3d to = samples.tangents.col(i + 1);
    const Vector3d carried = test::carried(samples, i, samples.d1.col(i));
    const Vector3d d1 = samples.d1.col(i + 1);
    angles.push_back(std::atan2(to.dot(carried.cross(d1)), carried.dot(d1)));
  }
  return angles;
}

TEST(TwistedMaterial, IsWhereBothClampsHoldItWhateverTheTwist) {
  for (const double roll : {0.0, 1.0, -2.5, 2 * pi, 9.0}) {
    const Problem problem = rolled_section(roll);
    const Equilibrium found = test::require_usable(solve_energy(problem));
    const Samples samples = found.sample(equal_arc_lengths(1, 21));
    expect_unit_and_across(samples);
    // Within the allowed error of the end's frame.
    EXPECT_LT((samples.d1.col(0) - held_d1(problem.grips[0])).norm(), 1e-9) << roll;
    EXPECT_LT((samples.d1.rightCols<1>() - held_d1(problem.grips[1])).norm(), 1e-9) << roll;
  }
}

TEST(TwistedMaterial, TurnsEvenlyAndBySectionsAsTheirTorsionalStiffnessesSay) {
  constexpr Eigen::Index steps = 800;
  for (const bool has_section : {false, true}) {
    Problem problem = rolled_section(4);
    if (has_section) problem.sections = {{0.25, 0.5, 1, 2.1, problem.weight_per_length}};
    const Equilibrium found = test::require_usable(solve_energy(problem));
    const std::vector<double> angles = turns(found.sample(equal_arc_lengths(1, steps + 1)));
    double sum = 0;
    for (Eigen::Index i = 0; i < steps; ++i) {
      const double angle = angles[static_cast<std::size_t>(i)];
      const double GJ = has_section && i >= steps / 4 && i < steps / 2 ? 2.1 : 0.7;
      // The torque is that at the clamp, which the balance of moments gives.
      EXPECT_NEAR(angle, found.twists.at(0).torque / GJ / steps, 1e-8) << i;
      sum += angle;
    }
    EXPECT_NEAR(sum, found.twists.at(0).angle, 1e-6);
  }
}

TEST(TwistedMaterial, GoesOnWithoutTwistBesideWhatIsTwisted) {
  // The rod extends beyond both clamps, where it is not twisted.
  Problem problem = rolled_section(2);
  problem.grips[0].at = 0.2;
  problem.grips[1].at = 0.8;
  problem.grips[1].position = problem.grips[0].position + Vector3d(0.4, 0.1, 0.1);
  const Equilibrium found = test::require_usable(solve_energy(problem));
  constexpr Eigen::Index steps = 1000;
  const Samples samples = found.sample(equal_arc_lengths(1, steps + 1));
  expect_unit_and_across(samples);
  const std::vector<double> angles = turns(samples);
  const double rate = found.twists.at(0).angle / 0.6;
  for (Eigen::Index i = 0; i < steps; ++i) {
    const bool twisted = i >= 200 && i < 800;
    EXPECT_NEAR(angles[static_cast<std::size_t>(i)], twisted ? rate / steps : 0, 1e-8) << i;
  }
  EXPECT_LT((samples.d1.col(200) - held_d1(problem.grips[0])).norm(), 1e-9);
  EXPECT_LT((samples.d1.col(800) - held_d1(problem.grips[1])).norm(), 1e-9);
}

TEST(TwistedMaterial, IsThatOfARodWithMaterialDirectors) {
  // An equal second stiffness makes it a rod whose frame is among the solver's unknowns.
  const Problem round = rolled_section(1.5);
  Problem with_directors = round;
  with_directors.bending_stiffness_2 = round.bending_stiffness;
  const Equilibrium a = solve_energy(round);
  const Equilibrium b = solve_energy(with_directors, {.start = &a});
  ASSERT_TRUE(succeeded(a.status) && succeeded(b.status)) << a.message << ", " << b.message;
  const std::vector<double> s = equal_arc_lengths(1, 41);
  ASSERT_LT(test::largest_point_distance(a, b, s), 1e-8);
  EXPECT_LT((a.sample(s).d1 - b.sample(s).d1).colwise().norm().maxCoeff(), 1e-7);
}

TEST(TwistedMaterial, IsLeftOutWhereNothingIsTwisted) {
  EXPECT_EQ(solve_energy(test::two_clamps(3, 0.8)).sample(equal_arc_lengths(1, 3)).d1.size(), 0);
}

}  // namespace
}  // namespace dlo::energy_model
