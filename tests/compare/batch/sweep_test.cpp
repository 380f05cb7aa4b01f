// Tests of sweeps: grids, scenes with other values, and rows of the table.

#include "batch/sweep.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "../../says.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/force_model_settings.hpp"
#include "dlo/compare/scene_file.hpp"
#include "sweep_scene.hpp"

namespace dlo::compare {
namespace {

std::vector<std::string> values(const std::string& text) {
  const Axis axis = parse_axis(text);
  std::vector<std::string> result;
  for (std::int64_t i = 0; i < axis.count; ++i) result.push_back(axis.value(i));
  return result;
}

TEST(SweepGrid, ReadsListsRangesAndUnits) {
  using Values = std::vector<std::string>;
  EXPECT_EQ(values("a=1,2.50,copper"), (Values{"1", "2.50", "copper"}));
  EXPECT_EQ(values("a=[0, 1, 0],[1,0,0]"), (Values{"[0, 1, 0]", "[1,0,0]"}));
  EXPECT_EQ(values("a=lin:0:1:11")[3], "0.3");
  EXPECT_EQ(values("a=lin:64:4:3"), (Values{"64", "34", "4"}));
  EXPECT_EQ(values("a=log:8:128:5"), (Values{"8", "16", "32", "64", "128"}));
  EXPECT_EQ(values("a=log:1 GPa:100GPa:3"), (Values{"1 GPa", "10 GPa", "100 GPa"}));
  EXPECT_EQ(values("a=lin:-1:1:3")[1], "0");
  EXPECT_EQ(values("a=0.1234567890123456,1")[0], "0.1234567890123456");
  EXPECT_EQ(parse_axis("a=1 cm,2cm").column(), "a [cm]");
  EXPECT_EQ(parse_axis("a=1 cm,2 mm").column(), "a");
}

TEST(SweepGrid, RefusesWhatIsNoAxisAndSaysWhy) {
  const std::pair<const char*, const char*> cases[] = {
      {"rod.length", "\"=\""},
      {"=1", "no field"},
      {"a=", "empty"},
      {"a=1,,2", "empty"},
      {"a=lin:1:2", "three parts"},
      {"a=lin:1:2:1", "from 2"},
      {"a=lin:x:2:3", "\"x\""},
      {"a=lin:1:nan:3", "\"nan\""},
      {"a=lin:1 m:2 cm:3", "units"},
      {"a=lin:2:2:3", "same"},
      {"a=log:-1:1:3", "positive"},
      {"a=1\n2", "control character"},
      {"a=lin:1:2:99999999999999999999", "from 2"}};
  for (const auto& [text, words] : cases) {
    const std::string message = error_of<InputError>([&, axis = text] { (void)parse_axis(axis); });
    EXPECT_TRUE(has_all(message, {words, "allowed"})) << text;
  }
}

TEST(SweepGrid, LastFieldChangesFastestAndNothingIsStored) {
  const Grid grid({parse_axis("a=1,2"), parse_axis("b=lin:0:1:3")});
  EXPECT_EQ(grid.size(), 6);
  EXPECT_EQ(grid.indices(4), (std::vector<std::int64_t>{1, 1}));
  const Grid large({parse_axis("a=lin:0:1:1000000"), parse_axis("b=lin:0:1:1000000000")});
  EXPECT_EQ(large.size(), 1'000'000'000'000'000);
  EXPECT_EQ(large.indices(large.size() - 1), (std::vector<std::int64_t>{999'999, 999'999'999}));
  EXPECT_THROW(Grid({parse_axis("a=lin:0:1:1000001"), parse_axis("b=lin:0:1:1000000000")}),
               InputError);
}

TEST(SweepGrid, RefusesFieldsInsideEachOther) {
  EXPECT_THROW(Grid({parse_axis("a=1"), parse_axis("a=2")}), InputError);
  EXPECT_THROW(Grid({parse_axis("rod.material.density=1"), parse_axis("rod.material=copper")}),
               InputError);
  EXPECT_EQ(Grid({parse_axis("rod.length=1"), parse_axis("rod.length_unit=2")}).size(), 1);
}

TEST(SceneTemplate, GivesTheSceneThatAnEditedFileWouldGive) {
  const std::string edited = replaced(replaced(sweep_scene, "50 cm", "70 cm"), "0 deg", "30 deg") +
                             "[force_model]\npoints = 24\nlaw = \"paper\"\n";
  const Scene expected = parse_scene(edited, "swept.toml");
  const Scene scene = SceneTemplate(sweep_scene, "swept.toml")
                          .with({{"rod.length", "70 cm"},
                                 {"gripper.0.direction", "30 deg"},
                                 {"force_model.points", "24"},
                                 {"force_model.law", "paper"}});
  EXPECT_EQ(scene.length, expected.length);
  EXPECT_EQ(*scene.grippers[0].direction, *expected.grippers[0].direction);
  EXPECT_EQ(scene.force_model.points, 24);
  EXPECT_EQ(scene.force_model.law, BendingLaw::paper);
  EXPECT_EQ(scene.gamma(), expected.gamma());
  const std::string mjcf = DLO_DATA "/mujoco/composite.xml";
  const Scene cable = load_scene_template(mjcf).with({{"rod.length", "2"}});
  EXPECT_EQ(cable.file, "composite.xml");
  EXPECT_EQ(cable.model->segments, load_scene(mjcf).model->segments);
}

TEST(SceneTemplate, SetsVectorsTheirElementsAndPartsOfAMaterial) {
  const SceneTemplate base(sweep_scene, "swept.toml");
  EXPECT_EQ(base.with({{"gripper.0.position", "[0, \"2 cm\", 1]"}}).grippers[0].position,
            Eigen::Vector3d(0, 0.02, 1));
  EXPECT_EQ(base.with({{"gripper.0.position.1", "5 mm"}}).grippers[0].position.y(), 0.005);
  EXPECT_EQ(base.with({{"rod.material", "copper"}}).material.name, "copper");
  const Scene scene = base.with({{"rod.material.youngs_modulus", "7 GPa"}});
  EXPECT_EQ(scene.material.youngs_modulus, 7e9);
  EXPECT_EQ(scene.material.density, 7900);
}

TEST(SceneTemplate, GammaScalesGravityWhateverElseIsVaried) {
  const SceneTemplate base(sweep_scene, "swept.toml");
  const Scene scene = base.with({{"gamma", "12.5"}, {"rod.length", "2"}, {"gravity", "[0, 3, 4]"}});
  EXPECT_NEAR(scene.gamma(), 12.5, 1e-12);
  EXPECT_NEAR(scene.gravity.normalized().z(), 0.8, 1e-15);
  EXPECT_EQ(base.with({{"gamma", "0"}}).gamma(), 0);
  for (const std::string bad : {"-1", "nan", "inf", "x", "1 m", ""}) {
    EXPECT_THROW((void)base.with({{"gamma", bad}}), InputError) << bad;
  }
  EXPECT_THROW((void)base.with({{"gamma", "1"}, {"gravity", "[0, 0, 0]"}}), InputError);
}

TEST(SceneTemplate, TorsionKeepsItsRatioToBendingUnlessItIsVaried) {
  const std::string text =
      replaced(sweep_scene, "[[gripper]]", "torsional_stiffness = 0.1\n[[gripper]]");
  const SceneTemplate base(text, "swept.toml");
  const double ratio = 0.1 / base.with({}).bending_stiffness();
  EXPECT_EQ(base.with({}).torsional_stiffness, 0.1);
  EXPECT_EQ(base.with({{"rod.length", "2"}, {"gamma", "3"}}).torsional_stiffness, 0.1);
  for (const auto& [field, value] :
       {std::pair{"rod.diameter", "1 mm"}, std::pair{"rod.material.youngs_modulus", "7 GPa"},
        std::pair{"rod.material", "copper"}}) {
    const Scene scene = base.with({{field, value}});
    EXPECT_NEAR(*scene.torsional_stiffness / scene.bending_stiffness(), ratio, 1e-12) << field;
    EXPECT_EQ(
        base.with({{field, value}, {"rod.torsional_stiffness", "0.2 N m^2"}}).torsional_stiffness,
        0.2);
  }
  // A file that is no scene by itself has no ratio to keep.
  const std::string no_length = std::string(text).erase(text.find("length"), 16);
  const SceneTemplate part(no_length, "swept.toml");
  EXPECT_EQ(part.with({{"rod.length", "1"}, {"rod.diameter", "3 mm"}}).torsional_stiffness, 0.1);
}

TEST(SceneTemplate, ErrorsNameFileFieldAndValue) {
  const SceneTemplate base(sweep_scene, "swept.toml");
  const std::pair<SceneField, const char*> cases[] = {{{"rod.lenght", "1"}, "unknown key"},
                                                      {{"rod.length", "-1"}, "1e-6 to"},
                                                      {{"gripper.1.at", "0"}, "0 to 0"},
                                                      {{"rod.length.x", "1"}, "has no parts"},
                                                      {{"rod..length", "1"}, "empty"},
                                                      {{"gravity", "[0, 1"}, "not valid TOML"},
                                                      {{"gravity", "[0,0,0]\nx = 1"}, "no vector"},
                                                      {{"rod", "3"}, "must be a table"},
                                                      {{"gripper", "3"}, "[[gripper]]"}};
  for (const auto& [field, words] : cases) {
    const std::string message =
        error_of<InputError>([&, value = field] { (void)base.with({value}); });
    EXPECT_TRUE(has_all(message, {words, "swept.toml"})) << field.field;
  }
}

TEST(Sweep, EveryModelFillsItsColumns) {
  for (const std::string& name : names<SweepModel>()) {
    const Sweep one = sweep({"gamma=2"}, from_name<SweepModel>(name));
    const std::string header = one.header();
    const std::vector<SweepCell> cells = one.cells(0);
    const std::string row = one.line(cells);
    EXPECT_EQ(std::count(row.begin(), row.end(), ','),
              std::count(header.begin(), header.end(), ','))
        << name;
    EXPECT_TRUE(has_none(row, {",,"}));
    EXPECT_EQ(row.substr(row.size() - 4), ",ok\n") << row;
    const std::vector<SweepColumn> columns = one.columns();
    ASSERT_EQ(cells.size(), columns.size()) << name;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const bool text = columns[i].kind == CellKind::text;
      EXPECT_EQ(std::holds_alternative<std::string>(cells[i]), text) << columns[i].name;
    }
  }
}

TEST(Sweep, ARefusedOrUnsolvedSceneIsARow) {
  const Sweep mixed = sweep({"rod.length=1,-1,\"x\""});
  EXPECT_EQ(mixed.line(mixed.cells(0)).substr(0, 4), "0,1,");
  const std::string bad = mixed.line(mixed.cells(1));
  EXPECT_NE(bad.find("2,"), 0U);
  EXPECT_EQ(bad.substr(0, 12), "1,-1,,,,,,,,") << bad;
  EXPECT_TRUE(has_all(bad, {"rod.length = -1"}));
  const Sweep unsolved(SceneTemplate(sweep_scene, "swept.toml"), Grid({parse_axis("gamma=5")}),
                       SweepModel::energy, {.max_evaluations = 1});
  EXPECT_TRUE(has_all(unsolved.line(unsolved.cells(0)), {"did not converge"}));
}

TEST(Sweep, RefusesAGridOfWhichNoSceneCanBeRead) {
  const std::string message =
      error_of<InputError>([] { (void)sweep({"rod.lenght=lin:1:2:100000"}); });
  EXPECT_TRUE(has_all(message, {"unknown key"}));
  // One good scene of 997 is found.
  EXPECT_EQ(sweep({"rod.length=lin:-995:1:997"}).grid().size(), 997);
}

}  // namespace
}  // namespace dlo::compare
