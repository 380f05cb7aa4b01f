#include "dlo/compare/alignment.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <span>

#include "dlo/compare/deviation.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/reference.hpp"
#include "dlo/compare/solution.hpp"
#include "measured_shapes.hpp"
#include "scenes.hpp"

namespace dlo::compare {
namespace {

const AlignOptions any_motion{.pose = PoseFreedom::rigid, .weights = PointWeights::equal};

double largest_distance(const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b) {
  return (a - b).colwise().norm().maxCoeff();
}

TEST(Alignment, RecoversARandomRigidMotionOfSevenUnevenPointsFromEitherEnd) {
  std::mt19937 random(1);
  for (const double gamma : {0.5, 5.0, 100.0}) {
    const Scene scene = heavy_scene(gamma, 20);
    const energy_model::Equilibrium energy = solve_reference(scene, Model::energy);
    for (int round = 0; round < 10; ++round) {
      const MeasuredShape truth = exact_shape(scene, uneven_arc_lengths(random, 7, 1));
      const RigidMotion pose = random_pose(random);
      MeasuredShape moved{"moved", pose.applied(truth.points), {}};
      const bool backwards = round % 2 == 1;
      if (backwards) moved = test::reversed(moved);
      const Alignment found = align(moved, energy.sample, 1, any_motion);
      EXPECT_EQ(found.reversed, backwards) << gamma << ", " << round;
      EXPECT_LT(found.rms_m, 1e-7) << gamma << ", " << round;
      // Largest distance of the rod's points, after the recovered motion, from their original
      // positions. Part of a stiff rod may slide along itself by much more than the distances
      // across it.
      EXPECT_LT(largest_distance(found.pose.applied(pose.applied(truth.points)), truth.points),
                2e-3)
          << gamma << ", " << round;
    }
  }
}

// In either direction the points fit at their positions; in the reverse order they do not.
TEST(Alignment, AShiftedShapeIsNotReversedByRounding) {
  const Scene scene = heavy_scene(5, 20);
  const energy_model::Equilibrium energy = solve_reference(scene, Model::energy);
  for (const double shift : {0.015, 0.2, -0.01, 1.0 / 3}) {
    MeasuredShape shape = exact_shape(scene, equal_arc_lengths(1, 41));
    shape.arc_length.clear();
    shape.points.row(1).array() += shift;
    const Alignment found = align(shape, energy.sample, 1, {.pose = PoseFreedom::translation});
    EXPECT_FALSE(found.reversed) << shift;
    EXPECT_LT(found.rms_m, 1e-6) << shift;
    EXPECT_NEAR(found.shape.arc_length.back(), 1, 1e-3) << shift;
    EXPECT_GT(found.opposite_direction_rms_m, 0.1) << shift;
  }
}

// The first search uses only a tenth of two thousand points. The result is no farther from
// the rod than the original pose of the points, which is near the optimum.
TEST(Alignment, ManyPointsLieAsNearAsTheyCan) {
  std::mt19937 random(15);
  const Scene scene = heavy_scene(8, 20);
  const energy_model::Equilibrium energy = solve_reference(scene, Model::energy);
  const std::vector<double> s = equal_arc_lengths(1, 2001);
  for (const bool backwards : {false, true}) {
    MeasuredShape measured{"dense", with_noise(energy.sample(s).points, 2e-3, random), {}};
    if (backwards) measured = test::reversed(measured);
    const double where_it_was = align(measured, energy.sample, 1, {}).mean_square;
    const RigidMotion pose = random_pose(random);
    measured.points = pose.applied(measured.points);
    const Alignment found = align(measured, energy.sample, 1, any_motion);
    EXPECT_EQ(found.reversed, backwards);
    EXPECT_TRUE(std::ranges::is_sorted(found.shape.arc_length));
    EXPECT_LT(found.mean_square, where_it_was);
    // Six numbers of four thousand are fitted.
    EXPECT_GT(found.mean_square, 0.99 * where_it_was);
    EXPECT_GT(found.opposite_direction_rms_m, 2 * found.rms_m);
    EXPECT_LT(largest_distance(found.pose.applied(pose.applied(energy.sample(s).points)),
                               energy.sample(s).points),
              1e-3);
  }
}

TEST(Alignment, GivenArcLengthsAreUsedEitherWayRound) {
  const Scene scene = heavy_scene(8, 10);
  const energy_model::Equilibrium energy = solve_reference(scene, Model::energy);
  std::mt19937 random(3);
  const std::vector<double> s = uneven_arc_lengths(random, 9, 1);
  const RigidMotion pose = random_pose(random);
  MeasuredShape shape{"s", pose.applied(energy.sample(s).points), s};
  for (const bool from_the_other_end : {false, true}) {
    for (const bool backwards : {false, true}) {
      MeasuredShape given = shape;
      for (double& at : given.arc_length) at = from_the_other_end ? 1 - at : at;
      if (backwards) given = test::reversed(given);
      const Alignment found = align(given, energy.sample, 1, any_motion);
      EXPECT_EQ(found.arc_lengths, ArcLengths::file);
      EXPECT_EQ(found.reversed, from_the_other_end);
      EXPECT_LT(found.rms_m, 1e-9);
      EXPECT_LT(largest_distance(found.pose.rotation * pose.rotation,
                                 Eigen::Matrix3d(Eigen::Matrix3d::Identity())),
                1e-7);
    }
  }
}

TEST(Alignment, MissingStretchesAreNotFilled) {
  // A camera sees 0.1 to 0.25 and 0.6 to 0.8 of the rod.
  const Scene scene = heavy_scene(10, 0);
  const energy_model::Equilibrium energy = solve_reference(scene, Model::energy);
  std::vector<double> s;
  for (int i = 0; i <= 15; ++i) s.push_back(0.1 + 0.01 * i);
  for (int i = 0; i <= 20; ++i) s.push_back(0.6 + 0.01 * i);
  std::mt19937 random(4);
  double sum = 0;
  constexpr int draws = 100;
  for (int draw = 0; draw < draws; ++draw) {
    const MeasuredShape measured{"seen", with_noise(energy.sample(s).points, 1e-4, random), {}};
    const Alignment found = align(measured, energy.sample, 1, {.weights = PointWeights::equal});
    EXPECT_EQ(found.arc_lengths, ArcLengths::nearest);
    ASSERT_EQ(found.shape.arc_length.size(), s.size());
    for (std::size_t i = 0; i < s.size(); ++i) EXPECT_NEAR(found.shape.arc_length[i], s[i], 5e-4);
    sum += found.rms_m * found.rms_m;
  }
  // Two of three components of the noise are across the rod.
  EXPECT_NEAR(std::sqrt(sum / draws), 1e-4 * std::sqrt(2.0), 0.05e-4);
}

TEST(Alignment, FreedomsOfTheFrame) {
  const Scene scene = heavy_scene(6, 35);
  const energy_model::Equilibrium energy = solve_reference(scene, Model::energy);
  const std::vector<double> s = equal_arc_lengths(1, 12);
  const RigidMotion turned{Eigen::AngleAxisd(2.5, Eigen::Vector3d::UnitY()).toRotationMatrix(),
                           Eigen::Vector3d(1, 2, 3)};
  const RigidMotion tilted{Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitZ()).toRotationMatrix(),
                           Eigen::Vector3d(1, 2, 3)};
  const RigidMotion shifted{Eigen::Matrix3d::Identity(), Eigen::Vector3d(1, 2, 3)};
  for (const ArcLengths rule : {ArcLengths::chord, ArcLengths::nearest}) {
    const auto rms_with = [&](PoseFreedom freedom, const RigidMotion& pose) {
      const MeasuredShape shape{"f", pose.applied(energy.sample(s).points), {}};
      return align(shape, energy.sample, 1, {.pose = freedom, .arc_lengths = rule}).rms_m;
    };
    // Chord lengths of twelve points approximate the arc lengths to 1e-4.
    const double zero = rule == ArcLengths::chord ? 1e-4 : 1e-8;
    EXPECT_LT(rms_with(PoseFreedom::translation, shifted), zero);
    EXPECT_GT(rms_with(PoseFreedom::translation, turned), 0.1);
    EXPECT_LT(rms_with(PoseFreedom::upright, turned), zero);
    EXPECT_GT(rms_with(PoseFreedom::upright, tilted), 0.01);
    EXPECT_LT(rms_with(PoseFreedom::rigid, tilted), zero);
    EXPECT_GT(rms_with(PoseFreedom::known, shifted), 1);
  }
}

// A helix turns one way; only a reflection, which is no motion, makes it turn the other.
TEST(Alignment, AMirrorImageIsNotTheSameShape) {
  constexpr double radius = 0.1;
  constexpr double pitch = 0.05;
  const double turn = 1 / std::hypot(radius, pitch);
  const Reference helix = [&](std::span<const double> s) {
    const auto count = static_cast<Eigen::Index>(s.size());
    const Eigen::ArrayXd angle = turn * Eigen::Map<const Eigen::ArrayXd>(s.data(), count);
    const Eigen::ArrayXd along = Eigen::ArrayXd::Constant(count, pitch);
    Eigen::ArrayXXd points(count, 3);
    points << radius * angle.cos(), radius * angle.sin(), pitch * angle;
    Eigen::ArrayXXd tangents(count, 3);
    tangents << -radius * angle.sin(), radius * angle.cos(), along;
    energy_model::Samples samples;
    samples.points = points.transpose();
    samples.tangents = turn * tangents.transpose();
    samples.curvature = Eigen::Matrix3Xd::Zero(3, count);
    return samples;
  };
  std::mt19937 random(8);
  const Eigen::Matrix3Xd points = helix(equal_arc_lengths(1, 41)).points;
  for (int axis = 0; axis < 3; ++axis) {
    Eigen::Matrix3Xd mirrored = points;
    mirrored.row(axis) *= -1;
    const RigidMotion pose = random_pose(random);
    EXPECT_LT(align({"own", pose.applied(points), {}}, helix, 1, any_motion).rms_m, 1e-6);
    const Alignment other = align({"mirrored", pose.applied(mirrored), {}}, helix, 1, any_motion);
    EXPECT_GT(other.rms_m, 0.2 * radius) << axis;
    EXPECT_NEAR(other.pose.rotation.determinant(), 1, 1e-12);
  }
}

TEST(Alignment, RefusesWhatCannotBeAnswered) {
  const Scene scene = heavy_scene(1, 0);
  const energy_model::Equilibrium energy = solve_reference(scene, Model::energy);
  const MeasuredShape two{"two", energy.sample(std::vector<double>{0, 1}).points, {}};
  EXPECT_NO_THROW((void)align(two, energy.sample, 1));
  EXPECT_THROW((void)align(two, energy.sample, 1, any_motion), InputError);
  EXPECT_THROW((void)align(two, energy.sample, 1, {.arc_lengths = ArcLengths::file}), InputError);
  const MeasuredShape beyond{"beyond", two.points, {0, 1.01}};
  EXPECT_THROW((void)align(beyond, energy.sample, 1), InputError);
}

}  // namespace
}  // namespace dlo::compare
