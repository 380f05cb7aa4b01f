#include "solve/states.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "dlo/compare/reference.hpp"
#include "scenes.hpp"

namespace dlo::compare {
namespace {

using energy_model::Equilibrium;
using energy_model::Samples;

/// Returns a rod with two bending stiffnesses whose weight bends it about the stiffer axis: it
/// buckles laterally to either side.
Scene ribbon() {
  Scene scene = heavy_scene(30, 0);
  scene.given_mass_per_length = scene.mass_per_length();
  scene.given_bending_stiffness = scene.bending_stiffness();
  scene.given_bending_stiffness_2 = 20 * *scene.given_bending_stiffness;
  scene.torsional_stiffness = scene.given_bending_stiffness;
  return scene;
}

TEST(States, MirrorImagesBendAndTwistAboutTheirOwnAxes) {
  const Scene scene = ribbon();
  ASSERT_TRUE(scene.plane_normal());
  const std::vector<Equilibrium> states =
      all_equilibria(scene, solve_reference(scene, Model::energy), {});
  const std::vector<double> s = equal_arc_lengths(scene.length, 801);
  const double step = s[1] - s[0];
  const double bending_1 = *scene.given_bending_stiffness;
  const double bending_2 = *scene.given_bending_stiffness_2;
  int beside = 0;
  for (const Equilibrium& state : states) {
    const Samples samples = state.sample(s);
    if (samples.points.row(2).cwiseAbs().maxCoeff() > 0.01) ++beside;
    ASSERT_EQ(samples.d1.cols(), samples.points.cols());
    // All equilibria have the d1 that the clamp prescribes.
    EXPECT_LT((samples.d1.col(0) - scene.first_frame().col(0)).norm(), 1e-9);
    // Trapezoidal sums of the stored energy, and of 1/2 GJ u3^2 with u3 = d1' . d2 by central
    // differences at the inner points.
    double bending = 0;
    double twisting = 0;
    for (Eigen::Index i = 0; i < samples.d1.cols(); ++i) {
      const Eigen::Vector3d d1 = samples.d1.col(i);
      const Eigen::Vector3d d2 = samples.tangents.col(i).cross(d1);
      const Eigen::Vector3d curvature = samples.curvature.col(i);
      EXPECT_NEAR(d1.dot(samples.tangents.col(i)), 0, 1e-9);
      const bool outer = i == 0 || i + 1 == samples.d1.cols();
      bending +=
          (outer ? 0.25 : 0.5) * step *
          (bending_1 * std::pow(curvature.dot(d2), 2) + bending_2 * std::pow(curvature.dot(d1), 2));
      if (outer) continue;
      const Eigen::Vector3d change = (samples.d1.col(i + 1) - samples.d1.col(i - 1)) / (2 * step);
      twisting += 0.5 * step * *scene.torsional_stiffness * std::pow(change.dot(d2), 2);
    }
    EXPECT_NEAR(bending / state.energy.bending, 1, 1e-4);
    EXPECT_NEAR(twisting, state.energy.twisting, 0.01 * state.energy.bending);
  }
  EXPECT_GE(beside, 2);
}

}  // namespace
}  // namespace dlo::compare
