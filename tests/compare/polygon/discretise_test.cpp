#include "dlo/compare/discretise.hpp"

#include <gtest/gtest.h>

#include "../../says.hpp"
#include "dlo/compare/bending_rule.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/force_model_settings.hpp"
#include "dlo/compare/scene_file.hpp"
#include "dlo/compare/solution.hpp"
#include "polygon/point_layout.hpp"
#include "scenes.hpp"

namespace dlo::compare {
namespace {

TEST(PaperBendingStiffness, IsFormula21OfTheDesignCurvature) {
  const Scene scene = paper_scenes().front();
  EXPECT_DOUBLE_EQ(
      discretise(scene, scene.force_model).parameters.c_b,
      paper_bending_stiffness(BendingRule::formula_21, scene.bending_stiffness(), 5, 0.5 / 15));
  EXPECT_THROW((void)paper_bending_stiffness(BendingRule::formula_21, 0.165, 200, 0.03),
               std::invalid_argument);
}

TEST(Discretise, PaperBookkeepingStartsAtTheRodsEndWithEqualMasses) {
  Scene scene = heavy_scene(2, 0);
  scene.force_model.bookkeeping = Bookkeeping::paper;
  const Discretisation d = discretise(scene, scene.force_model);
  EXPECT_DOUBLE_EQ(d.arc_length.front(), 0);
  EXPECT_NEAR(d.arc_length.back(), 1, 1e-15);
  EXPECT_NEAR(d.rod.loads.row(1).sum(), scene.weight_per_length().y(), 1e-15);
  EXPECT_DOUBLE_EQ(d.rod.loads(1, 0), d.rod.loads(1, 15));
  EXPECT_EQ(d.rod.grips.front().first_point, 0);
  scene.force_model.point_weight = 3 * scene.gravity.norm() / 16;
  EXPECT_NEAR(point_masses(scene, scene.force_model).rod.sum(), 3, 1e-14);
}

TEST(Discretise, ConsistentBookkeepingHoldsTheMiddleOfASegment) {
  Scene scene = heavy_scene(2, 0);
  const Discretisation d = discretise(scene, scene.force_model);
  const double L = 1 / 14.5;
  EXPECT_NEAR(d.parameters.segment_length, L, 1e-16);
  EXPECT_NEAR(d.arc_length.front(), -L / 2, 1e-16);
  EXPECT_NEAR(d.arc_length.back(), 1, 1e-15);
  EXPECT_NEAR(d.rod.loads.row(1).sum(), scene.weight_per_length().y(), 1e-15);
  EXPECT_EQ(d.rod.loads.col(0).norm(), 0);
  EXPECT_NEAR(d.rod.loads(1, 15) / d.rod.loads(1, 14), 0.5, 1e-14);
  const Shape shape = d.shape(d.starts.front());
  EXPECT_EQ(shape.arc_length.front(), 0);
  EXPECT_LT(shape.points.col(0).norm(), 1e-16);
}

TEST(Discretise, FitsEqualSegmentsBetweenTheGrips) {
  Scene scene = heavy_scene(1, 0);
  scene.grippers = {
      {.at = 0.83, .position = {0.5, 0, 0}},
      {.at = 0.21, .position = {0, 0, 0}, .direction = Eigen::Vector3d::UnitX()},
  };
  scene.force_model.points = 21;
  for (const Bookkeeping bookkeeping : {Bookkeeping::consistent, Bookkeeping::paper}) {
    scene.force_model.bookkeeping = bookkeeping;
    const Discretisation d = discretise(scene, scene.force_model);
    const double L = d.parameters.segment_length;
    EXPECT_DOUBLE_EQ(L, 1.0 / 20);  // no clamp at an end
    ASSERT_EQ(d.arc_length.size(), 21);
    EXPECT_EQ(d.arc_length.front(), 0);
    EXPECT_EQ(d.arc_length.back(), 1);
    EXPECT_NEAR(d.rod.rest_lengths.sum(), 1, 1e-14);
    EXPECT_LT((d.rod.rest_lengths.array() / L - 1).abs().maxCoeff(), 0.2);
    // Grips in the order of the scene
    const force_model::Grip& pin = d.rod.grips[0];
    EXPECT_EQ(pin.targets.cols(), 1);
    EXPECT_DOUBLE_EQ(d.arc_length[static_cast<std::size_t>(pin.first_point)], 0.83);
    const force_model::Grip& clamp = d.rod.grips[1];
    EXPECT_EQ(clamp.targets.cols(), 2);
    const double behind = bookkeeping == Bookkeeping::consistent ? L / 2 : 0;
    EXPECT_DOUBLE_EQ(d.arc_length[static_cast<std::size_t>(clamp.first_point)], 0.21 - behind);
    EXPECT_DOUBLE_EQ(d.rod.rest_lengths[clamp.first_point], L);
    EXPECT_NEAR(clamp.targets(0, 0), -behind, 1e-15);
    // Starts go through the grips and have about the rod's length.
    ASSERT_EQ(d.starts.size(), 2);
    for (const Eigen::Matrix3Xd& start : d.starts) {
      EXPECT_EQ(start.col(clamp.first_point + 1), clamp.targets.col(1));
      EXPECT_EQ(start.col(pin.first_point), pin.targets.col(0));
      // The error is largest next to a held segment, which is straight although the curve is not.
      const Eigen::Matrix3Xd segments = start.rightCols(20) - start.leftCols(20);
      EXPECT_LT(
          (segments.colwise().norm().transpose().cwiseQuotient(d.rod.rest_lengths).array() - 1)
              .abs()
              .maxCoeff(),
          0.25);
    }
  }
}

/// Returns the message with which discretise() refuses a scene, or "no error".
std::string refusal(const Scene& scene) {
  return error_of<InputError>([&] { return discretise(scene, scene.force_model); });
}

TEST(Discretise, SaysHowManyPointsTheGripsNeed) {
  Scene scene = heavy_scene(1, 0);
  scene.grippers.push_back({.at = 0.1, .position = {0.05, 0, 0}});
  for (const Bookkeeping bookkeeping : {Bookkeeping::consistent, Bookkeeping::paper}) {
    scene.force_model.bookkeeping = bookkeeping;
    // Half a segment is held and half a segment must be free, so L is at most 0.1 l. With the
    // convention `paper` a whole segment is held, so L is at most 0.1 l / 1.5.
    const int needed = bookkeeping == Bookkeeping::consistent ? 12 : 16;
    scene.force_model.points = needed - 1;
    EXPECT_TRUE(has_all(refusal(scene), {"needs at least " + std::to_string(needed) + " points"}));
    // With the smallest number only a single segment is free, which would be compressed; the next
    // refusal states the number with which it is long enough.
    scene.force_model.points = needed;
    const std::string too_short = refusal(scene);
    ASSERT_TRUE(has_all(too_short, {"in 1 segment"}));
    const std::size_t at = too_short.find("(allowed: ") + 10;
    scene.force_model.points = std::stoi(too_short.substr(at)) - 1;
    EXPECT_NE(refusal(scene), "no error");
    ++scene.force_model.points;
    EXPECT_EQ(refusal(scene), "no error");
  }
}

TEST(Discretise, RefusesGripsThatNoRodReaches) {
  Scene scene = heavy_scene(1, 0);
  scene.grippers.push_back({.at = 0.5, .position = {0.6, 0, 0}});
  EXPECT_TRUE(has_all(refusal(scene), {"0.6 m from the gripper"}));
  scene.grippers[1] = {.at = 0, .position = {0.6, 0, 0}};
  EXPECT_TRUE(has_all(refusal(scene), {"two grippers"}));
  // The rod leaves its clamps outwards: half a held segment at each end makes the way longer.
  scene = heavy_scene(1, 180);
  scene.grippers.push_back(
      {.at = 1, .position = {0.9, 0, 0}, .direction = -Eigen::Vector3d::UnitX()});
  scene.force_model.points = 8;
  EXPECT_TRUE(has_all(refusal(scene), {"22 or more"}));
  scene.force_model.points = 22;
  EXPECT_EQ(refusal(scene), "no error");
}

}  // namespace
}  // namespace dlo::compare
