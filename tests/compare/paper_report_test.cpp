#include "dlo/compare/paper_report.hpp"

#include <gtest/gtest.h>

namespace dlo::compare {
namespace {

const TableRow& row(const std::vector<TableRow>& rows, const std::string& table,
                    const std::string& quantity) {
  for (const TableRow& r : rows) {
    if (r.table == table && r.quantity == quantity) return r;
  }
  throw std::runtime_error("no row " + quantity);
}

TEST(PaperTables, ComeOutToAllPrintedDigits) {
  const std::vector<TableRow> rows = recompute_tables();
  EXPECT_EQ(row(rows, "1", "c_c").printed, "1.56960");
  EXPECT_TRUE(row(rows, "1", "c_c").agrees);
  EXPECT_EQ(row(rows, "1", "c_b").printed, "3776.21457");
  EXPECT_TRUE(row(rows, "1", "c_b").agrees);
  EXPECT_TRUE(row(rows, "1", "c_e (grav)").agrees);
  EXPECT_EQ(row(rows, "5", "c_b").printed, "3574.96");
  EXPECT_TRUE(row(rows, "5", "c_b").agrees);
  EXPECT_EQ(row(rows, "5", "c_c").printed, "659734");
  EXPECT_TRUE(row(rows, "5", "c_c").agrees);
  EXPECT_FALSE(row(rows, "5", "c_e (grav)").agrees);  // it is Table 1's
}

TEST(PaperReport, MeasuresTheEffectiveModulusAtRestAndOnTheWay) {
  const PaperReport report = paper_report();
  ASSERT_EQ(report.cases.size(), 6U);
  for (const PaperCase& entry : report.cases) {
    // The prototype's window for all orientations; a cubic law leaves a residual.
    EXPECT_GT(entry.rest.effective_modulus.ratio, 0.02) << entry.rest.scene;
    EXPECT_LT(entry.rest.effective_modulus.ratio, 0.05) << entry.rest.scene;
    EXPECT_GT(entry.rest.effective_modulus.rms_m, 0.01 * 0.5) << entry.rest.scene;
    EXPECT_GT(entry.time_at_one_third(), 25);
    EXPECT_LT(entry.time_at_one_third(), 40);
    double previous = 1e9;
    for (const ModulusAtTime& at : entry.creep) {
      EXPECT_LT(at.modulus.ratio, previous) << "it only ever softens";
      EXPECT_GT(at.modulus.ratio, entry.rest.effective_modulus.ratio);
      EXPECT_EQ(at.steps, static_cast<long>(at.time_s * report.steps_per_second));
      previous = at.modulus.ratio;
    }
    // Far from rest the joints fall freely: E*/E goes like 1/t.
    EXPECT_NEAR(entry.creep[1].modulus.ratio * 2 / entry.creep[0].modulus.ratio, 1, 0.05);
  }
  EXPECT_FALSE(report.variants.empty());
  EXPECT_FALSE(report.assumptions.empty());
}

}  // namespace
}  // namespace dlo::compare
