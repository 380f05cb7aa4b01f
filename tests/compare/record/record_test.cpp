// Tests of records: each field of a result is described once, and appears wherever the record
// requires it.

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "command_fixture.hpp"
#include "dlo/compare/scene_file.hpp"
#include "record/csv_table.hpp"
#include "record/field.hpp"
#include "record/solution_fields.hpp"
#include "scenes.hpp"

namespace dlo::compare {
namespace {

class Record : public Command {
 protected:
  /// Returns the file of a scene that twists its rod; moving_wire() adds a clamp motion from a
  /// file.
  static std::string wire() { return shipped_scene("twisted_wire"); }
  std::string moving_wire() {
    std::ofstream(path("move.csv")) << "time,x,y,z\n0,0.42,0,0\n0.2,0.40,0.01,0\n";
    std::string text = read(wire());
    const std::string still = "position = [\"42 cm\", 0, 0]\n";
    text.erase(text.find(still), still.size());
    return scene(text + "trajectory = \"move.csv\"\n");
  }
};

TEST_F(Record, ANumberOfAShapeStandsInEachCommandsOutput) {
  const std::string moving = moving_wire();
  const std::string text = output_of(words({"solve", wire()}));
  const Json solved = Json::parse(output_of(words({"solve", wire(), "--format json"})));
  const std::string swept = output_of(words({"sweep", wire(), "--vary gamma=1"}));
  const std::string track = words({"track", moving, "--no-force --frame-rate 10"});
  const std::string tracked = output_of(track + "--format csv");
  const Json frame = Json::parse(output_of(track + "--format json")).at("frames").at(0);
  int places = 0;
  for (const Field<SolvedShape>& number : shape_numbers()) {
    const double value = solved.at(number.key()).get<double>();
    EXPECT_TRUE(std::isfinite(value)) << number.key();
    EXPECT_NEAR(frame.at(number.key()), value, 1e-6) << number.key();
    EXPECT_NEAR(std::stod(first_row_value(tracked, number.key())), value, 1e-6) << number.key();
    EXPECT_TRUE(std::isfinite(std::stod(first_row_value(swept, number.key())))) << number.key();
    ++places;
  }
  EXPECT_GE(places, 3);
  // The clamps prescribe half a turn, part of which becomes writhe.
  EXPECT_NEAR(solved.at("link_turns"), 0.5, 1e-3);
  EXPECT_NEAR(solved.at("twist_turns").get<double>() + solved.at("writhe_turns").get<double>(), 0.5,
              1e-3);
  EXPECT_TRUE(has_all(text, {"\nlink turns ", "\nturns\n  from [m]"}));
}

TEST_F(Record, AShapeWithoutFramesHasNoTurns) {
  const std::string rod = std::string(DLO_DATA) + "/scenes/spring_steel_175.toml";
  EXPECT_TRUE(has_none(output_of(words({"solve", rod, "--format json"})), {"turns"}));
  EXPECT_EQ(output_of(words({"sweep", rod, "--vary gamma=1"})).substr(0, 66),
            "row,gamma,tip_x_m,tip_y_m,tip_z_m,energy_J,evaluations,terms,statu");
}

TEST_F(Record, TurnsOfAPartThatAreUndeterminedHaveNoSum) {
  Solution solution;
  solution.twists.resize(2);
  solution.linking = {{.end = 1, .twist = 0.5}};
  for (const Field<SolvedShape>& field : shape_numbers()) {
    EXPECT_TRUE(std::isnan(value_of(field, {Scene(), solution}).get<double>())) << field.name;
  }
}

/// Field of the mean tension, which no other output contains.
const Field<SolvedShape> mean_tension[] = {
    {"mean_tension", "N", "Mean of the tension along the rod", [](const SolvedShape& shape) {
       double sum = 0;
       for (const double tension : shape.solution.tension) sum += tension;
       return sum / static_cast<double>(shape.solution.tension.size());
     }}};

TEST_F(Record, OneDescriptionMakesRowKeyAndColumn) {
  const Scene scene = heavy_scene(1, 0);
  Solution solution;
  solution.tension = {1, 2.5};
  const SolvedShape shape{scene, solution};
  const std::span<const Field<SolvedShape>> fields = mean_tension;
  Json document = {{"schema", "test"}};
  add_json(document, fields, shape, scene);
  EXPECT_EQ(document.dump(), R"({"schema":"test","mean_tension_N":1.75})");
  EXPECT_EQ(Document{document}.text(), "mean tension  1.75 N\n");
  EXPECT_EQ(fields[0].key(), "mean_tension_N");
  EXPECT_EQ(csv_value(value_of(fields[0], shape)), "1.75");
  EXPECT_EQ(fields[0].name, "mean_tension");
  EXPECT_EQ(fields[0].python_words(), "Mean of the tension along the rod [N].");
  solution.tension.clear();
  EXPECT_EQ(csv_value(value_of(fields[0], shape)), "");
}

TEST(Document, TextIsALineForEachValueAndATableForEachList) {
  const Json json = {
      {"schema", "test"},
      {"model", "energy"},
      {"reached", true},
      {"rms_over_length", 0.012345678},
      {"drag_N_s_per_m2", 0.25},
      {"curvature_per_m", 2.0},
      {"steps_per_second", 30000.0},
      {"l_s", 0.5},
      {"force_N", {1e-30, 0.0, -2.5}},
      {"unknown_m", NAN},
      {"none", nullptr},
      {"notes", {"a\nb", "c"}},
      {"energy_J", {{"bending", 1.0}, {"load", 0.0}}},
      {"points_m", {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}},
      {"events", {{{"time_s", 0.5}, {"kind", "snap"}}, {{"time_s", 12.0}, {"at", {{"rms_m", 3}}}}}},
      {"cases", {{{"scene", "x"}, {"seconds", 3}, {"inner", {{{"a", 1}}}}}}}};
  const Document document{.json = json,
                          .columns = {{"cases", "case=#,seconds"}, {"cases/#/inner", "a"}},
                          .large = {.force = 1},
                          .table = "cases"};
  EXPECT_EQ(document.text(),
            "model             energy\n"
            "reached           yes\n"
            "rms               1.235 % of l\n"
            "drag              0.25 N s/m^2\n"
            "curvature         2 1/m\n"
            "steps per second  30000\n"
            "l_s               0.5\n"
            "force             [0, 0, -2.5] N\n"
            "notes             a?b\n"
            "                  c\n"
            "energy\n"
            "  bending  1 J\n"
            "  load     0 J\n"
            "\nevents\n"
            "  time [s]  kind  at rms [m]\n"
            "       0.5  snap           -\n"
            "        12  -              3\n"
            "\ncases\n"
            "  case  seconds\n"
            "     1        3\n"
            "\ncases 1, x: inner\n"
            "  a\n"
            "  1\n");
  EXPECT_EQ(document.csv(), "case,seconds\n1,3\n");
}

}  // namespace
}  // namespace dlo::compare
