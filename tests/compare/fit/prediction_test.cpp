// Tests of the prediction of a shape from a fit to other shapes.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "../../sanitized.hpp"
#include "../../says.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/material_fit.hpp"
#include "dlo/compare/result_text.hpp"
#include "dlo/energy_model/energy.hpp"
#include "measured_shapes.hpp"
#include "polygon/energy_problems.hpp"
#include "scenes.hpp"
#include "wire/between_shapes.hpp"

namespace dlo::compare {
namespace {

constexpr double one_degree = std::numbers::pi / 180;

struct Mountings {
  std::vector<Scene> scenes;
  std::vector<MeasuredShape> shapes;

  void resize(std::size_t count) {
    scenes.resize(count);
    shapes.resize(count);
  }

  void add(const Scene& nominal, const Scene& truth, double noise, std::mt19937& random) {
    const std::vector<double> s = equal_arc_lengths(1, 40);
    Eigen::Matrix3Xd errors = test::correlated_noise(s, noise, 0.2, random);
    errors.row(2).setZero();
    // The image shows a rod in its plane, so the true shape is confined to the plane.
    energy_model::Problem problem = energy_problem(truth);
    problem.confined_to_plane = true;
    scenes.push_back(nominal);
    shapes.push_back({"seen", energy_model::solve_energy(problem).sample(s).points + errors, s});
  }
};

Scene turned(Scene scene, std::size_t gripper, double angle) {
  Gripper& clamp = scene.grippers[gripper];
  clamp.direction = Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()) * *clamp.direction;
  return scene;
}

/// Returns shapes of a wire at four known clamp angles, in a fixture whose clamp is misaligned by 6
/// degrees.
Mountings wire_in_fixture(double noise = 0) {
  std::mt19937 random(3);
  Mountings result;
  for (const double angle : {-40.0, -10.0, 20.0, 45.0}) {
    const Scene nominal = test::heavy_scene(20, angle);
    Scene truth = turned(nominal, 0, 6 * one_degree);
    truth.natural_strain.y() = 0.8;
    result.add(nominal, truth, noise, random);
  }
  return result;
}

/// Returns a wire between two misaligned clamps, with more natural curvature terms than are fitted.
Mountings wire_between_clamps() {
  std::mt19937 random(8);
  Mountings result;
  for (int i = 0; i < 3; ++i) {
    Scene nominal = test::two_clamps(200, {-0.08, 0, 0});
    Scene truth = turned(turned(nominal, 0, -15 * one_degree), 1, 25 * one_degree);
    truth.natural_strain.y() = 1;
    truth.natural_variation = {{0, -2}, {0, 2.5}, {0, 1.5}, {0, -1}};
    result.add(nominal, truth, 0.006, random);
  }
  return result;
}

TEST(Prediction, WhatAFixtureHasWrongIsFoundOnceAndPredictsTheShapeLeftOut) {
  const Mountings seen = wire_in_fixture();
  MaterialFitOptions options{.natural_curvature_terms = 1,
                             .direction_tolerance = 20 * one_degree,
                             .shared_clamps = true,
                             .predict = true};
  const MaterialFit found = fit_material(seen.scenes, seen.shapes, options);
  ASSERT_EQ(found.others.size(), 2);
  EXPECT_NEAR(found.others[0].value, 0.8, 1e-4);
  EXPECT_NEAR(found.others[1].value, 6 * one_degree, 1e-4);
  EXPECT_FALSE(found.others[1].shape.has_value());
  ASSERT_EQ(found.clamps.size(), 1);
  EXPECT_NEAR(found.clamps[0].rotation.z(), 6 * one_degree, 1e-4);
  ASSERT_TRUE(found.prediction.has_value());
  EXPECT_EQ(found.prediction->shapes_m.size(), 4);
  EXPECT_LT(found.prediction->rms_m, 1e-4);
  // Four scenes with different angles contain no repeated mounting, so no repeatability is given.
  EXPECT_FALSE(found.prediction->repeatability_m.has_value());
  // If each shape has its own clamp error, the errors of the others do not predict it.
  options.shared_clamps = false;
  const MaterialFit own = fit_material(seen.scenes, seen.shapes, options);
  ASSERT_TRUE(own.prediction.has_value());
  EXPECT_LT(own.rms_m, 1e-4);
  EXPECT_TRUE(own.clamps.empty());
  // A rod that is bent from the clamp on is moved by nearly the angle times half its length.
  EXPECT_GT(own.prediction->rms_m, 0.02);
}

TEST(Prediction, MoreTermsOfNaturalCurvatureNeverFitWorse) {
  const Mountings seen = wire_between_clamps();
  double before = INFINITY;
  for (int terms = 0; terms <= (test::sanitized ? 1 : 4); ++terms) {
    const MaterialFit fit =
        fit_material(seen.scenes, seen.shapes, {.natural_curvature_terms = terms});
    EXPECT_LT(fit.rms_m, 1.001 * before) << terms;
    before = fit.rms_m;
  }
}

TEST(Prediction, OfThreeShapesChoosesTheOptionsThatTheWireWasMadeWithUnlessTheyAreGiven) {
  Mountings seen = wire_in_fixture(1e-3);
  const MaterialFit found = calibrate(seen.scenes, seen.shapes).fit;
  ASSERT_GT(found.tried.size(), 1);
  EXPECT_EQ(found.tried[0].natural_curvature_terms, 1);
  EXPECT_TRUE(found.tried[0].shared_clamps);
  for (const FitAlternative& other : found.tried) {
    EXPECT_GE(other.prediction_m.value_or(0), found.tried[0].prediction_m.value_or(1) / 1.03);
  }
  ASSERT_EQ(found.clamps.size(), 1);
  EXPECT_NEAR(found.clamps[0].rotation.z(), 6 * one_degree, 1 * one_degree);
  EXPECT_TRUE(
      test::interval_contains(found.youngs_modulus, seen.scenes[0].material.youngs_modulus));
  EXPECT_TRUE(calibrate(seen.scenes, seen.shapes, {.choose_options = false}).fit.tried.empty());
  EXPECT_TRUE(
      calibrate(seen.scenes, seen.shapes, {.natural_curvature_terms = 1}).fit.tried.empty());
  seen.resize(2);
  EXPECT_TRUE(calibrate(seen.scenes, seen.shapes).fit.tried.empty());
}

// If each shape is fitted as a straight rod in an aligned clamp, it has a narrow interval about
// another E.
TEST(Prediction, OneHangingDoesNotExcludeTheStiffnessThatAllHave) {
  const Mountings seen = wire_in_fixture(1e-3);
  const double truth = seen.scenes[0].material.youngs_modulus;
  for (std::size_t i = 0; i < (test::sanitized ? 1 : seen.shapes.size()); ++i) {
    const MaterialFit one =
        calibrate({seen.scenes[i]}, {seen.shapes[i]}, {.solve = {.time_limit = 1000}}).fit;
    EXPECT_TRUE(test::interval_contains(one.youngs_modulus, truth)) << i;
    EXPECT_TRUE(has_all(one.warning, {"the residuals are systematic", "curved wire"}))
        << one.warning;
  }
}

TEST(Prediction, IsSaidToBeWorseThanTheShapesRepeat) {
  const Mountings seen = wire_in_fixture();
  Calibration found = calibrate({seen.scenes[0]}, {seen.shapes[0]});
  found.fit.prediction = Prediction{.rms_m = 2.94e-3, .repeatability_m = 1.78e-3};
  EXPECT_TRUE(has_all(to_text(found), {"predictions are 1.65 times worse"}));
  found.fit.prediction->rms_m = 2e-3;
  EXPECT_TRUE(has_all(to_text(found), {"a prediction can hardly come nearer"}));
  EXPECT_FALSE(Prediction{.rms_m = 1}.repeatability_ratio());
}

TEST(Prediction, NothingIsTriedWhereNothingSystematicIsLeft) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal(0, 1e-3);
  Mountings seen;
  for (const double angle : {-30.0, 0.0, 30.0}) {
    const Scene nominal = test::heavy_scene(20, angle);
    seen.add(nominal, nominal, 0, random);
    for (double& coordinate : seen.shapes.back().points.topRows<2>().reshaped()) {
      coordinate += normal(random);
    }
  }
  const MaterialFit fit = calibrate(seen.scenes, seen.shapes).fit;
  ASSERT_EQ(fit.tried.size(), 1);
  EXPECT_EQ(fit.tried[0].natural_curvature_terms, 0);
  EXPECT_FALSE(fit.prediction.has_value());
  EXPECT_TRUE(test::interval_contains(fit.youngs_modulus, seen.scenes[0].material.youngs_modulus));
}

TEST(Prediction, RepeatabilityIsTheDistanceToTheMeanOfTheOthers) {
  const std::vector<double> s = equal_arc_lengths(1, 30);
  std::vector<Shape> shapes;
  for (const double height : {0.0, 0.01, -0.01}) {
    Shape shape{.arc_length = s, .points = Eigen::Matrix3Xd::Zero(3, 30)};
    shape.points.row(0) = Eigen::Map<const Eigen::RowVectorXd>(s.data(), 30);
    shape.points.row(1).setConstant(height);
    shapes.push_back(shape);
  }
  // Distances of three shapes at 0, d and -d from the mean of the others: 0, 3/2 d and 3/2 d.
  EXPECT_NEAR(repeatability(shapes, ArcLengths::file).value_or(0), 0.01 * std::sqrt(4.5 / 3),
              1e-12);
  EXPECT_FALSE(repeatability({shapes.front()}, ArcLengths::file).has_value());
  // A displacement along the rod is not visible to nearest points, one across the rod is, as
  // before.
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const Eigen::ArrayXd along = Eigen::Map<const Eigen::ArrayXd>(s.data(), 30);
    shapes[i].points.row(0).array() +=
        0.05 * static_cast<double>(i) * (along * (1 - along)).transpose();
  }
  EXPECT_GT(repeatability(shapes, ArcLengths::file).value_or(0), 0.0125);
  EXPECT_NEAR(repeatability(shapes, ArcLengths::nearest).value_or(0), 0.01 * std::sqrt(4.5 / 3),
              1e-12);
}

TEST(Prediction, RefusesWhatItCannotDo) {
  const Mountings seen = wire_in_fixture();
  const auto refused = [&](const Mountings& with, const MaterialFitOptions& options) {
    return error_of<InputError>([&] { return fit_material(with.scenes, with.shapes, options); });
  };
  EXPECT_TRUE(has_all(refused(seen, {.shared_clamps = true}),
                      {"calibrate: the same clamps in all shapes", "--clamp-angles \"5 deg\""}));
  Mountings two = seen;
  two.resize(2);
  EXPECT_EQ(refused(two, {.predict = true}),
            "calibrate: 2 shapes are too few to predict each by the others (allowed: 3 or more)");
  Mountings other = seen;
  other.scenes[2].grippers[0].at = 0.1;
  EXPECT_TRUE(has_all(refused(other, {.direction_tolerance = 0.1, .shared_clamps = true}),
                      {"its grippers differ from those of heavy.toml"}));
}

}  // namespace
}  // namespace dlo::compare
