// Tests of scenes made in code: they equal the scene of a file with the same fields, and invalid
// ones are refused with the same message.

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "../../says.hpp"
#include "dlo/compare.hpp"
#include "scene_text.hpp"

namespace dlo::compare {
namespace {

const std::string text = R"(name = "led over a peg"
gravity = [0, 0, "-9.81 m/s^2"]

[rod]
length = "30 cm"
diameter = 0.5e-3
material = { youngs_modulus = "117 GPa", density = 8960 }
natural_curvature = [[1, 0], [0.5, 0.25]]

[[gripper]]
at = 0
position = [0, "5 cm", 0]
frame = [[0, 1, 0], [0, 0, 1], [1, 0, 0]]

[[gripper]]
at = "30 cm"
position = [0.1, 0.1, 0.15]
hold = "pin"

[force_model]
points = 32
law = "hooke"
)";

const std::vector<SceneField> fields = {{"name", "led over a peg"},
                                        {"gravity", {0, 0, "-9.81 m/s^2"}},
                                        {"rod.length", "30 cm"},
                                        {"rod.diameter", 0.5e-3},
                                        {"rod.material.youngs_modulus", "117 GPa"},
                                        {"rod.material.density", 8960},
                                        {"rod.natural_curvature", {{1, 0}, {0.5, 0.25}}},
                                        {"gripper.0.at", 0},
                                        {"gripper.0.position", {0, "5 cm", 0}},
                                        {"gripper.0.frame", {{0, 1, 0}, {0, 0, 1}, {1, 0, 0}}},
                                        {"gripper.1.at", std::string("30 cm")},
                                        {"gripper.1.position", Eigen::Vector3d(0.1, 0.1, 0.15)},
                                        {"gripper.1.hold", "pin"},
                                        {"force_model.points", 32},
                                        {"force_model.law", "hooke"}};

Scene copper_wire() {
  return make_scene({{"rod.length", "30 cm"},
                     {"rod.diameter", "0.5 mm"},
                     {"rod.material", "copper"},
                     {"gripper.0.at", 0},
                     {"gripper.0.position", {0, 0, 0}},
                     {"gripper.0.direction", "30 deg"}});
}

/// Removes the line numbers, which a scene that was made in code does not have.
Scene without_line_numbers(Scene scene) {
  for (Gripper& gripper : scene.grippers) gripper.where.clear();
  return scene;
}

TEST(MakeScene, IsTheSceneOfAFileWithTheSameFields) {
  EXPECT_EQ(without_line_numbers(make_scene(fields, "my.toml")),
            without_line_numbers(parse_scene(text, "my.toml")));
}

TEST(MakeScene, TakesPosesAndAllElementsOfAList) {
  std::vector<SceneField> moving = fields;
  for (const int pose : {0, 1}) {
    const std::string path = "gripper.2.pose." + std::to_string(pose) + ".";
    moving.push_back({path + "time", pose});
    moving.push_back({path + "position", {0.1 * pose, 0.1, 0.1}});
  }
  moving.push_back({"gripper.2.at", "15 cm"});
  moving.push_back({"gripper.2.hold", "pin"});
  const Scene scene = make_scene(moving);
  ASSERT_EQ(scene.grippers.size(), 3U);
  EXPECT_EQ(motion_time_span(scene)->end, 1);
  EXPECT_EQ(scene.file, "scene");
}

TEST(MakeScene, RefusesWhatAFileMayNotSayInTheSameWords) {
  struct Wrong {
    SceneField field;
    std::string said;   ///< text in the correct file
    std::string meant;  ///< text that replaces it, with the same error as the field
  };
  const std::vector<Wrong> all = {
      {{"rod.length", "30 inch"}, "length = \"30 cm\"", "length = \"30 inch\""},
      {{"rod.diameter", -1}, "diameter = 0.5e-3", "diameter = -1"},
      {{"rod.colour", "red"}, "diameter = 0.5e-3", "diameter = 0.5e-3\ncolour = \"red\""},
      {{"gripper.1.hold", "glue"}, "hold = \"pin\"", "hold = \"glue\""},
      {{"gripper.0.position", {0, 0}}, "position = [0, \"5 cm\", 0]", "position = [0, 0]"}};
  for (const auto& [field, said, meant] : all) {
    const std::string wrong = replaced(text, said, meant);
    std::vector<SceneField> made = fields;
    made.push_back(field);
    const std::string file_refusal =
        error_of<InputError>([&] { return parse_scene(wrong, "scene"); });
    const std::string scene_refusal = error_of<InputError>([&] { return make_scene(made); });
    // But for the line, from the key on.
    const std::string key = field.field.substr(field.field.rfind('.') + 1);
    ASSERT_TRUE(has_all(file_refusal, {key}));
    ASSERT_TRUE(has_all(scene_refusal, {key}));
    EXPECT_EQ(scene_refusal.substr(scene_refusal.find(key)),
              file_refusal.substr(file_refusal.find(key)));
    EXPECT_EQ(scene_refusal.rfind("scene", 0), 0U) << scene_refusal;
  }
}

TEST(MakeScene, SaysWhichElementIsMissing) {
  std::vector<SceneField> made = fields;
  made.push_back({"gripper.4.at", 0});
  EXPECT_TRUE(has_all(error_of<InputError>([&] { return make_scene(made); }), {"allowed: 0 to 1"}));
  EXPECT_TRUE(has_all(error_of<InputError>([] { return make_scene({}); }), {"rod"}));
}

// Arc lengths beyond an end by the rounding error of a sum of segments.
TEST(ArcLengths, ARoundingBeyondAnEndAreThatEnd) {
  std::vector<SceneField> rounded = fields;
  rounded.push_back({"gripper.1.at", 0.30000001});
  EXPECT_EQ(make_scene(rounded).grippers[1].at, 0.3);
  rounded.push_back({"gripper.0.at", -1e-8});
  EXPECT_EQ(make_scene(rounded).grippers[0].at, 0);
  rounded.push_back({"gripper.1.at", 0.3001});
  EXPECT_TRUE(
      has_all(error_of<InputError>([&] { return make_scene(rounded); }), {"allowed: 0 to 0.3 m"}));
  EXPECT_EQ(*on_rod(0.3 + 1e-8, 0.3), 0.3);
  EXPECT_FALSE(on_rod(0.3 + 1e-6, 0.3));
  EXPECT_FALSE(on_rod(std::nan(""), 0.3));

  const Scene wire = copper_wire();
  for (const Model model : {Model::energy, Model::exact, Model::chain}) {
    const Shape shape = solve(wire, model, {}, {-1e-8, 0.15, 0.3 + 1e-8}).shape;
    EXPECT_EQ(shape.arc_length, (std::vector<double>{0, 0.15, 0.3})) << to_string(model);
    EXPECT_EQ(error_of<InputError>([&] {
                return solve(wire, model, {}, {0, 0.31});
              }),
              "solve: s = 0.31 m (allowed: 0 to 0.3 m)");
  }
}

}  // namespace
}  // namespace dlo::compare
