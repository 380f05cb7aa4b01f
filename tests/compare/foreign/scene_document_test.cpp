#include "format/scene_document.hpp"

#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

#include "command_fixture.hpp"
#include "dlo/compare/scene_file.hpp"
#include "scene_text.hpp"

namespace dlo::compare {
namespace {

using nlohmann::ordered_json;

ordered_json document_of(const std::string& text) {
  return scene_document(parse_scene(text, "scene.toml"));
}

const std::string spliced = R"(
[rod]
length = "80 cm"
diameter = "6 mm"
bending_stiffness = "6e-3 N m^2"
mass_per_length = "40 g/m"
torsional_stiffness = "5e-3 N m^2"
[[section]]
from = "30 cm"
to = "42 cm"
bending_stiffness = "0.05 N m^2"
mass_per_length = "150 g/m"
[[load]]
at = "45 cm"
mass = "10 g"
)";

TEST(SceneDocument, ResolvesUnitsMaterialsMassesAndSections) {
  const ordered_json document = document_of(spliced + level_clamp);
  EXPECT_EQ(document.at("schema"), "dlo/scene/1");
  const ordered_json& rod = document.at("rod");
  EXPECT_DOUBLE_EQ(rod.at("length_m"), 0.8);
  EXPECT_TRUE(rod.at("material").is_null());
  EXPECT_TRUE(rod.at("youngs_modulus_Pa").is_null());
  EXPECT_EQ(rod.at("bending_stiffness_Nm2"), ordered_json({6e-3, 6e-3}));
  EXPECT_DOUBLE_EQ(rod.at("axial_stiffness_N"), 16 * 6e-3 / (6e-3 * 6e-3));
  EXPECT_DOUBLE_EQ(rod.at("mass_kg"), 0.68 * 0.04 + 0.12 * 0.15);
  const ordered_json& section = rod.at("sections").at(0);
  // GJ of a section keeps the rod's ratio to EI.
  EXPECT_DOUBLE_EQ(section.at("torsional_stiffness_Nm2"), 5e-3 * 0.05 / 6e-3);
  EXPECT_EQ(document.at("loads").at(0).at("force_N"), ordered_json({0.0, 0.01 * -9.81, 0.0}));
  EXPECT_EQ(document.at("plane_normal").size(), 3U);
  const ordered_json& gripper = document.at("grippers").at(0);
  EXPECT_EQ(gripper.at("hold"), "clamp");
  EXPECT_TRUE(gripper.at("frame").is_null());
}

TEST(SceneDocument, PointMassesAreTheRodsWithAndWithoutGravity) {
  const std::string held = spliced + level_clamp;
  for (const std::string gravity : {"", "gravity = [0, 0, 0]\n"}) {
    const ordered_json document = document_of(gravity + held);
    double total = 0;
    for (const double mass : document.at("force_model").at("point_mass_kg")) total += mass;
    EXPECT_NEAR(total, 0.0452, 1e-15) << gravity;
  }
}

TEST(SceneDocument, JointsTogetherAreAsCompliantAsTheRodBetweenThem) {
  const ordered_json document = document_of(spliced + level_clamp);
  const ordered_json& model = document.at("force_model");
  ASSERT_EQ(model.at("joint_stiffness_Nm").size(), 14U);
  ASSERT_EQ(model.at("segment_m").size(), 15U);
  double compliance = 0;
  for (const double joint : model.at("joint_stiffness_Nm")) compliance += 1 / joint;
  // The joints represent the rod from the clamp, which is in the middle of the first segment, to
  // the middle of the last segment.
  const double rod = 0.8 - model.at("segment_m").back().get<double>() / 2;
  EXPECT_NEAR(compliance, (rod - 0.12) / 6e-3 + 0.12 / 0.05, 1e-10);
  EXPECT_EQ(model.at("held").at(0).at("points_m").size(), 2U);
  EXPECT_EQ(model.at("start_m").size(), 16U);
}

TEST(SceneDocument, SaysWhyThereIsNoPolygon) {
  const ordered_json document = document_of(
      "[rod]\nlength = 1\nbending_stiffness = [1e-3, 2e-3]\nmass_per_length = 0.1\n" + level_clamp);
  const ordered_json& model = document.at("force_model");
  EXPECT_TRUE(has_all(model.at("refused").get<std::string>(), {"two values"}));
  EXPECT_FALSE(model.contains("segment_m"));
  EXPECT_EQ(document.at("rod").at("bending_stiffness_Nm2"), ordered_json({1e-3, 2e-3}));
  EXPECT_TRUE(document.at("rod").at("torsional_stiffness_is_assumed"));
  EXPECT_EQ(document.at("rod").at("first_frame").at(2), ordered_json({1.0, 0.0, 0.0}));
}

TEST(SceneDocument, TheConstantsOfTheStepperAreThoseOfItsSimulation) {
  const auto model = [](const std::string& settings) {
    return document_of("[rod]\nlength = 1\ndiameter = 0.01\nmaterial = \"copper\"\n" + level_clamp +
                       "[force_model]\n" + settings)
        .at("force_model");
  };
  const ordered_json chosen = model("law = \"hooke\"\n");
  EXPECT_TRUE(chosen.at("c_F").is_null());
  EXPECT_TRUE(chosen.at("c_b").is_null());
  EXPECT_TRUE(chosen.at("l_s_m").is_null());
  EXPECT_DOUBLE_EQ(model("stepper = \"auto\"\nl_s = 2e-3\n").at("l_s_m"), 2e-3);
  const ordered_json dynamic = model("law = \"paper\"\nstepper = \"dynamic\"\nc_F = 1e-9\n");
  EXPECT_DOUBLE_EQ(dynamic.at("c_F"), 1e-9);
  EXPECT_DOUBLE_EQ(dynamic.at("c_h"), 0.9);
  EXPECT_GT(dynamic.at("c_b").get<double>(), 0);
  EXPECT_TRUE(dynamic.at("joint_stiffness_Nm").is_null());
}

/// Expects equal values, numbers and vectors to rounding.
void expect_near(const ordered_json& value, const ordered_json& expected) {
  if (expected.is_array()) {
    ASSERT_EQ(value.size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) expect_near(value.at(i), expected.at(i));
  } else if (expected.is_number()) {
    EXPECT_DOUBLE_EQ(value.get<double>(), expected.get<double>());
  } else {
    EXPECT_EQ(value, expected);
  }
}

TEST(SceneDocument, AnObstacleIsWhatTheAxisStaysOutOf) {
  const std::string rod =
      "[rod]\nlength = 1\ndiameter = \"2 cm\"\nmaterial = \"copper\"\n" + level_clamp;
  const auto obstacle = [&](const std::string& keys) {
    return document_of(rod + "[[obstacle]]\n" + keys).at("obstacles").at(0);
  };
  const std::string below = "point = [0.5, -0.5, 0]\n";
  const std::vector<std::array<std::string, 2>> cases = {
      {"point = [0, -0.5, 0]\nnormal = [0, 2, 0]\n",
       R"({"shape": "plane", "point_m": [0, -0.49, 0], "normal": [0, 1, 0],
           "stiffness_N_per_m2": null})"},
      {"shape = \"sphere\"\nradius = 0.1\nstiffness = 5e3\n" + below,
       R"({"shape": "sphere", "radius_m": 0.11, "stiffness_N_per_m2": 5e3})"},
      {"shape = \"cylinder\"\nradius = 0.1\naxis = [0, 0, 1]\ntouches = \"axis\"\n" + below,
       R"({"shape": "cylinder", "radius_m": 0.1, "axis": [0, 0, 1]})"},
      {"shape = \"capsule\"\nradius = 0.1\nlength = 0.3\naxis = [0, 0, 1]\n" + below,
       R"({"shape": "capsule", "length_m": 0.3})"},
      {"shape = \"box\"\nsize = [0.1, 0.2, 0.3]\n" + below,
       R"({"shape": "box", "size_m": [0.12, 0.22, 0.32], "radius_m": 0.01})"}};
  for (const auto& [keys, expected] : cases) {
    const ordered_json document = obstacle(keys);
    const ordered_json values = ordered_json::parse(expected);
    for (const auto& [key, value] : values.items()) {
      expect_near(document.at(key), value);
    }
  }
}

class SceneCommand : public dlo::test::Command {};

TEST_F(SceneCommand, WritesTheDocumentAndTheSameForPeople) {
  const std::string twisted = std::string(DLO_DATA) + "/scenes/twisted_wire.toml";
  const std::string result = output_of("scene --points 8 -o " + path("s.json") + " " + twisted);
  const ordered_json document = ordered_json::parse(read(path("s.json")));
  Scene scene = load_scene(twisted);
  scene.force_model.points = 8;
  EXPECT_EQ(document, ordered_json::parse(scene_document_text(scene)));
  const dlo::test::RunResult text = run("scene " + twisted);
  EXPECT_TRUE(has_all(text.out, {"\n  torsional stiffness", " 0.00793 N m^2\n", "3.142"}));
  EXPECT_TRUE(has_none(text.out, {"null"}));
  expect_error("scene --format csv " + twisted, 2, {"--format", "csv"});
}

}  // namespace
}  // namespace dlo::compare
