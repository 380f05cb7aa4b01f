// Tests of the fit of a camera's tilt together with E and other unknowns of a wire.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <string>
#include <vector>

#include "../../says.hpp"
#include "dlo/compare/calibrated_rod.hpp"
#include "dlo/compare/error.hpp"
#include "random_wire.hpp"

namespace dlo::compare {
namespace {

/// Shapes of a rod in the coordinates of a camera, each with the second clamp at another position,
/// and their scenes, whose nominal EI is wrong.
struct Pictures {
  std::vector<Scene> scenes;
  std::vector<MeasuredShape> shapes;
};

Pictures pictures(double EI, const Eigen::AngleAxisd& tilt, const Eigen::Vector3d& direction) {
  Pictures result;
  for (const double x : {0.3, 0.9}) {
    Scene scene = nominal_scene(EI);
    scene.grippers[0].direction = direction;
    scene.grippers[1].direction = direction;
    scene.grippers[0].position = {0.1, 0.2, 0};
    scene.grippers[1].position = {x, 0.3, 0};
    const Eigen::Matrix3Xd points =
        energy_model_shape(scene, equal_arc_lengths(scene.length, 21)).points;
    const Eigen::Vector3d about = scene.grippers[0].position;
    result.shapes.push_back(
        {"seen", (tilt.matrix() * (points.colwise() - about)).colwise() + about, {}});
    scene.scale_modulus(1.3);
    result.scenes.push_back(scene);
  }
  return result;
}

MaterialFitOptions tilted(double tolerance) {
  return {.camera_tilt = tolerance, .choose_options = false, .noise = 1e-6};
}

TEST(CameraTilt, IsFoundInPicturesWithTheStiffnessThatItWouldBeTakenFor) {
  constexpr double EI = 2e-3;
  const Pictures seen =
      pictures(EI, {3 * one_degree, Eigen::Vector3d::UnitZ()}, Eigen::Vector3d::UnitX());
  const MaterialFit fit = fit_material(seen.scenes, seen.shapes, tilted(5 * one_degree));
  EXPECT_NEAR(*fit.youngs_modulus.value / EI, 1, 1e-4);
  EXPECT_LT((fit.camera_tilt - 3 * one_degree * Eigen::Vector3d::UnitZ()).norm(),
            1e-4 * one_degree);
  ASSERT_EQ(fit.others.size(), 1U);
  EXPECT_EQ(fit.others[0].name, "camera tilt about [0, 0, 1]");
  const MaterialFit level =
      fit_material(seen.scenes, seen.shapes, {.choose_options = false, .noise = 1e-5});
  EXPECT_GT(std::abs(*level.youngs_modulus.estimate / EI - 1), 0.02);
}

TEST(CameraTilt, InSpaceIsAboutLevelAxes) {
  constexpr double EI = 2e-3;
  const Eigen::Vector3d axis = Eigen::Vector3d::UnitX();
  const Pictures seen =
      pictures(EI, {2 * one_degree, axis}, Eigen::Vector3d(1, 0, 0.7).normalized());
  const MaterialFit fit = fit_material(seen.scenes, seen.shapes, tilted(5 * one_degree));
  EXPECT_EQ(fit.others.size(), 2U);
  EXPECT_NEAR(*fit.youngs_modulus.value / EI, 1, 1e-4);
  EXPECT_LT((fit.camera_tilt - 2 * one_degree * axis).norm(), 1e-3 * one_degree);
}

TEST(CameraTilt, IsPutIntoScenesAsTheCameraSawThem) {
  const Pictures seen =
      pictures(2e-3, {3 * one_degree, Eigen::Vector3d::UnitZ()}, Eigen::Vector3d::UnitX());
  const CalibratedRod rod = parse_calibrated_rod(
      "bending_stiffness = 2e-3\nmass_per_length = 0.0215\ncamera_tilt = [0, 0, \"3 deg\"]\n",
      "found.toml");
  for (std::size_t i = 0; i < seen.scenes.size(); ++i) {
    const Scene scene = calibrated_scene(seen.scenes[i], rod);
    const Eigen::Matrix3Xd points =
        energy_model_shape(scene, equal_arc_lengths(scene.length, 21)).points;
    EXPECT_LT((points - seen.shapes[i].points).cwiseAbs().maxCoeff(), 1e-7 * scene.length);
  }
}

TEST(CameraTilt, IsRefusedWhereMoreThanWeightActs) {
  Pictures seen = pictures(2e-3, {0, Eigen::Vector3d::UnitZ()}, Eigen::Vector3d::UnitX());
  seen.scenes[1].loads.push_back({.at = 0.5, .force = {0, -0.1, 0}});
  const auto refusal = [&] {
    return error_of<InputError>(
        [&] { return fit_material(seen.scenes, seen.shapes, tilted(one_degree)); });
  };
  EXPECT_TRUE(has_all(refusal(), {"wire: a camera's tilt of a rod without weight, or with loads",
                                  "(allowed: a rod that its weight alone bends)"}));
  const CalibratedRod rod = {.camera_tilt = {0, 0, 0.1}};
  EXPECT_TRUE(
      has_all(error_of<InputError>([&] { return calibrated_scene(seen.scenes[1], rod); }),
              {"wire: the calibrated rod was observed by a tilted camera", "no camera_tilt)"}));
  seen.scenes[1].loads.clear();
  seen.scenes[1].gravity = {1, -9.81, 0};
  EXPECT_TRUE(
      has_all(refusal(), {"wire: its plane or gravity differs from", "under one gravity)"}));
}

/// Returns, up to a constant, the logarithm of the likelihood of a stiffness exp(log_modulus) times
/// the scene's for one shape. The likelihood is summed over 15 directions of either clamp, within
/// three tolerances.
double log_probability(const Scene& scene, double log_modulus, const MeasuredShape& shape,
                       double noise, double tolerance) {
  constexpr int directions = 15;
  double sum = 0;
  Scene turned = scene;
  turned.scale_modulus(std::exp(log_modulus));
  const auto turn = [&](std::size_t clamp, int i) {
    const double angle = 3 * tolerance * (2.0 * i / (directions - 1) - 1);
    turned.grippers[clamp].direction = test::turned(*scene.grippers[clamp].direction, angle);
    return angle * angle / (2 * tolerance * tolerance);
  };
  for (int i = 0; i < directions; ++i) {
    const double first = turn(0, i);
    for (int j = 0; j < directions; ++j) {
      const double second = turn(1, j);
      const Eigen::Matrix3Xd points =
          energy_model::solve_energy(energy_problem(turned)).sample(shape.arc_length).points;
      sum +=
          std::exp(-(points - shape.points).squaredNorm() / (2 * noise * noise) - first - second);
    }
  }
  return std::log(sum);
}

/// If the directions of the clamps are unknown too, the estimate of E is not the minimum of the
/// deviance but the maximum of the marginal likelihood over the directions: the stiffer a rod is,
/// the more its shape determines them. For equal shapes the logarithms add up.
TEST(WireFit, StiffnessIsLikeliestWhateverTheOtherNumbersAre) {
  constexpr int mountings = 4;
  constexpr double noise = 0.02;
  constexpr double tolerance = 10 * one_degree;
  Scene scene = nominal_scene(1e-3);
  scene.grippers[1].position = {0.9, 0, 0};
  const MeasuredShape shape = energy_model_shape(scene, equal_arc_lengths(scene.length, 11));
  const MaterialFit fit = fit_material(
      std::vector<Scene>(mountings, scene), std::vector<MeasuredShape>(mountings, shape),
      {.direction_tolerance = tolerance, .choose_options = false, .noise = noise});
  const double found = std::log(*fit.youngs_modulus.estimate / scene.stiffness().value);
  // The maximum of a parabola through three values about the result; the minimum of the deviance is
  // at 0.
  constexpr double step = 0.1;
  const auto at = [&](double x) {
    return mountings * log_probability(scene, x, shape, noise, tolerance);
  };
  const double below = at(found - step);
  const double here = at(found);
  const double above = at(found + step);
  const double maximum = found + step / 2 * (below - above) / (below - 2 * here + above);
  EXPECT_LT(maximum, -0.08);
  EXPECT_NEAR(found / maximum, 1, 0.15);
}

}  // namespace
}  // namespace dlo::compare
