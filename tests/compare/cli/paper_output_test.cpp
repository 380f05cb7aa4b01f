// Tests of the output of `dlo paper`, from reports that take no time to compute.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <sstream>
#include <string>

#include "dlo/compare/comparison.hpp"
#include "dlo/compare/scene_file.hpp"
#include "series/study_output.hpp"

namespace dlo::cli {
namespace {

using compare::PaperReport;
using testing::HasSubstr;

/// "section,scene,item,quantity" of a CSV output, and the value.
std::map<std::string, double> csv_values(const std::string& csv) {
  std::map<std::string, double> values;
  std::istringstream lines(csv);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t comma = line.rfind(',');
    if (line.substr(comma + 1) == "value") continue;
    EXPECT_TRUE(values.emplace(line.substr(0, comma), std::stod(line.substr(comma + 1))).second)
        << "twice: " << line;
  }
  return values;
}

/// Returns a report with both weights of one rod, as if it was sampled twice before it came to
/// rest.
PaperReport hand_made_report() {
  const compare::Scene scene = compare::parse_scene(
      "name = \"made\"\n[rod]\nlength = \"50 cm\"\ndiameter = \"2 mm\"\n"
      "material = \"spring_steel\"\n[[gripper]]\nat = 0\nposition = [0, 0, 0]\n"
      "direction = \"-175 deg\"\n[force_model]\npoints = 6\nlaw = \"hooke\"\n",
      "made.toml");
  PaperReport report;
  report.c_c = 659.734;
  report.c_F = 0.25;
  report.steps_per_second = 4000;
  report.tables = {{"1", "c_b", "N", "3776.21457", 3776.2145712, "of F", true},
                   {"5", "F_g", "N", "0.00892", 0.00761, "rho A g l / 16", false}};
  report.assumptions = {"c_F is in centimetres"};
  const compare::Comparison rest = compare::compare(scene);
  for (const auto weight : {compare::PaperWeight::of_the_rod, compare::PaperWeight::printed}) {
    compare::PaperCase entry;
    entry.rest = rest;
    entry.weight = weight;
    // E*/E ~ t^-1 passes 1/3 at 30 s, at a third of the way in log t.
    for (const double time : {10.0, 270.0}) {
      compare::ModulusAtTime at;
      at.time_s = time;
      at.steps = std::lround(time * report.steps_per_second);
      at.modulus = rest.effective_modulus;
      at.modulus.ratio = 10 / time;
      at.rms_over_length = 0.02;
      at.rest_distance_over_length = 0.01 / time;
      entry.creep.push_back(at);
    }
    report.cases.push_back(std::move(entry));
  }
  compare::ModulusVariant variant;
  variant.what = "load, 10 times";
  variant.settings.points = 6;
  variant.load_factor = 10;
  variant.gamma = 1.8452;
  variant.modulus = rest.effective_modulus;
  variant.modulus.ratio = 0.0625;
  variant.modulus.optimum = compare::Optimum::flat;
  report.variants = {variant};
  return report;
}

TEST(PaperOutput, TextJsonAndCsvTellTheSameNumbers) {
  const PaperReport report = hand_made_report();
  const std::string text = paper_text(report);
  for (const char* expected :
       {"3776.21457", "0.00892", "differs  rho A g l / 16", "c_c = 659.734 N", "passes 1/3 at",
        "30.0 s", "\n       10     40000", "\n      270   1080000", "load, 10 times", "0.0625",
        "(flat)", "  - c_F is in centimetres\n"}) {
    EXPECT_THAT(text, HasSubstr(expected));
  }
  const Json document = paper_json(report);
  EXPECT_EQ(document.at("schema"), "dlo/paper/1");
  EXPECT_EQ(document.at("tables").size(), 2U);
  ASSERT_EQ(document.at("cases").size(), 2U);
  EXPECT_EQ(document.at("cases")[1].at("point_weight"), "printed");
  EXPECT_NEAR(document.at("cases")[0].at("time_at_one_third_s"), 30, 1e-9);
  EXPECT_EQ(document.at("variants")[0].at("load_factor"), 10);
  const std::map<std::string, double> csv = csv_values(paper_csv(report));
  EXPECT_EQ(csv.at("table,,table 1 c_b,printed"), 3776.21457);
  EXPECT_EQ(csv.at("table,,table 1 c_b,computed"),
            document.at("tables")[0].at("computed").get<double>());
  for (const std::string weight : {"", " printed weight"}) {
    EXPECT_NEAR(csv.at("rest" + weight + ",made,,effective_modulus_ratio"),
                document.at("cases")[0].at("effective_modulus_ratio"), 1e-11);
    for (std::size_t i = 0; i < 2; ++i) {
      const Json& at = document.at("cases")[0].at("modulus_against_time")[i];
      const std::string item =
          "creep" + weight + ",made,t=" + std::to_string(at.at("time_s").get<int>());
      EXPECT_NEAR(csv.at(item + ",effective_modulus_ratio"), at.at("effective_modulus_ratio"),
                  1e-12);
      EXPECT_NEAR(csv.at(item + ",distance_to_rest_over_length"),
                  at.at("distance_to_rest_over_length"), 1e-12);
    }
    // x and y of both models' points.
    EXPECT_EQ(std::count_if(csv.begin(), csv.end(),
                            [&](const auto& entry) {
                              return entry.first.starts_with("shape" + weight + ",made,s=");
                            }),
              4 * report.cases[0].rest.force.shape.points.cols());
  }
}

/// Returns every row of Tables 2 to 4 as printed, except for one that is stopped, one without its
/// force and one that diverges.
compare::MovingReport hand_made_moving_report() {
  compare::MovingReport report;
  report.rows = compare::moving_rows();
  const auto as_printed = [](compare::MovingRow& row) {
    row.run.status = compare::MovingStatus::finished;
    row.run.c_F = 4.13e-5;
    row.run.c_h = 0.95;
    if (!row.printed) return;
    row.run.steps = row.printed->steps;
    row.run.damped_steps = row.printed->damped_steps;
    row.run.limited_steps = row.printed->limited_steps;
    row.run.average_force = row.printed->average_force;
  };
  for (compare::MovingRow& row : report.rows) {
    as_printed(row);
    row.error = compare::MovingError{0.0125, 0.05, 0.03125, 0.5};
  }
  report.rows.front().run.status = compare::MovingStatus::too_many_steps;
  report.rows.back().error.reset();
  report.distance = compare::moving_distance(report.rows);
  report.reference_energy_error = 1e-7;
  compare::MovingScanEntry in_metres{"unit of c_F: 1 m", report.choices, {}, {}};
  in_metres.choices.length_unit = 1;
  std::copy_if(report.rows.begin(), report.rows.end(), std::back_inserter(in_metres.rows),
               [](const compare::MovingRow& row) { return row.printed.has_value(); });
  for (compare::MovingRow& row : in_metres.rows) row.run.status = compare::MovingStatus::diverged;
  in_metres.distance = compare::moving_distance(in_metres.rows);
  report.scan = {{"none", report.choices, in_metres.rows, report.distance}, in_metres};
  for (compare::MovingRow& row : report.scan[0].rows) as_printed(row);
  report.table_3_scan = {report.scan[0]};
  report.findings = {"m* is 1.5 g"};
  return report;
}

TEST(MovingOutput, TextJsonAndCsvTellTheSameNumbers) {
  const compare::MovingReport report = hand_made_moving_report();
  // An experiment that was stopped has no factor.
  EXPECT_TRUE(std::isinf(report.distance.force_factor));
  const std::string text = moving_text(report);
  for (const char* expected : {"(given up)", "diverged", "no end", "1.25 %", "5.00 %", "0.0312 N",
                               "1.513 g", "  - m* is 1.5 g\n"}) {
    EXPECT_THAT(text, HasSubstr(expected));
  }
  const Json document = moving_json(report);
  ASSERT_EQ(document.at("rows").size(), report.rows.size());
  EXPECT_EQ(document.at("rows")[0].at("status"), "given up");
  EXPECT_FALSE(document.at("rows").back().contains("error"));
  EXPECT_TRUE(std::isinf(document.at("distance").at("force_factor").get<double>()));
  const std::map<std::string, double> csv = csv_values(moving_csv(report));
  for (std::size_t i = 0; i < report.rows.size(); ++i) {
    const Json& row = document.at("rows")[i];
    const std::string name = row.at("movement").get<std::string>() + ", " +
                             row.at("rod").get<std::string>() + " rod, " +
                             row.at("variant").get<std::string>();
    for (const std::string varied : {"none", "unit of c_F: 1 m"}) {
      if (varied != "none" && !report.rows[i].printed) continue;
      const std::string item =
          std::string("moving,,\"").append(name).append("; varied: ").append(varied).append("\",");
      ASSERT_TRUE(csv.contains(item + "steps")) << item;
      EXPECT_EQ(csv.at(item + "steps"), row.at("steps").get<double>());
      EXPECT_EQ(csv.at(item + "average_force_N"), row.at("average_force_N").get<double>());
      if (!report.rows[i].error) continue;
      EXPECT_EQ(csv.at(item + "shape_rms_over_length"), 0.0125);
      EXPECT_NEAR(csv.at(item + "point_mass_kg"), row.at("reading").at("point_mass_kg"), 1e-14);
    }
  }
}

}  // namespace
}  // namespace dlo::cli
