#include "dlo/compare/scene.hpp"

#include <gtest/gtest.h>

#include "../../says.hpp"
#include "dlo/compare/scene_file.hpp"
#include "scene_text.hpp"
#include "toml/strict_table.hpp"

namespace dlo::compare {
namespace {

const std::string good_rod = test::steel_rod;
const std::string good_gripper = R"([[gripper]]
at = 0
position = [0, "10 mm", 0]
direction = "-175 deg"
)";

TEST(Scene, ReadsTheDesignsExample) {
  const Scene scene = parse_scene(R"(name = "example"
gravity = [0, 0, -9.81]
[rod]
length = "50 cm"
diameter = "2 mm"
material = { youngs_modulus = "210 GPa", density = 7900 }
[[gripper]]
at = "10 cm"
position = [0, 0, "1 cm"]
direction = [0, 2, 0]
[[gripper]]
at = 0.5
position = [1, 0, 0]
hold = "pin"
[[load]]
at = "50 cm"
force = [0, "-100 mN", 0]
[[obstacle]]
point = [0, -0.2, 0]
normal = [0, 3, 0]
[force_model]
points = 20
law = "paper"
bookkeeping = "paper"
stepper = "dynamic"
)",
                                  "my.toml");
  EXPECT_EQ(scene.name, "example");
  EXPECT_EQ(scene.gravity, Eigen::Vector3d(0, 0, -9.81));
  EXPECT_DOUBLE_EQ(scene.material.youngs_modulus, 210e9);
  EXPECT_EQ(*scene.grippers.at(0).direction, Eigen::Vector3d(0, 1, 0));
  EXPECT_FALSE(scene.grippers.at(1).direction);
  EXPECT_DOUBLE_EQ(scene.loads.at(0).force.y(), -0.1);
  EXPECT_EQ(scene.obstacles.at(0).body.normal(), Eigen::Vector3d(0, 1, 0));
  EXPECT_EQ(scene.force_model.law, BendingLaw::paper);
  EXPECT_EQ(scene.force_model.stepper, Stepper::dynamic);
}

TEST(Scene, DerivesTheNumbersOfTable5) {
  const Scene scene = parse_scene(good_rod + good_gripper, "my.toml");
  EXPECT_NEAR(scene.axial_stiffness(), 659734, 0.5);
  EXPECT_NEAR(scene.bending_stiffness(), 0.16493361431346418, 1e-15);
  EXPECT_NEAR(scene.gamma(), 0.18452142857142853, 1e-14);
  EXPECT_NEAR(scene.mass(), 0.0124093, 1e-7);
}

struct BadScene {
  std::string text;
  std::vector<std::string> named;  // texts that the message has to contain
};

TEST(Scene, ErrorsNameFileLineKeyValueAndWhatIsAllowed) {
  const std::string held = good_rod + good_gripper;
  const std::string at_origin = good_rod + "[[gripper]]\nat = 0\nposition = [0,0,0]\n";
  const std::vector<BadScene> cases = {
      {"colour = 1\n" + good_rod + good_gripper, {"my.toml:1", "colour", "unknown key", "gravity"}},
      {"[rod]\nlength = -1\ndiameter = 1\nmaterial = \"copper\"\n" + good_gripper,
       {"my.toml:2", "rod.length", "-1", "1e-6 to"}},
      {"[rod]\nlength = \"50 cn\"\ndiameter = 1\nmaterial = \"copper\"\n" + good_gripper,
       {"my.toml:2", "rod.length", "50 cn", "m, cm, mm"}},
      {"[rod]\nlength = 1\ndiameter = 1\nmaterial = \"cooper\"\n" + good_gripper,
       {"my.toml:4", "rod.material", "cooper", "copper"}},
      {"[rod]\nlength = 1\nmaterial = \"copper\"\n" + good_gripper,
       {"my.toml:1", "rod.diameter", "required"}},
      {good_rod, {"my.toml", "gripper", "[[gripper]]"}},
      {good_rod + "[[gripper]]\nat = 0.6\nposition = [0,0,0]\ndirection = 0\n",
       {"my.toml:6", "gripper.at", "0.6", "0 to 0.5"}},
      {good_rod + "[[gripper]]\nat = 0\nposition = [0,0]\ndirection = 0\n",
       {"my.toml:7", "gripper.position", "three numbers"}},
      {at_origin + "direction = [0,0,0]\n", {"my.toml:8", "gripper.direction", "zero vector"}},
      {at_origin + "hold = \"pin\"\ndirection = 1\n", {"my.toml:9", "gripper.direction", "pin"}},
      {at_origin + "hold = \"glue\"\n", {"my.toml:8", "gripper.hold", "glue", "clamp, pin"}},
      {held + "[force_model]\npoints = 2\n", {"my.toml:10", "force_model.points", "2", "4 to"}},
      {held + "[force_model]\nc_h = 1\n", {"my.toml:10", "force_model.c_h", "0 to < 1"}},
      {"gravity = \"down\"\n" + good_rod + good_gripper, {"my.toml:1", "gravity", "three numbers"}},
      {at_origin + "direction = -175\n", {"my.toml:8", "gripper.direction", "-175", "deg"}},
      {held + "[[obstacle]]\npoint = [0, \"10 mm\", 0]\nnormal = [0, 1, 0]\n",
       {"my.toml:7", "gripper.position", "0 m from an obstacle, which the rod would enter",
        "touches = \"axis\""}},
      {held + "[[obstacle]]\npoint = [0, 1, 0]\nnormal = [0, 1, 0]\n",
       {"my.toml:7", "gripper.position", "behind an obstacle"}},
      {held + "[force_model]\nc_F = 1e-5\n", {"my.toml:9", "c_F", "no effect", "auto"}},
      {held + "[force_model]\nc_b = 100\nlaw = \"hooke\"\n",
       {"my.toml:9", "c_b", "no effect", "law paper"}},
      {"[rod]\nlength = 1e5\ndiameter = 1e-9\nmaterial = \"natural_rubber\"\n" + good_gripper,
       {"my.toml", "w l^3 / (EI)"}},
      {"name = [\n", {"my.toml:", "not valid TOML"}},
      {"gripper = 3\n" + good_rod, {"my.toml:1", "gripper", "[[gripper]]"}},
  };
  for (const BadScene& bad : cases) {
    const std::string text = scene_error(bad.text);
    EXPECT_TRUE(has_all(text, bad.named));
    EXPECT_TRUE(has_none(text, {"\n"}));
  }
}

TEST(Scene, NamesAnUnknownKeyBeforeTheOneThatIsMissingForIt) {
  const std::string held = good_rod + good_gripper;
  const std::string section = "[[section]]\nfrom = 0.1\nto = 0.2\n";
  const std::vector<std::pair<std::string, std::string>> cases = {
      {held + "[[load]]\nat = 0.4\nmoment = [0, 0, 2]\n", "load.moment = [ 0, 0, 2 ]"},
      {held + "[[load]]\nto = 0.4\nper_length = [0, 2, 0]\n", "load.per_length = [ 0, 2, 0 ]"},
      {held + section + "curvature = 3\n", "section.curvature = 3"},
      {held + "[[obstacle]]\ncentre = [0, 1, 0]\nshape = \"sphere\"\n",
       "obstacle.centre = [ 0, 1, 0 ]"},
      {good_rod + "[[gripper]]\nat = 0\nplace = [0, 0, 0]\n", "gripper.place = [ 0, 0, 0 ]"},
      {good_rod + "[[gripper]]\nat = 0\n[[gripper.pose]]\ntime = 0\npoint = [0, 0, 0]\n",
       "gripper.pose.point = [ 0, 0, 0 ]"},
      {"[rod]\nlength = 1\nbreadth = 0.1\nmaterial = \"copper\"\n" + good_gripper,
       "rod.breadth = 0.1"},
      {"[rod]\nlength = 1\ndiameter = 0.1\nmaterial = { modulus = 1, density = 1 }\n" +
           good_gripper,
       "rod.material.modulus = 1"},
      {"thread = 1\n" + good_gripper, "thread = 1"},
  };
  for (const auto& [text, key] : cases) {
    EXPECT_TRUE(has_all(scene_error(text), {key + ": unknown key"}));
  }
}

template <typename Value>
void expect_choices(const char* key, Value standard) {
  const SceneKey& row = scene_table("force_model").key(key);
  EXPECT_EQ(row.choices(), names<Value>()) << key;
  EXPECT_EQ(row.missing, to_string(standard)) << key;
}

TEST(SceneKeys, HaveTheNamesAndDefaultsOfTheSettings) {
  const ForceModelSettings settings;
  expect_choices("law", settings.law);
  expect_choices("bookkeeping", settings.bookkeeping);
  expect_choices("stepper", settings.stepper);
  expect_choices("bending_rule", settings.bending_rule);
  EXPECT_EQ(scene_table("force_model").key("joint_law").choices(), names<energy_model::JointLaw>());
  EXPECT_EQ(scene_table("force_model").key("points").missing, std::to_string(settings.points));
  EXPECT_EQ(std::stod(scene_table("track").key("frame_rate").missing), TrackRates{}.frame_rate);
  EXPECT_EQ(std::stod(scene_table("track").key("step_rate").missing), TrackRates{}.step_rate);
}

// The page and `dlo init` show each example; excludes and needs name keys of the same table.
TEST(SceneKeys, HaveExamplesAndNameKeys) {
  std::size_t keys = 0;
  for (const SceneTable& table : scene_tables()) {
    for (const SceneKey& key : table.keys) {
      for (const std::string& other : key.excludes) EXPECT_NO_THROW((void)table.key(other));
      for (const std::string& other : key.needs) EXPECT_NO_THROW((void)table.key(other));
      if (key.words.empty()) continue;
      EXPECT_EQ(parse_toml("x = " + key.example, key.name).size(), 1U) << key.name;
      EXPECT_FALSE(key.missing.empty()) << key.name;
      ++keys;
    }
  }
  EXPECT_GT(keys, 80U);
}

}  // namespace
}  // namespace dlo::compare
