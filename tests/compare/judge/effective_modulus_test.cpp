// At which modulus a continuous rod would be nearest to a shape.

#include <gtest/gtest.h>

#include <cmath>

#include "dlo/compare/chain.hpp"
#include "dlo/compare/comparison.hpp"
#include "dlo/compare/force_model_settings.hpp"
#include "dlo/compare/reference.hpp"
#include "dlo/compare/solution.hpp"
#include "dlo/compare/solve.hpp"
#include "scenes.hpp"

namespace dlo::compare {
namespace {

using test::heavy_scene;

TEST(EffectiveModulus, RecoversTheModulusOfAnEnergyShape) {
  const Scene scene = heavy_scene(2, 15);
  for (const double ratio : {0.03, 0.5, 1.0, 7.0}) {
    Scene other = scene;
    other.material.youngs_modulus *= ratio;
    Shape shape;
    shape.arc_length = equal_arc_lengths(1, 12);
    shape.points = solve_reference(other, Model::exact).sample(shape.arc_length).points;
    const EffectiveModulus fit = fit_effective_modulus(scene, shape);
    EXPECT_NEAR(fit.ratio / ratio, 1, 1e-5);
    EXPECT_LT(fit.rms_m, 1e-6);
    EXPECT_EQ(fit.optimum, Optimum::clear);
  }
}

TEST(EffectiveModulus, OfAnUnbentShapeIsOneSided) {
  const Scene scene = heavy_scene(2, 15);
  Shape shape;
  shape.arc_length = equal_arc_lengths(1, 12);
  shape.points = straight_rod(scene, shape.arc_length).value();
  EXPECT_EQ(fit_effective_modulus(scene, shape).optimum, Optimum::one_sided);
}

TEST(EffectiveModulus, ARodThatHangsStraightHasNone) {
  const Scene scene = heavy_scene(2, -90);
  Shape shape;
  shape.arc_length = equal_arc_lengths(1, 12);
  shape.points = straight_rod(scene, shape.arc_length).value();
  for (const double aside : {0.0, 1e-3}) {
    shape.points.row(0).setConstant(aside);
    const EffectiveModulus fit = fit_effective_modulus(scene, shape);
    EXPECT_EQ(fit.optimum, Optimum::none);
    EXPECT_TRUE(std::isnan(fit.ratio));
    EXPECT_EQ(fit.why_none, "the shape does not change with E");
  }
}

// The error that no modulus explains is out of the plane. If E explains a fraction of 1 - 0.72^2 =
// 0.48 of the mean square, the RMS decreases by 28 %.
TEST(EffectiveModulus, IsClearOnlyIfItExplainsTheDeviation) {
  const Scene scene = heavy_scene(2, 15);
  Scene soft = scene;
  soft.material.youngs_modulus *= 0.5;
  Shape shape;
  shape.arc_length = equal_arc_lengths(1, 12);
  shape.points = solve_reference(soft, Model::exact).sample(shape.arc_length).points;
  const double in_plane = distance_from(shape)(solve_reference(scene, Model::energy));
  for (const auto& [share, optimum] :
       {std::pair{0.48, Optimum::partial}, std::pair{0.74, Optimum::partial},
        std::pair{0.76, Optimum::clear}, std::pair{0.99, Optimum::clear}}) {
    Shape aside = shape;
    aside.points.row(2).setConstant(in_plane * std::sqrt(1 / share - 1));
    const EffectiveModulus fit = fit_effective_modulus(scene, aside);
    EXPECT_NEAR(fit.ratio, 0.5, 1e-5);
    EXPECT_NEAR(fit.explained_share, share, 1e-6);
    EXPECT_EQ(fit.optimum, optimum) << share;
  }
}

/// The ratio at which the exact model's shape comes nearest, by golden section from cold solves.
double golden_section_ratio(const Scene& scene, const Shape& shape, double low, double high) {
  const auto square = [&](double log_ratio) {
    Scene at = scene;
    at.material.youngs_modulus *= std::exp(log_ratio);
    const double distance = distance_from(shape)(solve_reference(at, Model::exact));
    return distance * distance;
  };
  const double golden = (std::sqrt(5.0) - 1) / 2;
  double a = std::log(low);
  double b = std::log(high);
  double c = b - golden * (b - a);
  double d = a + golden * (b - a);
  double at_c = square(c);
  double at_d = square(d);
  while (b - a > 2e-6) {
    if (at_c < at_d) {
      b = d;
      d = c;
      at_d = at_c;
      c = b - golden * (b - a);
      at_c = square(c);
    } else {
      a = c;
      c = d;
      at_c = at_d;
      d = a + golden * (b - a);
      at_d = square(d);
    }
  }
  return std::exp((a + b) / 2);
}

TEST(EffectiveModulus, IsRightToEachPrintedDigit) {
  Scene scene = heavy_scene(2, 15);
  scene.force_model.law = BendingLaw::paper;
  const Shape shape = solve_chain(scene, scene.force_model).shape;
  const EffectiveModulus fit = fit_effective_modulus(scene, shape);
  ASSERT_TRUE(is_identified(fit.optimum));
  const double ratio = golden_section_ratio(scene, shape, fit.ratio / 2, fit.ratio * 2);
  EXPECT_NEAR(fit.ratio, ratio, 1e-5 * ratio);
  EXPECT_LT(fit.ratio, 0.5);
}

TEST(EffectiveModulus, IsFoundBetweenClampsInFewSolves) {
  Scene scene = heavy_scene(100, 0);
  scene.grippers.push_back(
      {.at = 1, .position = {0.7, 0, 0}, .direction = Eigen::Vector3d::UnitX()});
  Scene soft = scene;
  soft.material.youngs_modulus *= 0.6;
  Shape shape;
  shape.arc_length = equal_arc_lengths(1, 21);
  shape.points = solve_reference(soft, Model::energy).sample(shape.arc_length).points;
  const EffectiveModulus fit =
      fit_effective_modulus(scene, distance_from(shape), solve_reference(scene, Model::energy));
  EXPECT_NEAR(fit.ratio, 0.6, 1e-5);
  EXPECT_EQ(fit.optimum, Optimum::clear);
  // A scan of half a decade to both sides, and Brent's method.
  EXPECT_LE(fit.solves, 22);
}

TEST(EffectiveModulus, TheTimeLimitIsForTheWholeSearch) {
  const Scene scene = heavy_scene(2, 15);
  Shape shape;
  shape.arc_length = equal_arc_lengths(1, 12);
  shape.points = straight_rod(scene, shape.arc_length).value();
  const energy_model::Equilibrium state = solve_reference(scene, Model::energy);
  const EffectiveModulus fit =
      fit_effective_modulus(scene, distance_from(shape), state, {.time_limit = 1e-9});
  EXPECT_EQ(fit.optimum, Optimum::none);
  EXPECT_TRUE(std::isnan(fit.ratio));
  EXPECT_EQ(fit.why_none, "time limit of 1e-09 s reached");
  EXPECT_EQ(fit.solves, 0);
}

}  // namespace
}  // namespace dlo::compare
