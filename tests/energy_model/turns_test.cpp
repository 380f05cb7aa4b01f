// Tests of turns: writhe against closed forms, the zero of a roll, and twist and writhe of the
// solvers' results against the turns that the grips hold.

#include "dlo/energy_model/turns.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>
#include <stdexcept>

#include "dlo/energy_model/energy.hpp"
#include "dlo/energy_model/exact.hpp"
#include "rolled_clamps.hpp"
#include "solved.hpp"

namespace dlo::energy_model {
namespace {

/// `turns` of a helix of a radius and a pitch [m] about the x axis, and its tangents at the ends.
struct HelixShape {
  Eigen::Matrix3Xd points;
  Eigen::Vector3d first;
  Eigen::Vector3d last;
};

HelixShape helix_of(double turns, double radius, double pitch, int points) {
  HelixShape helix;
  helix.points.resize(3, points);
  const auto tangent = [&](double phi) {
    return Eigen::Vector3d(pitch / (2 * pi), -radius * std::sin(phi), radius * std::cos(phi))
        .normalized();
  };
  for (int i = 0; i < points; ++i) {
    const double phi = 2 * pi * turns * i / (points - 1);
    helix.points.col(i) << pitch * phi / (2 * pi), radius * std::cos(phi), radius * std::sin(phi);
  }
  helix.first = tangent(0);
  helix.last = tangent(2 * pi * turns);
  return helix;
}

/// Fuller: a curve that can be laid straight without its tangent passing the opposite direction has
/// the area on the unit sphere between its tangents and the axis as its writhe. For the pitch 0.5
/// some tangents are more than 90 deg from those of the ends, so that crossings are summed.
TEST(Writhe, OfAHelixIsTheAreaOfItsTangents) {
  for (const double pitch : {0.5, 1.0, -1.0}) {
    const HelixShape helix = helix_of(4, 0.1, std::abs(pitch), 2000);
    Eigen::Matrix3Xd points = helix.points;
    Eigen::Vector3d first = helix.first;
    Eigen::Vector3d last = helix.last;
    if (pitch < 0) {  // the mirror image
      points.row(2) *= -1;
      first.z() *= -1;
      last.z() *= -1;
    }
    const double cosine = 1 / std::hypot(1, 2 * pi * 0.1 / pitch);
    const double expected = 4 * (1 - cosine) * (pitch < 0 ? -1 : 1);
    EXPECT_NEAR(writhe(points, first, last)->value.value(), expected, 1e-4);
  }
}

TEST(Writhe, IsNoneInAPlane) {
  Eigen::Matrix3Xd points(3, 50);
  for (int i = 0; i < 50; ++i) points.col(i) << i * 0.02, 0.1 * std::sin(0.2 * i), 0;
  EXPECT_NEAR(writhe(points, Vector3d(1, 1, 0).normalized(), {1, 0, 0})->value.value(), 0, 1e-12);
}

TEST(Writhe, IsUndefinedWhereAnEndsLinePassesThroughTheCurve) {
  Eigen::Matrix3Xd points(3, 5);
  points << 0, 1, 1, -1, -1,  //
      0, 0, 1, 1, -1,         //
      0, 0, 0.2, 0.2, -0.2;
  EXPECT_FALSE(writhe(points, {1, 0, 0}, {0, -1, 0})->value);
  EXPECT_TRUE(writhe(points, Eigen::Vector3d(1, 0, 0.1).normalized(), {0, -1, 0})->value);
}

/// The tangent rotates once more than by the shortest way, so that the writhe modulo two is one. On
/// which side the flat curve passes itself is not defined, and rounding must not decide it.
TEST(Writhe, OfAFlatRingHasNoSign) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  constexpr int size = 300;
  for (const double around : {2 * pi, 5.0, 6.8}) {
    for (int turn = 0; turn < 10; ++turn) {
      const Eigen::Quaterniond rotation =
          Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
              .normalized();
      Eigen::Matrix3Xd points(3, size);
      const auto at = [&](double angle) {
        return Vector3d(std::sin(angle), 1 - std::cos(angle), 0);
      };
      for (int i = 0; i < size; ++i) points.col(i) = rotation * at(around * i / (size - 1));
      const auto found = writhe(points, rotation * Vector3d::UnitX(),
                                rotation * Vector3d(std::cos(around), std::sin(around), 0));
      ASSERT_TRUE(found);
      EXPECT_NEAR(std::abs(found->modulo_two), 1, 1e-9) << around;
      EXPECT_FALSE(found->value) << around << ", " << *found->value;
    }
  }
}

TEST(Writhe, OfAShapeIsAsExactAsItsErrorSays) {
  for (const double turns : {1.0, 4.0, 9.0}) {
    const double pitch = 0.7;
    const double slope = pitch / (2 * pi * 0.1);
    const double length = 2 * pi * turns * 0.1 * std::hypot(1, slope);
    const auto sample = [&](std::span<const double> at) {
      Samples samples;
      samples.points.resize(3, std::ssize(at));
      samples.tangents.resize(3, std::ssize(at));
      for (Eigen::Index i = 0; i < std::ssize(at); ++i) {
        const double phi = 2 * pi * turns * at[static_cast<std::size_t>(i)] / length;
        samples.points.col(i) << pitch * phi / (2 * pi), 0.1 * std::cos(phi), 0.1 * std::sin(phi);
        samples.tangents.col(i) =
            Vector3d(slope, -std::sin(phi), std::cos(phi)) / std::hypot(1, slope);
      }
      return samples;
    };
    const auto found = writhe(sample, 0, length);
    ASSERT_TRUE(found && found->value);
    EXPECT_NEAR(*found->value, turns * (1 - slope / std::hypot(1, slope)), found->error + 1e-12);
    EXPECT_LT(found->error, 1e-6);
  }
}

TEST(Roll, CountsFromTheFrameThatTheShortestRotationBrings) {
  Problem problem = test::rolled_clamps({0.6, 0.2, 0.1}, {0.8, 0.3, -0.5}, 0.8, 1.5);
  problem.grips[0].frame->d1 = Vector3d(0, 1, 1);
  const Vector3d d1 = held_d1(problem, problem.grips[1]);
  const Vector3d first = held_d1(problem, problem.grips[0]);
  const Vector3d to = problem.grips[1].direction->normalized();
  EXPECT_NEAR(d1.dot(to), 0, 1e-15);
  // Both frames have the same component along the axis of this rotation.
  const Vector3d axis = Vector3d::UnitX().cross(to).normalized();
  EXPECT_NEAR(d1.dot(axis), first.dot(axis), 1e-15);
  EXPECT_NEAR(held_turns(problem, problem.grips[0], problem.grips[1]).value(), 1.5 / (2 * pi),
              1e-15);
  problem.grips[1].frame->d1 = Eigen::AngleAxisd(-0.5, to) * d1;
  EXPECT_NEAR(held_turns(problem, problem.grips[0], problem.grips[1]).value(), 1 / (2 * pi), 1e-15);
}

TEST(Roll, OfAClampThatTurnsRightBackKeepsThePlanesNormal) {
  Problem problem = test::rolled_clamps({0, 0.3, 0}, {-1, 0, 0}, 0.8, 0);
  problem.grips[0].frame->d1 = Vector3d(0, 0, 1);
  EXPECT_LT((held_d1(problem, problem.grips[1]) - Vector3d::UnitZ()).norm(), 1e-12);
  const Equilibrium u = test::converged(solve_energy(problem));
  EXPECT_NEAR(u.twists.at(0).torque, 0, 1e-9);
  problem.grips[1].position = {0.3, 0, 0};
  EXPECT_THROW((void)solve_energy(problem), std::invalid_argument);
  problem.grips[1].frame->d1 = Vector3d::UnitZ();
  EXPECT_FALSE(held_turns(problem, problem.grips[0], problem.grips[1]));
  EXPECT_TRUE(succeeded(solve_energy(problem).status));
}

/// Calugareanu, White and Fuller. Less than a turn, of a rod that is not slack enough for a loop to
/// pass through itself.
TEST(Turns, OfTheGripsAreTwistAndWritheOfBothSolversShapes) {
  std::mt19937 random(12);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto any = [&] { return Vector3d(uniform(random), uniform(random), uniform(random)); };
  int compared = 0;
  for (int i = 0; i < 12; ++i) {
    Problem problem =
        test::rolled_clamps(Vector3d(0.75, 0, 0) + 0.15 * any(), Vector3d::UnitX() + 0.6 * any(),
                            0.8, 2 * pi * uniform(random));
    problem.weight_per_length = 5 * any();
    if (i % 2 == 1) problem.grips[0].frame->d1 = any();
    if (i % 3 == 2) problem.grips[1].frame->d1 = any();
    const double held = held_turns(problem, problem.grips[0], problem.grips[1]).value();
    for (const bool exact : {false, true}) {
      const Equilibrium rod = exact ? solve_exact(problem) : solve_energy(problem);
      if (rod.status != SolveStatus::converged) continue;
      const double twist = rod.twists.at(0).angle / (2 * pi);
      EXPECT_NEAR(twist + writhe(rod.sample, 0, 1)->value.value(), held, 1e-2) << i << exact;
      ++compared;
    }
  }
  EXPECT_GE(compared, 22);
}

/// The slack allows a loop of the rod without twist, on either side. The zero of the roll does not
/// depend on the side.
TEST(Turns, OfALoopAreTheSameOnEitherSide) {
  for (const double roll : {0.0, 0.5, -0.5, 2.0}) {
    Problem problem = test::rolled_clamps({0.45, 0, 0}, {1, 0, 0}, 0.8, roll);
    const Equilibrium energy = test::require_usable(solve_energy(problem));
    const Equilibrium exact = test::require_usable(solve_exact(problem));
    for (const Equilibrium* rod : {&energy, &exact}) {
      const double twist = rod->twists.at(0).angle / (2 * pi);
      const double missing = twist + writhe(rod->sample, 0, 1)->value.value() - roll / (2 * pi);
      EXPECT_NEAR(std::remainder(missing, 2), 0, 1e-2) << roll;
    }
    EXPECT_NEAR(std::abs(energy.twists.at(0).torque), std::abs(exact.twists.at(0).torque), 1e-6)
        << roll;
  }
}

/// Returns a random rod that is intrinsically curved, between clamps whose frames are given.
Problem curved_rod(std::mt19937& random) {
  std::normal_distribution<double> normal;
  const auto any = [&] { return Vector3d(normal(random), normal(random), normal(random)); };
  Problem problem = test::rolled_clamps({0.5, 0, 0}, {1, 0, 0}, 0.8, 0);
  problem.natural_strains = {Vector3d(3, 3, 1.5).cwiseProduct(any())};
  for (Grip& grip : problem.grips) {
    grip.direction = any().normalized();
    grip.frame = FrameHold{.d1 = any()};
  }
  std::uniform_real_distribution<double> reach(0.2, 0.8);
  problem.grips[1].position = problem.grips[0].position + reach(random) * any().normalized();
  problem.grips[1].frame->roll = 2 * pi * std::uniform_int_distribution<int>(-1, 1)(random);
  return problem;
}

/// Returns the prescribed turns minus the twist and the writhe of the energy model's shape; odd if
/// the shape belongs to the other homotopy class.
double missing_turns_of(const Problem& problem) {
  const Equilibrium rod = test::require_usable(solve_energy(problem));
  const double held = held_turns(problem, problem.grips[0], problem.grips[1]).value();
  return held - rod.twists.at(0).angle / (2 * pi) - writhe(rod.sample, 0, 1)->value.value();
}

TEST(Turns, OfACurvedRodAreOfTheClassThatItsClampsHold) {
  std::mt19937 random(31);
  for (int i = 0; i < 12; ++i) {
    const Problem problem = curved_rod(random);
    EXPECT_NEAR(std::remainder(missing_turns_of(problem), 2), 0, 1e-5) << i;
  }
}

/// The equilibria of lowest energy of these two rods have lost turns by passing through themselves.
/// Equilibria of higher energy have the prescribed turns.
TEST(Turns, OfACurvedRodAreKeptByAHigherShape) {
  std::mt19937 random(31);
  for (int i = 0; i <= 26; ++i) {
    const Problem problem = curved_rod(random);
    if (i != 2 && i != 26) continue;
    EXPECT_NEAR(missing_turns_of(problem), 0, 1e-5) << i;
  }
}

/// Rotating the second clamp by a full turn selects the other homotopy class. In both classes the
/// equilibrium has all turns that the clamps prescribe.
TEST(Turns, OfAHelixChangeByOneWithTheClamps) {
  Problem problem = test::rolled_clamps({0.17, -0.26, 0.2}, {-0.69, 0.51, -0.52}, 0.8, 0);
  problem.natural_strains = {{3.9, 0, -0.3}};
  for (Grip& grip : problem.grips) grip.frame->d1 = Vector3d(0.2, 0.9, 0.3);
  for (const int turns : {0, 1}) {
    problem.grips[1].frame->roll = 2 * pi * turns;
    EXPECT_NEAR(missing_turns_of(problem), 0, 1e-5) << turns;
  }
}

/// The turns are counted from the rod without roll. A loop that leaves its plane by a small
/// distance therefore has the turns of the planar loop.
TEST(Turns, OfACurvedRodThatIsRolledAreThoseOfItsPlanarLoop) {
  Problem problem = test::rolled_clamps({0.1, 0.05, 0}, {1, 0.3, 0}, 0.8, 0);
  problem.grips[0].frame->d1 = Vector3d::UnitY();
  problem.natural_strains = {{0, 7, 0}};
  const Equilibrium planar = test::converged(solve_energy(problem));
  for (const double out : {1e-3, -1e-3}) {
    Problem near = problem;
    near.grips[1].position.z() = out;
    near.grips[1].frame->roll = out;
    const Equilibrium rod = test::converged(solve_energy(near));
    EXPECT_NEAR(rod.energy.total(), planar.energy.total(), 1e-3 * planar.energy.total());
  }
}

}  // namespace
}  // namespace dlo::energy_model
