// Tests of sections that are intrinsically curved on a rod that is not.

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "../../says.hpp"
#include "dlo/compare/discretise.hpp"
#include "dlo/compare/reference.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/scene_file.hpp"
#include "dlo/compare/solve.hpp"
#include "scene_text.hpp"

namespace dlo::compare {
namespace {

const std::string wire_head = R"(gravity = [0, 0, 0]
[rod]
length = "240 mm"
diameter = "0.89 mm"
material = { youngs_modulus = "60 GPa", density = 6450 }
)";
const std::string wire_arcs =
    R"(section = [{ from = "200 mm", to = "220 mm", natural_curvature = "80 1/m" },
           { from = "220 mm", to = "240 mm", natural_curvature = "40 1/m" }]
)";
const std::string wire_clamp = test::level_clamp;

Scene guide_wire() { return parse_scene(wire_arcs + wire_head + wire_clamp, "my.toml"); }

/// Returns the tip of a straight shaft of 0.2 m followed by arcs of 80 1/m and 40 1/m, 0.02 m each.
Eigen::Vector3d tip_of_arcs() {
  const double a = 80 * 0.02;
  const double b = a + 40 * 0.02;
  return {0.2 + std::sin(a) / 80 + (std::sin(b) - std::sin(a)) / 40,
          (1 - std::cos(a)) / 80 + (std::cos(a) - std::cos(b)) / 40, 0};
}

TEST(NaturalSection, TheMeanCurvatureOfAPartCountsItsSections) {
  Scene scene = guide_wire();
  EXPECT_NEAR(scene.natural_curvature().z(), (80 + 40) * 0.02 / 0.24, 1e-12);
  EXPECT_NEAR(scene.natural_curvature(0.19, 0.21).z(), 40, 1e-10);
  scene.natural_strain.y() = 10;
  scene.natural_variation = {{0, 5}};
  // Within a section its own natural curvature replaces that of the rod.
  EXPECT_NEAR(scene.natural_curvature(0.2, 0.22).z(), 80, 1e-10);
  EXPECT_NEAR(scene.natural_curvature(0, 0.1).z(), 10 + 5 * (2 * 0.05 / 0.24 - 1), 1e-10);
  EXPECT_FALSE(scene.without_natural_strain().naturally_bent());
}

TEST(NaturalSection, ThePolygonApproachesTheArcs) {
  Scene scene = guide_wire();
  scene.force_model.law = BendingLaw::hooke;
  double before = 0;
  for (const int points : {61, 121, 241}) {
    scene.force_model.points = points;
    const Solution chain = solve(scene, Model::chain);
    const double error = (chain.shape.points.rightCols<1>() - tip_of_arcs()).norm();
    // If a boundary divides a joint, its bend is concentrated in one point: first order at worst.
    EXPECT_LT(error, 0.2 * 0.24 / points);
    if (before > 0) EXPECT_LT(error, 0.6 * before);
    before = error;
  }
}

TEST(NaturalSection, MayBeTwistedOrBentAboutBothAxes) {
  const std::string section = "[[section]]\nfrom = 0.1\nto = 0.2\nnatural_twist = \"90 deg/m\"\n";
  const Scene twisted = parse_scene(wire_head + section + wire_clamp, "my.toml");
  EXPECT_TRUE(twisted.naturally_bent());
  EXPECT_FALSE(twisted.naturally_curved());
  EXPECT_TRUE(twisted.assumes_torsion());
  const Scene helix = parse_scene(
      wire_head + section + "natural_curvature = [3, \"4 1/m\"]\n" + wire_clamp, "my.toml");
  EXPECT_FALSE(helix.planar());
  EXPECT_EQ(*helix.sections[0].natural_curvature, Eigen::Vector2d(3, 4));
  EXPECT_DOUBLE_EQ(helix.sections[0].bending_stiffness, helix.bending_stiffness());
}

TEST(NaturalSection, SaysWhatIsWrong) {
  EXPECT_TRUE(has_all(scene_error(wire_arcs + wire_head + test::first_pin),
                      {"section.natural_curvature", "no gripper holds the rod's frame"}));
  const std::string empty =
      scene_error(wire_head + "[[section]]\nfrom = 0\nto = 0.1\n" + wire_clamp);
  EXPECT_TRUE(has_all(empty, {"one of the five or more"}));
  const std::string rows = scene_error(
      wire_head + "[[section]]\nfrom = 0\nto = 0.1\nnatural_curvature = [[0, 1], [0, 2]]\n" +
      wire_clamp);
  EXPECT_TRUE(has_all(rows, {"section.natural_curvature"}));
}

}  // namespace
}  // namespace dlo::compare
