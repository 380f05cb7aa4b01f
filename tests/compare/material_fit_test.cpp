#include "dlo/compare/material_fit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <tuple>

#include "dlo/compare/error.hpp"
#include "measured_shapes.hpp"
#include "sanitized.hpp"
#include "scenes.hpp"

namespace dlo::compare {
namespace {

using test::exact_shape;
using test::heavy_scene;
using test::random_pose;
using test::uneven_arc_lengths;
using test::with_noise;

bool holds(const FittedValue& value, double truth) {
  return (!value.low || *value.low <= truth) && (!value.high || *value.high >= truth);
}

class MaterialFitCoverage : public testing::TestWithParam<std::tuple<double, PoseFreedom>> {};

// The exact shape at 7 uneven points, reversed, moved, with noise of 0.1 % of the length: of 100
// draws an interval of 95 % misses the truth about 5 times, and more than 10 times once in 87 tests
// if it is right. The scene's own modulus is not the truth.
TEST_P(MaterialFitCoverage, IntervalHoldsTheTruthInNineOfTenDraws) {
  const auto& [gamma, pose] = GetParam();
  const Scene truth = heavy_scene(gamma, 15);
  const double modulus = truth.material.youngs_modulus;
  Scene scene = truth;
  scene.material.youngs_modulus *= 1.7;
  const energy_model::Equilibrium exact = solve_reference(truth, Model::exact);
  std::mt19937 random(2024);
  int held = 0;
  int told = 0;
  constexpr int draws = test::sanitized ? 10 : 100;
  for (int draw = 0; draw < draws; ++draw) {
    const std::vector<double> s = uneven_arc_lengths(random, 7, 1);
    const RigidMotion motion = pose == PoseFreedom::known ? RigidMotion() : random_pose(random);
    const MeasuredShape seen{
        "seen", with_noise(motion.applied(exact.sample(s).points), 1e-3, random), {}};
    const MaterialFit fit =
        fit_material({scene}, {test::reversed(seen)},
                     {.pose = pose, .smallest_ratio = 1.0 / 30, .largest_ratio = 30});
    held += holds(fit.youngs_modulus, modulus) ? 1 : 0;
    told += fit.youngs_modulus.value ? 1 : 0;
    EXPECT_EQ(fit.youngs_modulus.value.has_value(), fit.not_told.empty());
    if (pose != PoseFreedom::known) continue;
    ASSERT_TRUE(fit.youngs_modulus.value);
    EXPECT_TRUE(fit.shapes[0].alignment.reversed);
    if (gamma >= 1) {
      EXPECT_NEAR(*fit.youngs_modulus.value / modulus, 1, 0.05) << draw;
    }
  }
  RecordProperty("held", held);
  RecordProperty("told", told);
  if (!test::sanitized) {
    EXPECT_GE(held, 90);
  }
}

INSTANTIATE_TEST_SUITE_P(GammasAndPoses, MaterialFitCoverage,
                         testing::Combine(testing::Values(0.5, 1.0, 10.0, 100.0),
                                          testing::Values(PoseFreedom::known, PoseFreedom::rigid)),
                         [](const auto& instance) {
                           std::string name = std::to_string(std::get<0>(instance.param));
                           name.resize(name.find('.') + 2);
                           name.replace(name.find('.'), 1, "_");
                           return "Gamma" + name + to_string(std::get<1>(instance.param));
                         });

TEST(MaterialFit, APerfectShapeGivesItsModulusFromFarAway) {
  const Scene truth = heavy_scene(5, 0);
  Scene scene = truth;
  scene.material.youngs_modulus *= 300;
  std::mt19937 random(1);
  const MeasuredShape shape = exact_shape(truth, uneven_arc_lengths(random, 9, 1));
  const MeasuredShape moved{"m", random_pose(random).applied(shape.points), {}};
  for (const PoseFreedom pose : {PoseFreedom::known, PoseFreedom::rigid}) {
    const MaterialFit fit =
        fit_material({scene}, {pose == PoseFreedom::known ? shape : moved}, {.pose = pose});
    ASSERT_TRUE(fit.youngs_modulus.value);
    EXPECT_NEAR(*fit.youngs_modulus.value / truth.material.youngs_modulus, 1, 1e-3);
    EXPECT_TRUE(holds(fit.youngs_modulus, truth.material.youngs_modulus));
    EXPECT_LT(fit.rms_m, 1e-7);
  }
}

// Linear theory: the interval's half width is t / sqrt(sum |dr/dE|^2) sigma.
TEST(MaterialFit, IntervalHasTheWidthOfLinearTheory) {
  const Scene scene = heavy_scene(2, 0);
  const std::vector<double> s = equal_arc_lengths(1, 21);
  const double sigma = 1e-3;
  MeasuredShape shape = exact_shape(scene, s);
  shape.arc_length = s;
  std::mt19937 random(5);
  shape.points = with_noise(shape.points, sigma, random);
  Scene stiffer = scene;
  const double step = 1e-4;
  stiffer.material.youngs_modulus *= 1 + step;
  const double sensitivity = (exact_shape(stiffer, s).points - exact_shape(scene, s).points).norm();
  const double expected = 1.95996 * sigma / (sensitivity / step);
  const MaterialFit fit = fit_material({scene}, {shape}, {.noise = sigma});
  EXPECT_FALSE(fit.noise_is_estimated);
  EXPECT_EQ(fit.degrees_of_freedom, 3 * 21 - 1);
  const double half = (*fit.youngs_modulus.high - *fit.youngs_modulus.low) / 2 / 210e9;
  EXPECT_NEAR(half / expected, 1, 0.05);
  const MaterialFit estimated = fit_material({scene}, {shape});
  // A standard deviation from 62 degrees of freedom is known to 9 %.
  EXPECT_NEAR(estimated.noise_m / sigma, 1, 0.27);
}

TEST(MaterialFit, AFlatPictureCountsTwoCoordinates) {
  const Scene scene = heavy_scene(2, 0);
  const std::vector<double> s = equal_arc_lengths(1, 15);
  std::mt19937 random(6);
  MeasuredShape shape = exact_shape(scene, s);
  shape.points = with_noise(shape.points, 1e-3, random);
  shape.points.row(2).setZero();
  EXPECT_EQ(fit_material({scene}, {shape}).degrees_of_freedom, 15 - 1);
  EXPECT_EQ(fit_material({scene}, {shape}, {.pose = PoseFreedom::rigid}).degrees_of_freedom,
            15 - 3 - 1);
  shape.arc_length = s;
  EXPECT_EQ(fit_material({scene}, {shape}).degrees_of_freedom, 2 * 15 - 1);
}

TEST(MaterialFit, SeveralShapesNarrowTheInterval) {
  const Scene a = heavy_scene(2, 0);
  Scene b = a;
  b.grippers[0].direction = Eigen::Vector3d(1, 1, 0).normalized();
  std::mt19937 random(7);
  const auto measured = [&](const Scene& scene) {
    MeasuredShape shape = exact_shape(scene, uneven_arc_lengths(random, 9, 1));
    shape.points = random_pose(random).applied(with_noise(shape.points, 1e-3, random));
    return shape;
  };
  const MeasuredShape first = measured(a);
  const MeasuredShape second = measured(b);
  const MaterialFitOptions options{.pose = PoseFreedom::rigid};
  const auto width = [](const MaterialFit& fit) {
    return std::log(*fit.youngs_modulus.high / *fit.youngs_modulus.low);
  };
  const MaterialFit both = fit_material({a, b}, {first, second}, options);
  EXPECT_TRUE(holds(both.youngs_modulus, 210e9));
  EXPECT_LT(width(both), width(fit_material({a}, {first}, options)));
  EXPECT_LT(width(both), width(fit_material({b}, {second}, options)));
  EXPECT_EQ(both.degrees_of_freedom, 2 * (2 * 9 - 6) - 1);
}

TEST(MaterialFit, AShapeThatDoesNotTellEGivesABoundInsteadOfANumber) {
  // A rod that hardly bends: anything stiffer fits as well.
  const Scene stiff = heavy_scene(1e-3, 0);
  std::mt19937 random(8);
  MeasuredShape shape = exact_shape(stiff, uneven_arc_lengths(random, 7, 1));
  shape.points = with_noise(shape.points, 1e-3, random);
  const MaterialFit fit = fit_material({stiff}, {shape});
  EXPECT_FALSE(fit.youngs_modulus.value);
  EXPECT_FALSE(fit.youngs_modulus.high);
  ASSERT_TRUE(fit.youngs_modulus.low);
  EXPECT_LT(*fit.youngs_modulus.low, 210e9);
  EXPECT_NE(fit.not_told.find("E > "), std::string::npos) << fit.not_told;

  // A rod that hangs straight down: any modulus.
  const Scene hanging = heavy_scene(10, -90);
  shape = exact_shape(hanging, uneven_arc_lengths(random, 7, 1));
  shape.points = with_noise(shape.points, 1e-3, random);
  const MaterialFit none = fit_material({hanging}, {shape});
  EXPECT_FALSE(none.youngs_modulus.value);
  EXPECT_FALSE(none.youngs_modulus.low);
  EXPECT_FALSE(none.youngs_modulus.high);
  EXPECT_NE(none.not_told.find("any E"), std::string::npos) << none.not_told;
}

TEST(MaterialFit, DensityIsToldByALoadAndNotByGravityAlone) {
  Scene truth = heavy_scene(3, 0);
  std::mt19937 random(9);
  const std::vector<double> s = equal_arc_lengths(1, 12);
  const auto measured = [&](const Scene& scene) {
    MeasuredShape shape = exact_shape(scene, s);
    shape.points = with_noise(shape.points, 2e-4, random);
    shape.arc_length = s;
    return shape;
  };
  const MaterialFitOptions options{.density = true, .smallest_ratio = 0.05, .largest_ratio = 20};
  const MaterialFit alone = fit_material({truth}, {measured(truth)}, options);
  EXPECT_FALSE(alone.density);
  EXPECT_NE(alone.not_told.find("density / E"), std::string::npos) << alone.not_told;
  EXPECT_TRUE(alone.youngs_modulus.value);

  const double weight = truth.weight_per_length().norm();
  truth.loads = {{.at = 1, .force = Eigen::Vector3d(0, 2 * weight, 0)}};
  Scene scene = truth;
  scene.material.youngs_modulus *= 2;
  scene.material.density *= 0.6;
  const MaterialFit fit = fit_material({scene}, {measured(truth)}, options);
  ASSERT_TRUE(fit.density);
  ASSERT_TRUE(fit.density->value);
  ASSERT_TRUE(fit.youngs_modulus.value);
  EXPECT_TRUE(holds(fit.youngs_modulus, truth.material.youngs_modulus));
  EXPECT_TRUE(holds(*fit.density, truth.material.density));
  EXPECT_NEAR(*fit.youngs_modulus.value / truth.material.youngs_modulus, 1, 0.05);
  EXPECT_NEAR(*fit.density->value / truth.material.density, 1, 0.05);
}

TEST(MaterialFit, WarnsOfAShapeOfAnotherRod) {
  const Scene scene = heavy_scene(2, 0);
  const std::vector<double> s = equal_arc_lengths(1, 15);
  std::mt19937 random(10);
  MeasuredShape shape = exact_shape(scene, s);
  shape.points = with_noise(shape.points, 1e-3, random);
  EXPECT_EQ(fit_material({scene}, {shape}).warning, "");
  EXPECT_EQ(fit_material({scene}, {shape}, {.noise = 1e-3}).warning, "");
  EXPECT_NE(fit_material({scene}, {shape}, {.noise = 4e-4}).warning.find("given noise"),
            std::string::npos);
  shape.points *= 10;
  EXPECT_NE(fit_material({scene}, {shape}).warning.find("another unit"), std::string::npos);
}

TEST(MaterialFit, RefusesWhatCannotBeFitted) {
  const Scene scene = heavy_scene(1, 0);
  const MeasuredShape three = exact_shape(scene, {0.2, 0.5, 0.9});
  EXPECT_NO_THROW((void)fit_material({scene}, {three}));
  // Three points across the rod give six numbers, a frame takes them all.
  EXPECT_THROW((void)fit_material({scene}, {three}, {.pose = PoseFreedom::rigid}), InputError);
  EXPECT_THROW((void)fit_material({scene, scene}, {three}), InputError);
  EXPECT_THROW((void)fit_material({}, {}), InputError);
  EXPECT_THROW((void)fit_material({scene}, {three}, {.arc_lengths = ArcLengths::chord}),
               InputError);
  EXPECT_THROW((void)fit_material({scene}, {three}, {.noise = -1}), InputError);
}

}  // namespace
}  // namespace dlo::compare
