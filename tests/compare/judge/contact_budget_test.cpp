// Tests of the part of a deviation that is due to the force model's rigid obstacles, whose contact
// stiffness is proportional to c_c. The part is zero if nothing rigid is touched.

#include <gtest/gtest.h>

#include <cmath>

#include "dlo/compare/error_budget.hpp"
#include "dlo/compare/force.hpp"
#include "dlo/compare/reference.hpp"
#include "judge/budget_shares.hpp"
#include "scenes.hpp"

namespace dlo::compare {
namespace {

/// Returns a rod that leaves its clamp level at this height [m] over a floor.
Scene rod_over_floor(double gamma, double height) {
  Scene scene = heavy_scene(gamma, 0);
  scene.grippers.front().position.y() = height;
  scene.obstacles = {Obstacle{}};
  scene.force_model.c_c = scene.axial_stiffness() / 100;
  return scene;
}

struct FloorBudget {
  Budget budget;
  double segment_length = 0;  ///< [m]
};

FloorBudget floor_budget(const Scene& scene) {
  const Solution force = solve_force(scene, scene.force_model);
  const energy_model::Equilibrium rod = solve_reference(scene, Model::energy);
  const Budget b = error_budget(scene, force, rod.sample);
  EXPECT_NEAR(test::sum_of_shares(b), 1, 1e-9);
  // With the better law and convention, only the part `not_at_rest` has a second-order interaction.
  EXPECT_LT(b.interaction.rms_m, 1e-9 * scene.length);
  return {b, force.parameters.segment_length};
}

// A rod that a clamp holds level on a floor of stiffness k = c_c / L^2 per length sinks in by
//     y = w/k (1 - e^(-x) (cos x + sin x)),  x = s (k / 4EI)^(1/4)  (beam on an elastic foundation)
// whose mean square is (w/k)^2 (1 - 5/4 / x(l)). On a rigid floor the rod is straight, so y is the
// whole deviation. The polygon's last point has half the weight of the others but the contact
// stiffness of a whole segment, an error of first order in L.
TEST(ContactBudget, IsWhatABeamSinksIntoAnElasticFoundation) {
  for (const int points : {16, 32, 64}) {
    Scene scene = rod_over_floor(200, 0);
    scene.force_model.points = points;
    const double finer = points / 16.0;
    scene.force_model.c_c = scene.axial_stiffness() / 1e4 / (finer * finer);
    const auto [b, L] = floor_budget(scene);
    const double k = *scene.force_model.c_c / (L * L);
    const double end = std::pow(k / (4 * scene.bending_stiffness()), 0.25) * scene.length;
    const double law = scene.weight_per_length().norm() / k * std::sqrt(1 - 1.25 / end);
    EXPECT_NEAR(b.contact.rms_m / law, 1, 0.5 * L / scene.length) << points;
    EXPECT_NEAR(b.contact.share, 1, 1e-4) << points;
  }
}

TEST(ContactBudget, IsNothingWhereNothingRigidIsTouched) {
  EXPECT_EQ(floor_budget(rod_over_floor(2, 2)).budget.contact.rms_m, 0);
  EXPECT_EQ(floor_budget(rod_over_floor(0.1, 0.9)).budget.contact.rms_m, 0);
  // With the stiffness that represents a rigid obstacle, the depth is not an error of the model.
  Scene rigid = rod_over_floor(200, 0.02);
  rigid.force_model.c_c = 100 * rigid.axial_stiffness();
  EXPECT_LT(floor_budget(rigid).budget.contact.rms_m, 1e-9 * rigid.length);
  // A compliant obstacle is part of the scene, so its compliance is not an error of the force
  // model.
  Scene yielding = rod_over_floor(200, 0.02);
  yielding.obstacles.front().stiffness = 1e3 * yielding.weight_per_length().norm();
  EXPECT_EQ(floor_budget(yielding).budget.contact.rms_m, 0);
}

}  // namespace
}  // namespace dlo::compare
