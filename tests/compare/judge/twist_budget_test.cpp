// Tests of the part of a deviation that is due to twist that the force model neglects. The part is
// zero if the force model includes twist.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "dlo/compare/comparison.hpp"
#include "dlo/compare/plan.hpp"
#include "scenes.hpp"

namespace dlo::compare {
namespace {

using test::heavy_scene;

Scene twisted_scene() {
  Scene scene = heavy_scene(1, 0);
  scene.grippers.push_back(
      {.at = 1, .position = {0.8, 0, 0}, .direction = Eigen::Vector3d::UnitX()});
  for (Gripper& gripper : scene.grippers) gripper.frame = FrameHold{};
  scene.grippers.back().frame->roll = 3;
  scene.torsional_stiffness = scene.bending_stiffness() / 1.3;
  scene.force_model.c_c = scene.axial_stiffness() / 100;
  return scene;
}

double sum_of_shares(const Budget& b) {
  return b.twist.share + b.natural_curvature.share + b.law.share + b.bookkeeping.share +
         b.discretisation.share + b.stretch.share + b.contact.share + b.not_at_rest.share +
         b.interaction.share;
}

TEST(Budget, TellsWhatTwistThatIsLeftOutCosts) {
  Scene scene = twisted_scene();
  scene.force_model.law = BendingLaw::paper;
  const Comparison c = compare(scene, {}, {}, ModulusSearch::no);
  EXPECT_EQ(c.force.neglected, std::vector<std::string>{"twist"});
  const Budget& b = c.budget;
  // The result equals that of the plan, except for the discretisation by 16 points.
  const double apart = make_plan(scene).bound("twist");
  EXPECT_NEAR(b.twist.rms_m, apart, 0.03 * apart);
  // The polygon's discretisation error is the same without twist.
  const double alone =
      compare(scene.without_twist(), {}, {}, ModulusSearch::no).budget.discretisation.rms_m;
  EXPECT_NEAR(b.discretisation.rms_m, alone, 1e-3 * alone);
  EXPECT_NEAR(sum_of_shares(b), 1, 1e-9);
}

TEST(Budget, HasNoPartForTwistThatTheForceModelHas) {
  Scene scene = twisted_scene();
  scene.force_model.points = 32;
  scene.force_model.c_c.reset();
  for (const Bookkeeping bookkeeping : {Bookkeeping::consistent, Bookkeeping::paper}) {
    scene.force_model.bookkeeping = bookkeeping;
    const Comparison c = compare(scene, {}, {}, ModulusSearch::no);
    EXPECT_TRUE(c.force.neglected.empty());
    EXPECT_EQ(c.budget.twist.rms_m, 0);
    EXPECT_NEAR(sum_of_shares(c.budget), 1, 1e-9);
    const bool consistent = bookkeeping == Bookkeeping::consistent;
    EXPECT_GT(consistent ? c.budget.discretisation.share : c.budget.bookkeeping.share, 0.7);
    // A small fraction of the error without twist.
    if (consistent) {
      EXPECT_LT(c.deviation.rms_m, 0.05 * make_plan(scene).bound("twist"));
    }
  }
}

}  // namespace
}  // namespace dlo::compare
