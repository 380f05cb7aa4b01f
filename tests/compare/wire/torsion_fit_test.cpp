#include <gtest/gtest.h>

#include <numbers>
#include <random>
#include <vector>

#include "../../sanitized.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/material_fit.hpp"
#include "dlo/compare/shape.hpp"
#include "dlo/compare/solution.hpp"
#include "measured_shapes.hpp"
#include "scenes.hpp"

namespace dlo::compare {
namespace {

constexpr double half_turn = std::numbers::pi;
constexpr double true_share = 0.55;  // GJ / EI

/// Returns a wire between two clamps 0.8 l apart that twist it by `roll`.
Scene turned_wire(double roll) {
  Scene scene = test::two_clamps(20, {0.8, 0, 0});
  scene.grippers[0].frame.emplace();
  scene.grippers[1].frame = {.d1 = std::nullopt, .roll = roll};
  scene.torsional_stiffness = true_share * scene.bending_stiffness();
  return scene;
}

/// Fits from scenes whose E is 1.3 times the true value, and whose GJ / EI is 1.5 times the true
/// value.
MaterialFit fit_of_turns(const std::vector<double>& rolls, double noise, std::mt19937& random) {
  std::vector<Scene> nominal;
  std::vector<MeasuredShape> seen;
  const std::vector<double> s = equal_arc_lengths(1, 40);
  for (const double roll : rolls) {
    const Scene truth = turned_wire(roll);
    seen.push_back(test::energy_model_shape(truth, s));
    seen.back().points += test::correlated_noise(s, noise, 0.02, random);
    nominal.push_back(truth);
    nominal.back().scale_modulus(1.3);
    nominal.back().scale_torsion(1.5);
  }
  return fit_material(nominal, seen, {.torsional_stiffness = true});
}

TEST(TorsionFit, PerfectShapesGiveBackBothStiffnesses) {
  std::mt19937 random(1);
  const MaterialFit found = fit_of_turns({half_turn, 0.5 * half_turn}, 0, random);
  const Scene truth = turned_wire(half_turn);
  EXPECT_NEAR(*found.youngs_modulus.value / truth.material.youngs_modulus, 1, 1e-5);
  EXPECT_NEAR(*found.torsional_stiffness->value / *truth.torsional_stiffness, 1, 1e-5);
}

// With a correct interval of 95 %, fewer than 34 of 40 intervals contain the truth in less than one
// of a hundred tests. In one of twenty draws the three shapes scatter by chance, which may make the
// interval unbounded.
TEST(TorsionFit, TheIntervalHoldsTheTruth) {
  std::mt19937 random(2);
  constexpr int draws = test::sanitized ? 2 : 40;
  int held = 0;
  int ratio_held = 0;
  int determined = 0;
  for (int draw = 0; draw < draws; ++draw) {
    const MaterialFit found = fit_of_turns({half_turn, -half_turn, 0.5 * half_turn}, 1e-3, random);
    held += test::interval_contains(*found.torsional_stiffness, *turned_wire(0).torsional_stiffness)
                ? 1
                : 0;
    ratio_held += test::interval_contains(*found.torsion_over_bending, true_share) ? 1 : 0;
    determined += found.torsional_stiffness->value ? 1 : 0;
  }

  EXPECT_GE(ratio_held, draws * 34 / 40);
  EXPECT_GE(determined, draws * 36 / 40);
  EXPECT_GE(held, draws * 34 / 40);
}

// The clamps prescribe the frames that the rod has without twist. There is no torque, so GJ has no
// effect. With exact points, rounding must not determine GJ.
TEST(TorsionFit, OfAWireThatIsNotTwistedIsNotIdentifiable) {
  std::mt19937 random(3);
  for (const double noise : {1e-3, 0.0}) {
    const MaterialFit found = fit_of_turns({0}, noise, random);
    EXPECT_FALSE(found.torsional_stiffness->value);
    if (noise > 0) {
      EXPECT_TRUE(
          test::interval_contains(found.youngs_modulus, turned_wire(0).material.youngs_modulus));
      continue;
    }
    EXPECT_FALSE(found.torsional_stiffness->low);
    EXPECT_FALSE(found.torsion_over_bending->high);
  }
}

// Energies that differ by a factor have the same shapes: these determine GJ / EI, but neither of
// the two.
TEST(TorsionFit, WithoutWeightOnlyTheRatioIsTold) {
  Scene truth = turned_wire(half_turn);
  truth.gravity.setZero();
  // Clamps on one line would let the arch turn about it.
  truth.grippers[1].direction = Eigen::Vector3d(0.8, -0.6, 0);
  const MeasuredShape seen = test::energy_model_shape(truth, equal_arc_lengths(1, 40));
  Scene nominal = truth;
  nominal.scale_modulus(1.3);
  nominal.scale_torsion(1.5);
  const MaterialFit found = fit_material({nominal}, {seen}, {.torsional_stiffness = true});
  EXPECT_FALSE(found.youngs_modulus.value);
  EXPECT_FALSE(found.torsional_stiffness->value);
  EXPECT_FALSE(found.torsional_stiffness->low);
  ASSERT_TRUE(found.torsion_over_bending->value);
  EXPECT_NEAR(*found.torsion_over_bending->value, true_share, 1e-5);
}

TEST(TorsionFit, RefusesScenesWithoutTwist) {
  const Scene scene = test::heavy_scene(5, 0);
  const MeasuredShape seen = test::energy_model_shape(scene, equal_arc_lengths(1, 9));
  EXPECT_THROW((void)fit_material({scene}, {seen}, {.torsional_stiffness = true}), InputError);
}

}  // namespace
}  // namespace dlo::compare
