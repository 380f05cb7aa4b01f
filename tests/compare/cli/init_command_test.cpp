// Tests of dlo without arguments, dlo init and dlo materials, which new users run first.

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "command_fixture.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/scene_file.hpp"
#include "dlo/compare/solution.hpp"
#include "dlo/compare/solve.hpp"
#include "reading/new_scene.hpp"
#include "toml/scene_keys.hpp"

namespace dlo::compare {
namespace {

/// Returns the optional paragraphs of a scene file, without the # of their lines.
std::vector<std::string> optional_paragraphs(const std::string& text) {
  std::vector<std::string> paragraphs;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const bool optional = line.size() > 1 && line[0] == '#' && line[1] != ' ';
    if (optional && line[1] == '[') paragraphs.emplace_back();
    if (optional) paragraphs.back() += line.substr(1) + "\n";
  }
  return paragraphs;
}

TEST_F(Command, WithoutArgumentsTellsWhatThereIsToDo) {
  const RunResult result = run("");
  EXPECT_EQ(result.status, 0);
  EXPECT_EQ(result.err, "");
  EXPECT_EQ(result.out, run("--help").out);
  // Headings in the order in which a user needs them, each followed by its first command.
  const std::regex order(
      "\nBegin\n  init [^]*\nSee a shape\n  solve [^]*\nIs my simulator's shape right\\?\n  check "
      "[^]*\nGet parameters\n  calibrate [^]*\nKeep it from getting worse\n  regress ");
  EXPECT_TRUE(std::regex_search(result.out, order)) << result.out;
  std::istringstream lines(result.out);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 80U) << line;
}

TEST_F(Command, InitPrintsALargeModulusInGigapascal) {
  EXPECT_TRUE(
      has_all(output_of("init " + path("steel") + " --material spring_steel"), {" GPa, density"}));
}

TEST_F(Command, SuggestsTheNearestWord) {
  expect_error("slove", 2, {"slove", "did you mean solve?", "regress"});
  expect_error("solve " + steel() + " --modle chain", 2, {"--modle", "did you mean --model?"});
  expect_error("solve " + steel() + " --model=chain two.toml", 2, {"two.toml", "too many"});
  expect_error("init --material silicon", 2, {"silicon", "did you mean silicone?", "nitinol"});
  expect_error("dance", 2, {"unknown command dance (allowed: init"});
}

TEST_F(Command, InitWritesASceneThatSolves) {
  const std::string file = path("cable.toml");
  EXPECT_TRUE(
      has_all(output_of("init " + file + " --length 2m --diameter '6 mm' --material silicone"),
              {"dlo solve " + file}));
  const Scene scene = load_scene(file);
  EXPECT_EQ(scene.name, "cable");
  EXPECT_EQ(scene.length, 2);
  EXPECT_EQ(scene.diameter, 0.006);
  EXPECT_EQ(scene.material.name, "silicone");
  for (const std::string model : {"energy", "chain", "exact", "force"}) {
    succeeds(words({"solve", file, "--model", model}));
  }
}

TEST_F(Command, InitTakesANameAndAMaterialOfOnesOwn) {
  const std::string arguments = "--youngs-modulus '5 MPa' --density 1100 --direction '[0, 0, 1]'";
  const std::string result = output_of("init '" + path("my hose") + "' " + arguments);
  const Scene scene = load_scene(path("my_hose.toml"));
  EXPECT_EQ(scene.name, "my hose");
  EXPECT_EQ(scene.material.youngs_modulus, 5e6);
  EXPECT_EQ(*scene.grippers.front().direction, Eigen::Vector3d::UnitZ());
  expect_error("init " + path("a") + " --youngs-modulus '5 MPa'", 2, {"--density"});
  expect_error("init " + path("a") + " --density 1000", 2, {"--youngs-modulus"});
}

// Writes the same rod for a world with z upwards.
TEST_F(Command, InitWritesASceneWithZUp) {
  const std::string rod = " --direction '-30 deg' --length '0.5 m' --up ";
  succeeds("init " + path("y.toml") + rod + "y");
  succeeds("init " + path("z.toml") + rod + "z");
  const Scene z = load_scene(path("z.toml"));
  EXPECT_EQ(z.gravity, Eigen::Vector3d(0, 0, -9.81));
  const json at_y = json_of("solve " + path("y.toml"));
  const json at_z = json_of("solve " + path("z.toml"));
  const auto tip = [](const json& shape, int axis) {
    return shape.at("points_m").back().at(static_cast<std::size_t>(axis)).get<double>();
  };
  EXPECT_NEAR(tip(at_z, 0), tip(at_y, 0), 1e-9);
  EXPECT_NEAR(tip(at_z, 2), tip(at_y, 1), 1e-9);
  EXPECT_TRUE(has_all(read(path("z.toml")), {"normal = [0, 0, 1]"}));
  expect_error("init " + path("x.toml") + " --up x", 2, {"--up", "y", "z"});
}

TEST_F(Command, InitNeverOverwritesUnasked) {
  const std::string file = scene("mine");
  expect_error("init " + file, 2, {file, "exists", "--force"});
  EXPECT_EQ(read(file), "mine");
  // A wrong value creates no file, leaves no incomplete file, and does not change an existing one.
  expect_error("init --force " + file + " --length '2 feet'", 2,
               {"--length", "feet", "m, cm, mm, um"});
  EXPECT_EQ(read(file), "mine");
  expect_error("init " + path("new.toml") + " --diameter -1", 2, {"--diameter", "-1"});
  EXPECT_FALSE(std::filesystem::exists(path("new.toml")));
  succeeds("init --force " + file);
  EXPECT_NO_THROW((void)load_scene(file));
}

TEST_F(Command, InitTakesAnyNameAndNamesTheOptionThatIsWrong) {
  // Names that look like numbers, need quotes in a shell, or are too long for a file.
  for (const std::string name : {"2025", "nan", "it's", "a \"b\""}) {
    const std::string quoted = name == "it's" ? "it\\'s" : "'" + name + "'";
    const std::string result = output_of("init " + path("") + quoted);
    // A shell accepts the command that the text recommends.
    const std::size_t at = result.find("dlo solve ") + 4;
    EXPECT_EQ(run(result.substr(at, result.find("      ", at) - at)).status, 0) << result;
  }
  EXPECT_EQ(load_scene(path("2025.toml")).name, "2025");
  expect_error("init " + path(std::string(300, 'a')), 2, {"too long"});
  const std::string init = "init " + path("b") + " ";
  expect_error(init + "--length '6 mm' --diameter '2 m'", 2, {"--diameter = 2 m", "thicker"});
  expect_error(init + "--direction '[0, 0]'", 2, {"--direction", "three numbers"});
  expect_error(init + "--youngs-modulus -3 --density 3", 2, {"--youngs-modulus", "> 0"});
}

// Rods that are stiff and soft, thin and thick, in directions of the plane and of space.
TEST(SceneText, IsValidWithAnyAndAllOptionalPartsAndSolves) {
  for (const SceneChoices& choices :
       {SceneChoices{
            .length = "0.5", .diameter = "0.5 mm", .material = "nitinol", .direction = "30 deg"},
        SceneChoices{.diameter = "20 mm",
        .youngs_modulus = "1 GPa",
        .density = "1500 kg/m^3",
        .direction = "[1, 1, 1]"},
        SceneChoices{.youngs_modulus = "1 GPa", .density = "0", .direction = "-90 deg"},
        SceneChoices{.length = "1 m", .diameter = "0.3 m"}}) {
    const std::string text = scene_text(choices);
    const std::vector<std::string> paragraphs = optional_paragraphs(text);
    ASSERT_EQ(paragraphs.size(), 6U);
    std::string all = text;
    for (const std::string& paragraph : paragraphs) {
      const Scene scene = parse_scene(text + paragraph, "scene.toml");
      EXPECT_NO_THROW((void)solve(scene, Model::energy)) << text << paragraph;
      all += paragraph;
    }
    const Scene scene = parse_scene(all, "scene.toml");
    EXPECT_EQ(scene.grippers.size(), 2U);
    EXPECT_EQ(scene.loads.size(), 1U);
    EXPECT_EQ(scene.sections.size(), 1U);
    EXPECT_EQ(scene.obstacles.size(), 1U);
    EXPECT_NO_THROW((void)solve(scene, Model::energy)) << all;
  }
}

TEST(SceneText, ExplainsEveryKeyThatAScenesTablesKnow) {
  const std::string text = scene_text({});
  for (const SceneTable& table : scene_tables()) {
    for (const SceneKey& key : table.keys) {
      if (key.words.empty()) continue;
      EXPECT_TRUE(std::regex_search(text, std::regex("\n(#|#   )?" + key.name + " = ")))
          << key.name;
    }
  }
}

}  // namespace
}  // namespace dlo::compare
