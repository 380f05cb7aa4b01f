// Tests of rods in scene files: given by EI and mass per length, with sections, intrinsically
// curved.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "../../says.hpp"
#include "dlo/compare/discretise.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/scene_file.hpp"
#include "polygon/energy_problems.hpp"
#include "reading/scene_template.hpp"
#include "scene_text.hpp"

namespace dlo::compare {
namespace {

const std::string by_stiffness = R"([rod]
length = "2 m"
bending_stiffness = "1.2e-3 N m^2"
mass_per_length = "20 g/m"
)";
const std::string by_material = R"([rod]
length = "2 m"
diameter = "2 mm"
material = "spring_steel"
)";
const std::string clamp = test::level_clamp;

Scene scene_of(const std::string& text) { return parse_scene(text, "my.toml"); }

void expect_message(const std::string& text, const std::vector<std::string>& parts) {
  EXPECT_TRUE(has_all(scene_error(text), parts));
}

TEST(ScenesRod, IsGivenByItsStiffnessAndItsMass) {
  const Scene scene = scene_of(by_stiffness + clamp);
  EXPECT_DOUBLE_EQ(scene.bending_stiffness(), 1.2e-3);
  EXPECT_DOUBLE_EQ(scene.mass_per_length(), 0.02);
  EXPECT_DOUBLE_EQ(scene.mass(), 0.04);
  EXPECT_DOUBLE_EQ(scene.gamma(), 0.02 * 9.81 * 8 / 1.2e-3);
  EXPECT_DOUBLE_EQ(scene.axial_stiffness(), 1e6 * 1.2e-3 / 4);
  EXPECT_EQ(scene.stiffness().name, std::string("EI"));
  EXPECT_DOUBLE_EQ(scene.stiffness().value, 1.2e-3);
  const energy_model::Problem problem = energy_problem(scene);
  EXPECT_DOUBLE_EQ(problem.bending_stiffness, 1.2e-3);
  EXPECT_DOUBLE_EQ(problem.weight_per_length.y(), -0.02 * 9.81);
}

TEST(ScenesRod, WithADiameterHasTheAxialStiffnessOfARoundRod) {
  const Scene thick = scene_of(by_stiffness + "diameter = \"8 mm\"\n" + clamp);
  EXPECT_DOUBLE_EQ(thick.axial_stiffness(), 16 * 1.2e-3 / 64e-6);
  // For a solid rod of one material this equals E A.
  const Scene steel = scene_of(by_material + clamp);
  EXPECT_NEAR(16 * steel.bending_stiffness() / std::pow(steel.diameter, 2), steel.axial_stiffness(),
              1e-9 * steel.axial_stiffness());
}

TEST(ScenesRod, WhatIsGivenOverridesTheMaterialButForTheAxialStiffness) {
  const Scene steel = scene_of(by_material + clamp);
  const Scene soft =
      scene_of(by_material + "bending_stiffness = 0.01\nmass_per_length = \"1 g/cm\"\n" + clamp);
  EXPECT_DOUBLE_EQ(soft.bending_stiffness(), 0.01);
  EXPECT_DOUBLE_EQ(soft.mass_per_length(), 0.1);
  EXPECT_EQ(soft.axial_stiffness(), steel.axial_stiffness());
}

TEST(ScenesRod, SaysWhatIsMissingOrTooMuch) {
  const std::string only_EI = "[rod]\nlength = 2\nbending_stiffness = 1\n" + clamp;
  expect_message(only_EI, {"my.toml", "rod.mass_per_length: missing", "beside bending_stiffness",
                           "material and diameter"});
  expect_message("[rod]\nlength = 2\nmass_per_length = 1\n" + clamp,
                 {"rod.bending_stiffness: missing", "beside mass_per_length"});
  expect_message(by_stiffness + "material = \"silicone\"\n" + clamp,
                 {"rod.diameter: missing", "no material"});
  expect_message(
      "[rod]\nlength = 2\nbending_stiffness = \"3 N\"\nmass_per_length = 1\n" + clamp,
      {"my.toml:3: rod.bending_stiffness", "3 N", "N m^2, mN m^2, kN m^2, N cm^2, N mm^2"});
  expect_message("[rod]\nlength = 2\nbending_stiffness = 1\nmass_per_length = -1\n" + clamp,
                 {"rod.mass_per_length = -1", ">= 0"});
  expect_message(
      "[rod]\nlength = 2\nbending_stiffness = 1e308\nmass_per_length = 1\ndiameter = "
      "\"1 um\"\n" +
          clamp,
      {"rod.bending_stiffness", "E A = inf"});
}

TEST(ScenesRod, TakesTheJointsOfAChain) {
  const std::string chain = "[rod]\nlength = 2\nmass_per_length = \"20 g/m\"\n";
  const Scene scene =
      scene_of(chain + "joint_stiffness = \"30 N mm/rad\"\njoint_spacing = \"4 cm\"\n" + clamp);
  EXPECT_DOUBLE_EQ(scene.bending_stiffness(), 1.2e-3);
  EXPECT_EQ(scene.stiffness().name, std::string("EI"));
  expect_message(chain + "joint_stiffness = 1\n" + clamp,
                 {"rod.joint_spacing: missing", "beside joint_stiffness"});
  expect_message(chain + "joint_spacing = 1\n" + clamp,
                 {"rod.joint_stiffness: missing", "beside joint_spacing"});
  expect_message(chain + "joint_spacing = \"3 m\"\njoint_stiffness = 1\n" + clamp,
                 {"rod.joint_spacing = ", "to 2 m"});
  expect_message(
      chain + "bending_stiffness = 1\njoint_spacing = 0.1\njoint_stiffness = 1\n" + clamp,
      {"rod.bending_stiffness = 1", "given besides joint_stiffness"});
}

const std::string sections_text = R"([[section]]
from = "120 cm"
to = 2
mass_per_length = "80 g/m"
[[section]]
from = 0.5
to = "1200 mm"
bending_stiffness = "4.8e-3 N m^2"
)";

TEST(ScenesSections, ChangeMassAndComplianceWhereTheyAre) {
  const Scene scene = scene_of(by_stiffness + clamp + sections_text);
  ASSERT_EQ(scene.sections.size(), 2U);
  EXPECT_EQ(scene.sections[0].from, 0.5);
  EXPECT_EQ(scene.sections[1].bending_stiffness, 1.2e-3);
  EXPECT_DOUBLE_EQ(scene.mass(), 0.02 * 1.2 + 0.08 * 0.8);
  EXPECT_NEAR(scene.weight_between(1, 1.5).y(), -9.81 * (0.02 * 0.2 + 0.08 * 0.3), 1e-15);
  EXPECT_NEAR(scene.bending_compliance(0.4, 0.7), 0.1 / 1.2e-3 + 0.2 / 4.8e-3, 1e-11);
  const energy_model::Problem problem = energy_problem(scene);
  EXPECT_NO_THROW(energy_model::check(problem));
  ASSERT_EQ(problem.sections.size(), 2U);
  EXPECT_EQ(problem.sections[0].bending_stiffness, 4.8e-3);
  EXPECT_DOUBLE_EQ(problem.sections[1].weight_per_length.y(), -0.08 * 9.81);
}

TEST(ScenesSections, KeepTheRodsShareOfTorsionUnlessTheySayAnother) {
  const Scene scene =
      scene_of(by_stiffness + "torsional_stiffness = 1e-3\n" + clamp + sections_text +
               "[[section]]\nfrom = 0\nto = 0.1\n"
               "torsional_stiffness = 7e-3\n");
  const energy_model::Problem problem = energy_problem(scene);
  EXPECT_EQ(problem.sections[0].torsional_stiffness, 7e-3);
  EXPECT_DOUBLE_EQ(problem.sections[1].torsional_stiffness, 4e-3);
  EXPECT_EQ(problem.sections[2].torsional_stiffness, 1e-3);
}

TEST(ScenesSections, AreRefusedWhereTheyAreNone) {
  const std::string rod = by_stiffness + clamp + "[[section]]\n";
  expect_message(rod + "from = 1\nto = 1\nmass_per_length = 1\n",
                 {"my.toml:11: section.to = 1", "not behind from"});
  expect_message(rod + "from = 1\nto = 3\nmass_per_length = 1\n", {"section.to = 3", "0 to 2 m"});
  expect_message(rod + "from = 1\nto = 2\n", {"section.bending_stiffness: missing"});
  expect_message(rod + "from = 1\nto = 2\ntorsional_stiffness = 1\n",
                 {"section.torsional_stiffness", "rod.torsional_stiffness too"});
  expect_message(by_stiffness + clamp + sections_text +
                     "[[section]]\nfrom = 1\nto = 1.5\nmass_per_length = 1\n",
                 {"section.from = 1", "inside the section from 0.5 to 1.2 m", "overlap"});
}

TEST(ScenesNaturalCurvature, IsToTheLeftInThePlane) {
  const std::string curved = by_stiffness + "natural_curvature = \"3 1/m\"\n";
  const Scene scene = scene_of(curved + clamp);
  EXPECT_EQ(scene.natural_strain, Eigen::Vector3d(0, 3, 0));
  EXPECT_TRUE(scene.planar());
  EXPECT_FALSE(scene.prescribes_twist());
  // The tangent turns from +x to +y, about +z.
  EXPECT_NEAR((scene.natural_curvature() - Eigen::Vector3d(0, 0, 3)).norm(), 0, 1e-12);
  EXPECT_TRUE(scene.assumes_torsion());
  EXPECT_DOUBLE_EQ(scene.twisting_stiffness(), 1.2e-3 / 1.3);
  const energy_model::Problem problem = energy_problem(scene);
  ASSERT_EQ(problem.natural_strains.size(), 1U);
  EXPECT_EQ(problem.natural_strains[0], Eigen::Vector3d(0, 3, 0));
  EXPECT_DOUBLE_EQ(problem.torsional_stiffness, 1.2e-3 / 1.3);
  EXPECT_NO_THROW(energy_model::check(problem));
  EXPECT_FALSE(scene.without_natural_strain().assumes_torsion());
  const Scene given = scene_of(curved + "torsional_stiffness = 2e-3\n" + clamp);
  EXPECT_FALSE(given.assumes_torsion());
  EXPECT_EQ(given.twisting_stiffness(), 2e-3);
}

TEST(ScenesNaturalCurvature, AboutAnotherAxisThanThePlanesIsSpatial) {
  const auto curved = [](const std::string& curvature, const std::string& more) {
    return scene_of(by_stiffness + curvature + clamp + more);
  };
  EXPECT_FALSE(curved("natural_curvature = [1, 2]\n", "").planar());
  EXPECT_TRUE(curved("natural_curvature = [0, -2]\n", "").planar());
  EXPECT_FALSE(curved("natural_curvature = 2\nnatural_twist = \"90 deg/m\"\n", "").planar());
  // If a straight rod is free to rotate about its tangent, twist has no effect.
  EXPECT_TRUE(curved("natural_twist = \"90 deg/m\"\n", "").planar());
  const Scene rolled = curved("natural_curvature = 2\n", "roll = \"30 deg\"\n");
  EXPECT_FALSE(rolled.planar());
  // d2 is turned about +x from +z towards -y.
  EXPECT_NEAR((rolled.natural_curvature() - Eigen::Vector3d(0, -1, std::sqrt(3))).norm(), 0, 1e-12);
  const Scene half = curved("natural_curvature = 2\n", "roll = \"180 deg\"\n");
  EXPECT_TRUE(half.planar());
  EXPECT_NEAR((half.natural_curvature() - Eigen::Vector3d(0, 0, -2)).norm(), 0, 1e-12);
}

TEST(ScenesNaturalCurvature, VariesAlongTheRodAsALegendreSeries) {
  const auto curved = [](const std::string& rows) {
    return scene_of(by_stiffness + "natural_curvature = " + rows + "\n" + clamp);
  };
  const Scene scene = curved(R"([[0, "3 1/m"], [0, 1.5], [0, -2]])");
  EXPECT_EQ(scene.natural_strain, Eigen::Vector3d(0, 3, 0));
  ASSERT_EQ(scene.natural_variation.size(), 2U);
  EXPECT_TRUE(scene.planar());
  // The mean over a part, by the midpoint rule: k(s) = 3 + 1.5 x - 2 (3 x^2 - 1) / 2, x = s - 1.
  constexpr double begin = 0.3;
  constexpr double end = 0.8;
  double sum = 0;
  constexpr int count = 2000;
  for (int i = 0; i < count; ++i) {
    const double x = begin + (end - begin) * (i + 0.5) / count - 1;
    sum += (3 + 1.5 * x - (3 * x * x - 1)) / count;
  }
  EXPECT_NEAR(scene.natural_curvature(begin, end).z(), sum, 1e-7);
  EXPECT_FALSE(curved("[[0, 3], [1, 0]]").planar());
  EXPECT_TRUE(curved("[[0, 0], [0, 1]]").naturally_bent());
  EXPECT_FALSE(scene.without_natural_strain().naturally_bent());
  const std::string rod = by_stiffness + "natural_curvature = ";
  expect_message(rod + "[[0, 3], [1]]\n" + clamp,
                 {"my.toml:5: rod.natural_curvature", "rows of two numbers"});
}

TEST(ScenesNaturalCurvature, NeedsAClampThatSaysAboutWhichAxis) {
  const std::string curved = by_stiffness + "natural_curvature = 2\n";
  expect_message(curved + first_pin, {"my.toml:5: rod.natural_curvature", "hold = \"clamp\""});
  const std::string sideways = "[[load]]\nat = 2\nforce = [0, 0, 1]\n";
  expect_message(curved + clamp + sideways,
                 {"my.toml:6", "natural_curvature", "no plane", "frame or quaternion"});
  const std::string framed = "frame = [[0, 1, 0], [0, 0, 1], [1, 0, 0]]\n";
  const Scene scene = scene_of(curved + clamp + framed + sideways);
  EXPECT_FALSE(scene.planar());
  EXPECT_NEAR((scene.natural_curvature() - Eigen::Vector3d(0, 0, 2)).norm(), 0, 1e-12);
  expect_message(by_stiffness + "natural_curvature = [1, 2, 3]\n" + clamp,
                 {"rod.natural_curvature", "[x, y]"});
}

TEST(ScenesNaturalCurvature, MakesTheFirstClampHoldItsFrame) {
  const std::string far = "[[gripper]]\nat = 2\nposition = [1, 0, 0]\ndirection = \"0 deg\"\n";
  const std::string held = far + "roll = \"90 deg\"\n";
  EXPECT_FALSE(scene_of(by_stiffness + clamp + held).prescribes_twist());
  const std::string curved = by_stiffness + "natural_curvature = 2\n";
  EXPECT_FALSE(scene_of(curved + clamp + far).prescribes_twist());
  const Scene scene = scene_of(curved + clamp + held);
  EXPECT_TRUE(scene.prescribes_twist());
  EXPECT_FALSE(scene.without_twist().prescribes_twist());
}

const std::string flat = R"([rod]
length = "2 m"
bending_stiffness = ["1.2e-3 N m^2", 0.04]
mass_per_length = "20 g/m"
)";

TEST(ScenesStrip, HasTwoBendingStiffnesses) {
  const Scene scene = scene_of(flat + clamp);
  EXPECT_DOUBLE_EQ(scene.bending_stiffness(), 1.2e-3);
  EXPECT_DOUBLE_EQ(scene.given_bending_stiffness_2.value(), 0.04);
  EXPECT_DOUBLE_EQ(scene.softer_bending_stiffness(), 1.2e-3);
  EXPECT_DOUBLE_EQ(scene.gamma(), 0.02 * 9.81 * 8 / 1.2e-3);
  EXPECT_TRUE(scene.planar());
  EXPECT_EQ(scene.stiffness().name, std::string("EI about d1"));
  // J = pi a^3 b^3 / (a^2 + b^2) of an ellipse, whose I are pi a b^3 / 4 and pi a^3 b / 4.
  EXPECT_TRUE(scene.assumes_torsion());
  EXPECT_DOUBLE_EQ(scene.twisting_stiffness(), 2 * 1.2e-3 * 0.04 / (1.2e-3 + 0.04) / 1.3);
  const energy_model::Problem problem = energy_problem(scene);
  EXPECT_EQ(problem.bending_stiffness, 1.2e-3);
  EXPECT_EQ(problem.bending_stiffness_2, 0.04);
  EXPECT_NO_THROW(energy_model::check(problem));
  Scene scaled = scene;
  scaled.scale_modulus(2);
  EXPECT_DOUBLE_EQ(*scaled.given_bending_stiffness_2, 0.08);
  EXPECT_DOUBLE_EQ(scaled.twisting_stiffness(), 2 * scene.twisting_stiffness());
}

TEST(ScenesStrip, HasSectionsOfItsOwnOrRoundOnes) {
  const std::string part = "[[section]]\nfrom = 0.5\nto = 1\n";
  const Scene own = scene_of(flat + clamp + part + "mass_per_length = 1\n");
  EXPECT_EQ(own.sections[0].bending_stiffness, 1.2e-3);
  EXPECT_EQ(own.sections[0].bending_stiffness_2, 0.04);
  const Scene round = scene_of(flat + clamp + part + "bending_stiffness = 3\n");
  EXPECT_FALSE(round.sections[0].bending_stiffness_2.has_value());
  const energy_model::Problem problem = energy_problem(round);
  EXPECT_FALSE(problem.sections[0].bending_stiffness_2.has_value());
  EXPECT_DOUBLE_EQ(problem.sections[0].torsional_stiffness, 3 / 1.3);
  // One section with two stiffnesses suffices to give the rod material directors.
  const Scene flattened = scene_of(by_stiffness + clamp + part + "bending_stiffness = [1, 2]\n");
  EXPECT_TRUE(flattened.has_material_directors());
  EXPECT_DOUBLE_EQ(energy_problem(flattened).sections[0].torsional_stiffness, 4.0 / 3 / 1.3);
}

TEST(ScenesStrip, IsPlanarAcrossItsAxesAlone) {
  EXPECT_TRUE(scene_of(flat + clamp + "roll = \"90 deg\"\n").planar());
  EXPECT_FALSE(scene_of(flat + clamp + "roll = \"30 deg\"\n").planar());
  EXPECT_FALSE(scene_of(flat + "natural_curvature = [1, 0]\n" + clamp).planar());
  EXPECT_TRUE(scene_of(flat + "natural_curvature = 1\n" + clamp).planar());
}

TEST(ScenesStrip, IsRefusedWithWhatIsAllowed) {
  const auto rod = [](const std::string& stiffness) {
    return "[rod]\nlength = 2\nbending_stiffness = " + stiffness + "\nmass_per_length = 1\n" +
           clamp;
  };
  expect_message(rod("[1, -1]"), {"my.toml:3: rod.bending_stiffness", "> 0", "d1 and about d2"});
  expect_message(rod("[1, 2, 3]"), {"my.toml:3: rod.bending_stiffness", "two in brackets"});
  expect_message(rod("[1, \"2 N\"]"), {"my.toml:3: rod.bending_stiffness", "N m^2"});
  expect_message(flat + first_pin, {"my.toml:3: rod.bending_stiffness", "hold = \"clamp\""});
  expect_message(flat + clamp + "[[load]]\nat = 2\nforce = [0, 0, 1]\n",
                 {"my.toml:5", "rod.bending_stiffness", "no plane", "frame or quaternion"});
  const Scene scene = scene_of(flat + clamp);
  EXPECT_TRUE(has_all(error_of<InputError>([&] { return discretise(scene, scene.force_model); }),
                      {"my.toml", "rod.bending_stiffness", "two values", "allowed here"}));
}

TEST(ScenesLoad, MayBeAMassThatHangsThere) {
  const std::string rod = by_stiffness + clamp + "[[load]]\nat = 1\n";
  EXPECT_NEAR(
      (scene_of(rod + "mass = \"10 g\"\n").loads.at(0).force - Eigen::Vector3d(0, -0.0981, 0))
          .norm(),
      0, 1e-15);
  expect_message(rod + "mass = 1\nforce = [0, 1, 0]\n", {"load.mass", "given besides force"});
  expect_message(rod + "mass = -1\n", {"load.mass = -1", "> 0"});
  expect_message(rod + "mass = \"1 lb\"\n", {"load.mass", "kg, g"});
  expect_message(rod, {"load.force: missing"});
  // If gamma is varied, the weight of a load's mass changes with gravity.
  const SceneTemplate base(rod + "mass = 1\n", "my.toml");
  const Scene light = base.with({{"gamma", "1"}});
  EXPECT_NEAR(light.loads.at(0).force.norm(), light.gravity.norm(), 1e-15);
}

TEST(ScenesRod, IsScaledInAllThatItIsMadeOf) {
  const std::string text = by_stiffness + "torsional_stiffness = 1e-3\n" + clamp + sections_text +
                           "[[section]]\nfrom = 0\nto = 0.1\ntorsional_stiffness = 7e-3\n";
  const Scene scene = scene_of(text);
  Scene scaled = scene;
  scaled.scale_modulus(3);
  EXPECT_DOUBLE_EQ(scaled.bending_stiffness(), 3 * scene.bending_stiffness());
  EXPECT_DOUBLE_EQ(scaled.axial_stiffness(), 3 * scene.axial_stiffness());
  EXPECT_DOUBLE_EQ(scaled.bending_compliance(0, 2), scene.bending_compliance(0, 2) / 3);
  EXPECT_DOUBLE_EQ(*scaled.torsional_stiffness, 3e-3);
  EXPECT_DOUBLE_EQ(*scaled.sections[0].torsional_stiffness, 21e-3);
  EXPECT_EQ(scaled.mass(), scene.mass());
  scaled = scene;
  scaled.scale_density(3);
  EXPECT_DOUBLE_EQ(scaled.mass(), 3 * scene.mass());
  EXPECT_EQ(scaled.bending_compliance(0, 2), scene.bending_compliance(0, 2));
}

TEST(ScenesRod, IsVariedByItsOwnKeys) {
  const SceneTemplate base(by_stiffness + clamp + sections_text, "my.toml");
  EXPECT_EQ(base.with({{"rod.bending_stiffness", "2 N m^2"}}).bending_stiffness(), 2);
  EXPECT_EQ(base.with({{"section.0.mass_per_length", "1"}}).sections[1].mass_per_length, 1);
  EXPECT_EQ(base.with({{"rod.natural_curvature", "-2"}}).natural_strain.y(), -2);
  EXPECT_EQ(base.with({{"rod.natural_curvature", "[1, 2]"}}).natural_strain.x(), 1);
  const SceneTemplate twisted(by_stiffness + "torsional_stiffness = 1e-3\n" + clamp, "my.toml");
  EXPECT_DOUBLE_EQ(*twisted.with({{"rod.bending_stiffness", "2.4e-3"}}).torsional_stiffness, 2e-3);
  EXPECT_THROW((void)base.with({{"EI", "2"}}), InputError);
}

}  // namespace
}  // namespace dlo::compare
