// Tests of the installed map of E*/E, data/effective_modulus.csv.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "base/input_file.hpp"
#include "batch/sweep.hpp"
#include "batch/sweep_grid.hpp"
#include "csv_table.hpp"
#include "reading/scene_template.hpp"

namespace dlo::compare {
namespace {

/// Returns the sweep whose table is data/effective_modulus.csv, as the README's command has it.
Sweep shipped_map() {
  std::vector<Axis> axes;
  for (const char* text :
       {"force_model.bookkeeping=consistent", "force_model.law=paper,hooke",
        "force_model.points=8,16,32,64", "gripper.0.direction=-60 deg,-30 deg,0 deg,30 deg,60 deg",
        "gamma=log:0.03:30:13"}) {
    axes.push_back(parse_axis(text));
  }
  return {load_scene_template(std::string(DLO_DATA) + "/scenes/spring_steel_175.toml"), Grid(axes),
          SweepModel::compare_chain};
}

/// Returns the rows of data/effective_modulus.csv, its header first.
std::vector<test::CsvRow> map_rows() {
  return csv_rows(read_file(DLO_DATA "/effective_modulus.csv"));
}

TEST(EffectiveModulusMap, IsWhatItsCommandWrites) {
  const Sweep sweep = shipped_map();
  const std::vector<test::CsvRow> rows = map_rows();
  ASSERT_EQ(static_cast<std::int64_t>(rows.size()), sweep.grid().size() + 1);
  const test::CsvRow& columns = rows[0];
  EXPECT_EQ(columns, csv_rows(sweep.header()).front());
  for (std::int64_t row = 3; row < sweep.grid().size(); row += 47) {
    const test::CsvRow& shipped = rows[static_cast<std::size_t>(row) + 1];
    const test::CsvRow fresh = csv_rows(sweep.line(sweep.cells(row))).front();
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

}  // namespace
}  // namespace dlo::compare
