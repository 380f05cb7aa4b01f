// Tests of fitted rolls: rotations of clamps about the tangent, which two markers on a gripper do
// not determine.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "../../sanitized.hpp"
#include "../../says.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/material_fit.hpp"
#include "dlo/compare/scene_file.hpp"
#include "measured_shapes.hpp"

namespace dlo::compare {
namespace {

using Eigen::Vector3d;

constexpr double per_degree = std::numbers::pi / 180;

MeasuredShape noisy_points(const Scene& truth, int count, double noise, std::mt19937& random) {
  MeasuredShape shape = test::energy_model_shape(truth, equal_arc_lengths(truth.length, count));
  shape.points = test::with_noise(std::move(shape.points), noise, random);
  return shape;
}

double fitted_roll(const MaterialFit& fit, const std::string& name, std::size_t shape) {
  for (const FittedNumber& number : fit.others) {
    if (number.name == name && number.shape == shape) return number.value;
  }
  ADD_FAILURE() << "no number " << name << " of shape " << shape;
  return NAN;
}

std::string toml_vector(const Vector3d& v) {
  return fmt::format("[{:.17g}, {:.17g}, {:.17g}]", v.x(), v.y(), v.z());
}

/// Returns a wire between two clamps in space that twist it by `roll`.
Scene twisted_wire(const Vector3d& last, const Vector3d& direction, double roll) {
  return parse_scene(
      "[rod]\nlength = 0.4\nbending_stiffness = 1e-3\ntorsional_stiffness = 0.8e-3\n"
      "mass_per_length = 0.02\n[[gripper]]\nat = 0\nposition = [0, 0, 0]\ndirection = [1, 0, 0]\n"
      "roll = 0\n[[gripper]]\nat = 0.4\nposition = " +
          toml_vector(last) + "\ndirection = " + toml_vector(direction) +
          fmt::format("\nroll = {:.17g}\n", roll),
      "twisted.toml");
}

TEST(RollFit, TheRollOfATwistedWireIsFoundWithinFiveDegrees) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> anywhere(-1, 1);
  constexpr int draws = test::sanitized ? 3 : 20;
  for (int draw = 0; draw < draws; ++draw) {
    SCOPED_TRACE(draw);
    const Vector3d last(0.28, 0.08 * anywhere(random), 0.08 * anywhere(random));
    const Vector3d direction =
        Vector3d(1, 0.5 * anywhere(random), 0.5 * anywhere(random)).normalized();
    const double made = 90 * per_degree * anywhere(random);
    const Scene truth = twisted_wire(last, direction, made);
    const Scene nominal = twisted_wire(last, direction, made + 30 * per_degree * anywhere(random));
    const MaterialFit found = fit_material({nominal}, {noisy_points(truth, 31, 0.5e-3, random)},
                                           {.roll_tolerance = 30 * per_degree});
    // The roll of the first clamp is not fitted: twist is counted from it.
    ASSERT_EQ(found.others.size(), 1U);
    EXPECT_NEAR(nominal.grippers[1].frame->roll + fitted_roll(found, "roll of gripper 2", 0), made,
                5 * per_degree);
  }
}

/// Returns a wire that hangs from one clamp, pulled at its end.
Scene hanging_wire(const Vector3d& direction, const Vector3d& force) {
  return parse_scene(
      "[rod]\nlength = 1\nbending_stiffness = 0.05\ntorsional_stiffness = 0.04\n"
      "mass_per_length = 0.05\n[[gripper]]\nat = 0\nposition = [0, 0, 0]\ndirection = " +
          toml_vector(direction) + "\n[[load]]\nat = 1\nforce = " + toml_vector(force) + "\n",
      "hung.toml");
}

/// Returns an intrinsically curved wire that is rotated in its clamp from the position in which the
/// fit has roll 0: d1 is in the plane of the scene if there is one, else horizontal.
Scene curved_wire(Scene truth, double roll) {
  const Vector3d& direction = *truth.grippers[0].direction;
  const Vector3d level = truth.gravity.cross(direction).normalized();
  const Vector3d d1 = truth.plane_normal() ? Vector3d(level.cross(direction)) : level;
  truth.grippers[0].frame = FrameHold{.d1 = d1, .roll = roll};
  truth.natural_strain.y() = 1.5;
  truth.natural_variation = {{0.4, 0.6}};
  return truth;
}

TEST(RollFit, NaturalCurvatureInSpaceIsFoundWhereNobodySaidHowTheWireWasTurned) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> anywhere(-1, 1);
  const std::vector<Scene> nominal = {
      hanging_wire(Vector3d(1, 0.2, 0.1).normalized(), {0, 0, 0}),
      hanging_wire(Vector3d(1, -0.4, 0.3).normalized(), {0, 0, 0}),
      hanging_wire(Vector3d(0.8, 0.5, -0.4).normalized(), {0.05, 0, 0.1})};
  std::vector<Scene> scenes;
  std::vector<MeasuredShape> shapes;
  std::vector<double> rolls;
  for (const Scene& scene : nominal) {
    rolls.push_back(180 * per_degree * anywhere(random));
    shapes.push_back(noisy_points(curved_wire(scene, rolls.back()), 41, 0.5e-3, random));
    scenes.push_back(scene);
    scenes.back().scale_modulus(1.3);
  }
  const MaterialFit found = fit_material(
      scenes, shapes, {.natural_curvature_terms = 2, .roll_tolerance = 180 * per_degree});
  EXPECT_NEAR(found.youngs_modulus.value.value_or(0), 0.05, 0.002);
  // The fit may have the opposite curvature and a roll that differs by half a turn.
  ASSERT_EQ(found.natural_curvature.size(), 2U);
  const double sign = found.natural_curvature[0].y() > 0 ? 1 : -1;
  EXPECT_EQ(found.natural_curvature[0].x(), 0);
  EXPECT_NEAR(sign * found.natural_curvature[0].y(), 1.5, 0.03);
  EXPECT_NEAR(sign * found.natural_curvature[1].x(), 0.4, 0.1);
  EXPECT_NEAR(sign * found.natural_curvature[1].y(), 0.6, 0.1);
  for (std::size_t i = 0; i < rolls.size(); ++i) {
    const double turned =
        fitted_roll(found, "roll of gripper 1", i) + (sign < 0 ? 180 * per_degree : 0);
    EXPECT_NEAR(std::remainder(turned - rolls[i], 360 * per_degree), 0, 5 * per_degree) << i;
  }
  EXPECT_LT(found.rms_m, 1.2 * std::sqrt(3.0) * 0.5e-3);
}

TEST(RollFit, ARollThatIsInNoShapeIsRefused) {
  std::mt19937 random(1);
  const Scene plain = hanging_wire({1, 0, 0}, {0, 0, 0});
  const MeasuredShape shape = noisy_points(plain, 21, 1e-4, random);
  EXPECT_TRUE(has_all(
      error_of<InputError>([&] { return fit_material({plain}, {shape}, {.roll_tolerance = 0.1}); }),
      {"hung.toml: no shape of this scene depends on the clamps' rotation about the tangent"}));
}

}  // namespace
}  // namespace dlo::compare
