#include "format/scene_document.hpp"

#include <gtest/gtest.h>

#include <numeric>
#include <string>
#include <vector>

#include "command_fixture.hpp"
#include "dlo/compare/scene_file.hpp"
#include "scene_text.hpp"

namespace dlo::compare {
namespace {

using nlohmann::ordered_json;
using test::level_clamp;
using test::says;
using test::says_none;

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

std::vector<double> numbers_of(const ordered_json& list) { return list.get<std::vector<double>>(); }

double total_of(const ordered_json& list) {
  const std::vector<double> all = numbers_of(list);
  return std::accumulate(all.begin(), all.end(), 0.0);
}

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
    EXPECT_NEAR(total_of(document.at("force_model").at("point_mass_kg")), 0.0452, 1e-15) << gravity;
  }
}

TEST(SceneDocument, JointsTogetherAreAsCompliantAsTheRodBetweenThem) {
  const ordered_json document = document_of(spliced + level_clamp);
  const ordered_json& model = document.at("force_model");
  const std::vector<double> joints = numbers_of(model.at("joint_stiffness_Nm"));
  const std::vector<double> segments = numbers_of(model.at("segment_m"));
  ASSERT_EQ(joints.size(), 14U);
  ASSERT_EQ(segments.size(), 15U);
  double compliance = 0;
  for (const double joint : joints) compliance += 1 / joint;
  // From the clamp, in the middle of the first segment, to the middle of the last.
  const double rod = 0.8 - segments.back() / 2;
  EXPECT_NEAR(compliance, (rod - 0.12) / 6e-3 + 0.12 / 0.05, 1e-10);
  EXPECT_EQ(model.at("held").at(0).at("points_m").size(), 2U);
  EXPECT_EQ(model.at("start_m").size(), 16U);
}

TEST(SceneDocument, SaysWhyThereIsNoPolygon) {
  const ordered_json document = document_of(
      "[rod]\nlength = 1\nbending_stiffness = [1e-3, 2e-3]\nmass_per_length = 0.1\n" + level_clamp);
  const ordered_json& model = document.at("force_model");
  EXPECT_TRUE(says(model.at("refused").get<std::string>(), {"two values"}));
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
  const ordered_json dynamic = model("law = \"paper\"\nstepper = \"dynamic\"\nc_F = 1e-9\n");
  EXPECT_DOUBLE_EQ(dynamic.at("c_F"), 1e-9);
  EXPECT_DOUBLE_EQ(dynamic.at("c_h"), 0.9);
  EXPECT_GT(dynamic.at("c_b").get<double>(), 0);
  EXPECT_TRUE(dynamic.at("joint_stiffness_Nm").is_null());
}

TEST(SceneDocument, AnObstacleIsWhatTheAxisStaysOutOf) {
  const std::string rod =
      "[rod]\nlength = 1\ndiameter = \"2 cm\"\nmaterial = \"copper\"\n" + level_clamp;
  const auto obstacle = [&](const std::string& keys) {
    return document_of(rod + "[[obstacle]]\n" + keys).at("obstacles").at(0);
  };
  const ordered_json plane = obstacle("point = [0, -0.5, 0]\nnormal = [0, 2, 0]\n");
  EXPECT_EQ(plane.at("shape"), "plane");
  EXPECT_EQ(plane.at("point_m"), ordered_json({0.0, -0.49, 0.0}));
  EXPECT_EQ(plane.at("normal"), ordered_json({0.0, 1.0, 0.0}));
  EXPECT_TRUE(plane.at("stiffness_N_per_m2").is_null());
  const std::string below = "point = [0.5, -0.5, 0]\n";
  const ordered_json ball = obstacle("shape = \"sphere\"\nradius = 0.1\nstiffness = 5e3\n" + below);
  EXPECT_EQ(ball.at("shape"), "sphere");
  EXPECT_DOUBLE_EQ(ball.at("radius_m"), 0.11);
  EXPECT_DOUBLE_EQ(ball.at("stiffness_N_per_m2"), 5e3);
  const ordered_json peg = obstacle(
      "shape = \"cylinder\"\nradius = 0.1\naxis = [0, 0, 1]\ntouches = \"axis\"\n" + below);
  EXPECT_EQ(peg.at("shape"), "cylinder");
  EXPECT_DOUBLE_EQ(peg.at("radius_m"), 0.1);
  EXPECT_DOUBLE_EQ(std::abs(peg.at("axis").at(2).get<double>()), 1);
  const ordered_json capsule =
      obstacle("shape = \"capsule\"\nradius = 0.1\nlength = 0.3\naxis = [0, 0, 1]\n" + below);
  EXPECT_EQ(capsule.at("shape"), "capsule");
  EXPECT_DOUBLE_EQ(capsule.at("length_m"), 0.3);
  const ordered_json box = obstacle("shape = \"box\"\nsize = [0.1, 0.2, 0.3]\n" + below);
  EXPECT_EQ(box.at("shape"), "box");
  for (const std::size_t i : {0U, 1U, 2U}) {
    EXPECT_DOUBLE_EQ(box.at("size_m").at(i), 0.1 * static_cast<double>(i + 1) + 0.02) << i;
  }
  EXPECT_DOUBLE_EQ(box.at("radius_m"), 0.01);
}

class SceneCommand : public dlo::test::Command {};

TEST_F(SceneCommand, WritesTheDocumentAndTheSameForPeople) {
  const std::string twisted = std::string(DLO_DATA) + "/scenes/twisted_wire.toml";
  const std::string result = said("scene --points 8 -o " + path("s.json") + " " + twisted);
  const ordered_json document = ordered_json::parse(read(path("s.json")));
  Scene scene = load_scene(twisted);
  scene.force_model.points = 8;
  EXPECT_EQ(document, ordered_json::parse(scene_document_text(scene)));
  const dlo::test::Outcome text = run("scene " + twisted);
  EXPECT_TRUE(says(text.out, {"GJ 0.00793 N m^2", "frame held: roll 3.14159 rad"}));
  EXPECT_TRUE(says_none(text.out, {"null"}));
  expect_error("scene --format csv " + twisted, 2, {"--format", "csv"});
}

}  // namespace
}  // namespace dlo::compare
