#include "dlo/compare/material_fit.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "../../says.hpp"
#include "dlo/compare/alignment.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/reference.hpp"
#include "dlo/compare/scene_file.hpp"
#include "dlo/compare/solution.hpp"
#include "measured_shapes.hpp"
#include "scenes.hpp"

namespace dlo::compare {
namespace {

/// Returns the exact shape at these arc lengths, which the file lacks, with noise.
MeasuredShape noisy_shape(const Scene& scene, const std::vector<double>& s, std::mt19937& random,
                          double noise = 1e-3) {
  return {"seen", with_noise(exact_shape(scene, s).points, noise, random), {}};
}

/// Returns half the width of the interval of E, divided by the true E.
double half_width(const MaterialFit& fit) {
  return (*fit.youngs_modulus.high - *fit.youngs_modulus.low) / 2 / 210e9;
}

// A part of a soft rod resembles another part of a stiffer one: from these shapes E was once
// reported 3 to 20 times too large.
TEST(MaterialFit, APieceInAnUnknownFrameThatFitsTwoModuliTellsNeither) {
  const std::string folder = std::string(DLO_DATA) + "/failures/";
  const Scene scene = load_scene(folder + "calib_reg_G60.toml");
  for (const char* draw : {"10", "37", "41", "49", "51", "79", "93"}) {
    const MeasuredShape shape = load_shape(folder + "calib_reg_G60_" + draw + ".csv");
    const MaterialFit fit = fit_material({scene}, {shape}, {.pose = PoseFreedom::rigid});
    EXPECT_FALSE(fit.youngs_modulus.value) << draw;
    EXPECT_TRUE(interval_contains(fit.youngs_modulus, scene.material.youngs_modulus)) << draw;
    EXPECT_TRUE(has_all(fit.not_identified, {", best near "}));
  }
}

// Between two clamps states are followed: a search at each modulus took 17 to 24 s in all.
TEST(MaterialFit, TwoClampsAreFollowedFromOneModulusToTheNext) {
  Scene truth = test::two_clamps(30, {0.7, 0.1, 0});
  MeasuredShape shape = test::energy_model_shape(truth, equal_arc_lengths(1, 15));
  shape.arc_length.clear();
  for (const double guess : {0.3, 1.8, 20.0}) {
    Scene scene = with_modulus_times(guess, truth);
    const MaterialFit fit = fit_material({scene}, {shape});
    ASSERT_TRUE(fit.youngs_modulus.value) << fit.not_identified;
    EXPECT_NEAR(*fit.youngs_modulus.value / truth.material.youngs_modulus, 1, 1e-4) << guess;
    EXPECT_LT(fit.equilibria, 80) << guess;
    EXPECT_LT(fit.evaluations, 100 * fit.equilibria) << guess;
  }
}

// A rod that is clamped nearly upright bends to either side. The points are near a higher
// equilibrium on one side. The lowest one on the other side would fit them with another modulus.
TEST(MaterialFit, AHeldRodIsFollowedFromItsOwnPoints) {
  Scene truth = heavy_scene(30, 80);
  truth.obstacles = {{obstacle::Body::cylinder({0.1, 0.25, 0}, Eigen::Vector3d::UnitZ(), 0.05)}};
  const std::vector<energy_model::Equilibrium> states = reference_states(truth);
  const auto other = std::find_if(states.begin() + 1, states.end(),
                                  [](const auto& state) { return succeeded(state.status); });
  ASSERT_NE(other, states.end());
  const MeasuredShape shape{"seen", other->sample(equal_arc_lengths(1, 21)).points, {}};
  Scene scene = with_modulus_times(1.3, truth);
  const MaterialFit fit = fit_material({scene}, {shape});
  ASSERT_TRUE(fit.youngs_modulus.value) << fit.not_identified;
  EXPECT_NEAR(*fit.youngs_modulus.value / truth.material.youngs_modulus, 1, 1e-3);
  EXPECT_LT(fit.rms_m, 1e-6);
}

TEST(MaterialFit, TheTimeLimitEndsItWithItsName) {
  const Scene scene = heavy_scene(1, 0);
  const MeasuredShape shape = exact_shape(scene, {0.2, 0.5, 0.9});
  EXPECT_TRUE(has_all(error_of<ConvergenceError>([&] {
                        return fit_material({scene}, {shape}, {.solve = {.time_limit = 1e-9}});
                      }),
                      {"--time-limit"}));
}

TEST(MaterialFit, APerfectShapeGivesItsModulusFromFarAway) {
  const Scene truth = heavy_scene(5, 0);
  Scene scene = with_modulus_times(300, truth);
  std::mt19937 random(1);
  const MeasuredShape shape = exact_shape(truth, uneven_arc_lengths(random, 9, 1));
  const MeasuredShape moved{"m", random_pose(random).applied(shape.points), {}};
  for (const PoseFreedom pose : {PoseFreedom::known, PoseFreedom::rigid}) {
    const MaterialFit fit =
        fit_material({scene}, {pose == PoseFreedom::known ? shape : moved}, {.pose = pose});
    ASSERT_TRUE(fit.youngs_modulus.value);
    EXPECT_NEAR(*fit.youngs_modulus.value / truth.material.youngs_modulus, 1, 1e-3);
    EXPECT_TRUE(interval_contains(fit.youngs_modulus, truth.material.youngs_modulus));
    EXPECT_LT(fit.rms_m, 1e-7);
  }
}

// Linear theory: the interval's half width is t / sqrt(sum |dr/dE|^2) sigma. With an unknown frame
// the part of a change of E that the frame can compensate is removed.
TEST(MaterialFit, IntervalHasTheWidthOfLinearTheory) {
  const Scene scene = heavy_scene(2, 0);
  const std::vector<double> s = equal_arc_lengths(1, 21);
  const double sigma = 2e-4;
  const Eigen::Matrix3Xd exact = exact_shape(scene, s).points;
  std::mt19937 random(15);
  const MeasuredShape shape{"seen", with_noise(exact, sigma, random), s};
  const double step = 1e-4;
  Scene stiffer = with_modulus_times(1 + step, scene);
  const Eigen::Matrix3Xd moved = (exact_shape(stiffer, s).points - exact) / step;
  // Columns: shifts along x, y, z, then turns about y (upright), x and z.
  Eigen::MatrixXd frame(3 * 21, 6);
  for (Eigen::Index i = 0; i < 21; ++i) {
    frame.block<3, 3>(3 * i, 0).setIdentity();
    frame.block<3, 1>(3 * i, 3) = Eigen::Vector3d::UnitY().cross(exact.col(i));
    frame.block<3, 1>(3 * i, 4) = Eigen::Vector3d::UnitX().cross(exact.col(i));
    frame.block<3, 1>(3 * i, 5) = Eigen::Vector3d::UnitZ().cross(exact.col(i));
  }
  const Eigen::VectorXd change = Eigen::Map<const Eigen::VectorXd>(moved.data(), moved.size());
  for (const auto& [pose, freedom] :
       {std::pair{PoseFreedom::known, 0}, std::pair{PoseFreedom::translation, 3},
        std::pair{PoseFreedom::upright, 4}, std::pair{PoseFreedom::rigid, 6}}) {
    Eigen::VectorXd left = change;
    if (freedom > 0) {
      const Eigen::MatrixXd free = frame.leftCols(freedom);
      left -= free * free.colPivHouseholderQr().solve(change);
    }
    const double expected = 1.95996 * sigma / left.norm();
    const MaterialFit given = fit_material({scene}, {shape}, {.pose = pose, .noise = sigma});
    EXPECT_FALSE(given.noise_is_estimated);
    EXPECT_EQ(given.degrees_of_freedom, 3 * 21 - 1 - freedom);
    EXPECT_NEAR(half_width(given) / expected, 1, 0.05) << to_string(pose);
    if (freedom == 0) continue;
    // Estimated noise: Student's t for its normal quantile, of 3 * 21 - 7 or more.
    const MaterialFit fit = fit_material({scene}, {shape}, {.pose = pose});
    ASSERT_FALSE(fit.correlation);
    // A standard deviation from 56 to 59 degrees of freedom is known to 9 %.
    EXPECT_NEAR(fit.noise_m / sigma, 1, 0.27);
    EXPECT_NEAR(half_width(fit) / (half_width(given) * fit.noise_m / sigma), 2.003 / 1.960, 0.02)
        << to_string(pose);
  }
}

TEST(MaterialFit, AFlatPictureCountsTwoCoordinates) {
  const Scene scene = heavy_scene(2, 0);
  const std::vector<double> s = equal_arc_lengths(1, 15);
  std::mt19937 random(6);
  MeasuredShape shape = noisy_shape(scene, s, random);
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
    const std::vector<double> s = uneven_arc_lengths(random, 9, 1);
    const auto pose = random_pose(random);
    MeasuredShape shape = noisy_shape(scene, s, random);
    shape.points = pose.applied(shape.points);
    return shape;
  };
  const MeasuredShape first = measured(a);
  const MeasuredShape second = measured(b);
  const MaterialFitOptions options{.pose = PoseFreedom::rigid};
  const auto width = [](const MaterialFit& fit) {
    return std::log(*fit.youngs_modulus.high / *fit.youngs_modulus.low);
  };
  const MaterialFit both = fit_material({a, b}, {first, second}, options);
  EXPECT_TRUE(interval_contains(both.youngs_modulus, 210e9));
  EXPECT_LT(width(both), width(fit_material({a}, {first}, options)));
  EXPECT_LT(width(both), width(fit_material({b}, {second}, options)));
  EXPECT_EQ(both.degrees_of_freedom, 2 * (2 * 9 - 6) - 1);
}

// Shared equilibria are computed once. Fits to more shapes converge to slightly different moduli
// and may therefore need up to 30 % more.
TEST(MaterialFit, ShapesOfOneSceneShareItsEquilibria) {
  const Scene scene = heavy_scene(2, 0);
  std::mt19937 random(11);
  std::vector<MeasuredShape> shapes;
  for (int k = 0; k < 3; ++k) {
    shapes.push_back(noisy_shape(scene, uneven_arc_lengths(random, 9, 1), random));
  }
  const long one = fit_material({scene}, {shapes[0]}).equilibria;
  const long three = fit_material({scene, scene, scene}, shapes).equilibria;
  const long two = fit_material({scene, scene}, {shapes[0], shapes[1]}).equilibria;
  EXPECT_LT(two, 1.3 * static_cast<double>(one));
  EXPECT_LT(three, 1.3 * static_cast<double>(one));
  // Scenes of different rods share no computations.
  Scene other = scene;
  other.length *= 1 + 1e-15;
  ASSERT_NE(other.length, scene.length);
  const long apart = fit_material({scene, other}, {shapes[0], shapes[1]}).equilibria;
  EXPECT_GT(apart, 1.5 * static_cast<double>(two));
}

TEST(MaterialFit, ARodThatHangsStraightDownHasAnyModulus) {
  std::mt19937 random(8);
  const Scene hanging = heavy_scene(10, -90);
  const MaterialFit none =
      fit_material({hanging}, {noisy_shape(hanging, uneven_arc_lengths(random, 7, 1), random)});
  EXPECT_FALSE(none.youngs_modulus.value);
  EXPECT_FALSE(none.youngs_modulus.low);
  EXPECT_FALSE(none.youngs_modulus.high);
  EXPECT_TRUE(has_all(none.not_identified, {"any E"}));
}

TEST(MaterialFit, DensityIsToldByALoadAndNotByGravityAlone) {
  Scene truth = heavy_scene(3, 0);
  std::mt19937 random(9);
  const std::vector<double> s = equal_arc_lengths(1, 12);
  const auto measured = [&](const Scene& scene) {
    MeasuredShape shape = noisy_shape(scene, s, random, 2e-4);
    shape.arc_length = s;
    return shape;
  };
  const MaterialFitOptions options{.density = true, .smallest_ratio = 0.05, .largest_ratio = 20};
  const MaterialFit alone = fit_material({truth}, {measured(truth)}, options);
  EXPECT_FALSE(alone.density);
  EXPECT_TRUE(has_all(alone.not_identified, {"density / E"}));
  EXPECT_TRUE(alone.youngs_modulus.value);

  const double weight = truth.weight_per_length().norm();
  truth.loads = {{.at = 1, .force = Eigen::Vector3d(0, 2 * weight, 0)}};
  Scene scene = with_modulus_times(2, truth);
  scene.material.density *= 0.6;
  const MaterialFit fit = fit_material({scene}, {measured(truth)}, options);
  ASSERT_TRUE(fit.density && fit.density->value && fit.youngs_modulus.value);
  EXPECT_TRUE(interval_contains(fit.youngs_modulus, truth.material.youngs_modulus));
  EXPECT_TRUE(interval_contains(*fit.density, truth.material.density));
  EXPECT_NEAR(*fit.youngs_modulus.value / truth.material.youngs_modulus, 1, 0.05);
  EXPECT_NEAR(*fit.density->value / truth.material.density, 1, 0.05);
}

TEST(MaterialFit, WarnsOfAShapeOfAnotherRod) {
  const Scene scene = heavy_scene(2, 0);
  std::mt19937 random(10);
  MeasuredShape shape = noisy_shape(scene, equal_arc_lengths(1, 15), random);
  EXPECT_EQ(fit_material({scene}, {shape}).warning, "");
  EXPECT_EQ(fit_material({scene}, {shape}, {.noise = 1e-3}).warning, "");
  EXPECT_TRUE(has_all(fit_material({scene}, {shape}, {.noise = 4e-4}).warning, {"given noise"}));
  shape.points *= 10;
  EXPECT_TRUE(has_all(fit_material({scene}, {shape}).warning, {"another unit"}));
}

TEST(MaterialFit, RefusesWhatCannotBeFitted) {
  const Scene scene = heavy_scene(1, 0);
  const MeasuredShape three = exact_shape(scene, {0.2, 0.5, 0.9});
  EXPECT_NO_THROW((void)fit_material({scene}, {three}));
  // Three points have six coordinates across the rod, as many as an unknown frame: nothing is left
  // for E.
  EXPECT_THROW((void)fit_material({scene}, {three}, {.pose = PoseFreedom::rigid}), InputError);
  EXPECT_THROW((void)fit_material({scene, scene}, {three}), InputError);
  EXPECT_THROW((void)fit_material({}, {}), InputError);
  EXPECT_THROW((void)fit_material({scene}, {three}, {.arc_lengths = ArcLengths::chord}),
               InputError);
  EXPECT_THROW((void)fit_material({scene}, {three}, {.noise = -1}), InputError);
}

}  // namespace
}  // namespace dlo::compare
