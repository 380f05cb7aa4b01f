// The shipped map of E*/E, data/effective_modulus.csv.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include "batch/sweep.hpp"
#include "batch/sweep_grid.hpp"
#include "reading/scene_template.hpp"

namespace {

/// The grid of data/effective_modulus.csv, as the README's command has it.
dlo::compare::Sweep shipped_map() {
  std::vector<dlo::compare::Axis> axes;
  for (const char* text :
       {"force_model.bookkeeping=consistent", "force_model.law=paper,hooke",
        "force_model.points=8,16,32,64", "gripper.0.direction=-60 deg,-30 deg,0 deg,30 deg,60 deg",
        "gamma=log:0.03:30:13"}) {
    axes.push_back(dlo::compare::parse_axis(text));
  }
  return {
      dlo::compare::load_scene_template(std::string(DLO_DATA) + "/scenes/spring_steel_175.toml"),
      dlo::compare::Grid(axes), dlo::compare::SweepModel::compare_chain};
}

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> fields(1);
  for (const char c : line) {
    if (c == ',') {
      fields.emplace_back();
    } else {
      fields.back() += c;
    }
  }
  return fields;
}

std::vector<std::string> map_lines() {
  std::ifstream stream(std::string(DLO_DATA) + "/effective_modulus.csv");
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

TEST(EffectiveModulusMap, IsWhatItsCommandWrites) {
  const dlo::compare::Sweep sweep = shipped_map();
  const std::vector<std::string> lines = map_lines();
  ASSERT_EQ(static_cast<std::int64_t>(lines.size()), sweep.grid().size() + 1);
  EXPECT_EQ(lines[0] + "\n", sweep.header());
  const std::vector<std::string> columns = split(lines[0]);
  for (std::int64_t row = 3; row < sweep.grid().size(); row += 47) {
    const std::vector<std::string> shipped = split(lines[static_cast<std::size_t>(row) + 1]);
    const std::vector<std::string> fresh = split(sweep.row(row));
    ASSERT_EQ(fresh.size(), shipped.size());
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const bool result = columns[i].find("_over_length") != std::string::npos ||
                          columns[i] == "effective_modulus_ratio";
      if (i < 6) {
        EXPECT_EQ(fresh[i], shipped[i]);
      }
      // Shapes are minimised to about 1e-10 of the length, the fit to 1e-7 of the modulus.
      if (result) {
        EXPECT_NEAR(std::stod(fresh[i]), std::stod(shipped[i]), 1e-6) << columns[i];
      }
    }
  }
}

TEST(EffectiveModulusMap, HookeIsNearOneAndThePaperLawIsNot) {
  const std::vector<std::string> lines = map_lines();
  const std::vector<std::string> columns = split(lines.at(0));
  const auto column = [&](const std::string& name) {
    return static_cast<std::size_t>(std::find(columns.begin(), columns.end(), name) -
                                    columns.begin());
  };
  int rows = 0;
  int near_one = 0;
  int far_off = 0;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const std::vector<std::string> fields = split(lines[i]);
    ASSERT_EQ(fields.at(column("status")), "ok") << lines[i];
    const double ratio = std::stod(fields.at(column("effective_modulus_ratio")));
    if (fields.at(column("force_model.law")) == "hooke") {
      const double n = std::stod(fields.at(column("force_model.points"))) - 1.5;
      EXPECT_NEAR(ratio, 1, 10 / (n * n)) << lines[i];
    } else {
      // A cubic law is right at one load at most: few rows are near it, and others far off.
      near_one += std::abs(std::log(ratio)) < std::log(1.1) ? 1 : 0;
      far_off += ratio < 0.1 ? 1 : 0;
    }
    ++rows;
  }
  EXPECT_EQ(rows, 520);
  EXPECT_LE(near_one, 5);
  EXPECT_GE(far_off, 50);
}

}  // namespace
