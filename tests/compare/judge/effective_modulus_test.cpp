// Tests of the effective modulus: the modulus at which the continuous rod is nearest to a shape.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "dlo/compare/chain.hpp"
#include "dlo/compare/comparison.hpp"
#include "dlo/compare/force_model_settings.hpp"
#include "dlo/compare/reference.hpp"
#include "dlo/compare/solution.hpp"
#include "dlo/compare/solve.hpp"
#include "dlo/energy_model/interrupt.hpp"
#include "scenes.hpp"

namespace dlo::compare {
namespace {

/// Returns 12 points of the rod without weight.
Shape straight(const Scene& scene) {
  const std::vector<double> s = equal_arc_lengths(1, 12);
  return {s, straight_rod(scene, s).value()};
}

TEST(EffectiveModulus, RecoversTheModulusOfAnEnergyShape) {
  const Scene scene = heavy_scene(2, 15);
  for (const double ratio : {0.03, 0.5, 1.0, 7.0}) {
    Scene other = with_modulus_times(ratio, scene);
    const Shape shape = solve(other, Model::exact, {}, equal_arc_lengths(1, 12)).shape;
    const EffectiveModulus fit = fit_effective_modulus(scene, shape);
    EXPECT_NEAR(fit.ratio / ratio, 1, 1e-5);
    EXPECT_LT(fit.rms_m, 1e-6);
    EXPECT_EQ(fit.optimum, Optimum::clear);
  }
}

TEST(EffectiveModulus, OfAnUnbentShapeIsOneSided) {
  const Scene scene = heavy_scene(2, 15);
  EXPECT_EQ(fit_effective_modulus(scene, straight(scene)).optimum, Optimum::one_sided);
}

TEST(EffectiveModulus, ARodThatHangsStraightHasNone) {
  const Scene scene = heavy_scene(2, -90);
  Shape shape = straight(scene);
  for (const double aside : {0.0, 1e-3}) {
    shape.points.row(0).setConstant(aside);
    const EffectiveModulus fit = fit_effective_modulus(scene, shape);
    EXPECT_EQ(fit.optimum, Optimum::none);
    EXPECT_TRUE(std::isnan(fit.ratio));
    EXPECT_EQ(fit.missing_reason, "the shape does not change with E");
  }
}

// The error that no modulus explains is out of the plane. If E explains a fraction of 1 - 0.72^2 =
// 0.48 of the mean square, the RMS decreases by 28 %.
TEST(EffectiveModulus, IsClearOnlyIfItExplainsTheDeviation) {
  const Scene scene = heavy_scene(2, 15);
  Scene soft = with_modulus_times(0.5, scene);
  const Shape shape = solve(soft, Model::exact, {}, equal_arc_lengths(1, 12)).shape;
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

// E* is compared with the vertex of a parabola through squared distances from the exact model,
// which is solved without an initial guess.
TEST(EffectiveModulus, IsRightToEachPrintedDigit) {
  Scene scene = heavy_scene(2, 15);
  scene.force_model.law = BendingLaw::paper;
  const Shape shape = solve_chain(scene, scene.force_model).shape;
  const EffectiveModulus fit = fit_effective_modulus(scene, shape);
  ASSERT_TRUE(is_identified(fit.optimum));
  const auto square = [&](double log_factor) {
    Scene at = with_modulus_times(fit.ratio * std::exp(log_factor), scene);
    return std::pow(distance_from(shape)(solve_reference(at, Model::exact)), 2);
  };
  constexpr double step = 2e-3;
  const double below = square(-step);
  const double here = square(0);
  const double above = square(step);
  EXPECT_NEAR(step / 2 * (below - above) / (below - 2 * here + above), 0, 1e-5);
  EXPECT_LT(here, std::min(square(-0.7), square(0.7)));
  EXPECT_LT(fit.ratio, 0.5);
}

TEST(EffectiveModulus, IsFoundBetweenClampsInFewSolves) {
  Scene scene = test::two_clamps(100, {0.7, 0, 0});
  Scene soft = with_modulus_times(0.6, scene);
  const Shape shape = solve(soft, Model::energy, {}, equal_arc_lengths(1, 21)).shape;
  const EffectiveModulus fit =
      fit_effective_modulus(scene, distance_from(shape), solve_reference(scene, Model::energy));
  EXPECT_NEAR(fit.ratio, 0.6, 1e-5);
  EXPECT_EQ(fit.optimum, Optimum::clear);
  // The limit is the number of solves of a scan over half a decade to both sides, and of Brent's
  // method.
  EXPECT_LE(fit.solves, 22);
}

TEST(EffectiveModulus, TheTimeLimitIsForTheWholeSearch) {
  const Scene scene = heavy_scene(2, 15);
  const energy_model::Equilibrium state = solve_reference(scene, Model::energy);
  const auto distance = distance_from(straight(scene));
  const EffectiveModulus fit = fit_effective_modulus(scene, distance, state, {.time_limit = 1e-9});
  EXPECT_EQ(fit.optimum, Optimum::none);
  EXPECT_TRUE(std::isnan(fit.ratio));
  EXPECT_EQ(fit.missing_reason, "time limit of 1e-09 s reached");
  EXPECT_EQ(fit.solves, 0);
  const energy_model::Interruption interruption([] { return true; });
  EXPECT_EQ(fit_effective_modulus(scene, distance, state, {}).missing_reason,
            "interrupted, or out of the time of the whole command");
}

}  // namespace
}  // namespace dlo::compare
