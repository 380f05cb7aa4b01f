#include "report/page_data.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "scenes.hpp"

namespace dlo::compare {
namespace {

using nlohmann::json;

/// Of one scene, nothing besides.
Report report_on(const Scene& scene) {
  ReportOptions options;
  options.history = false;
  options.benchmark.reset();
  options.map.reset();
  options.hard_cases.reset();
  options.grid = ShapeGridOptions{.gammas = {1, 100}, .angles_deg = {60}, .points = {8}};
  return make_report({{.name = "scene.toml", .text = "", .scene = scene}}, options);
}

TEST(PageData, HasNothingThatEndsItsElement) {
  Scene scene = test::heavy_scene(2, -30);
  scene.name = "</script><b>\xff \"quoted\" & 'so'";
  const std::string text = page_data(report_on(scene));
  EXPECT_THAT(text, testing::Not(testing::HasSubstr("<")));
  EXPECT_EQ(json::parse(text)["scenes"][0]["name"], "</script><b>\ufffd \"quoted\" & 'so'");
}

TEST(PageData, ShapesAreTheComparisons) {
  const Report report = report_on(test::heavy_scene(2, -30));
  const json scene = json::parse(page_data(report))["scenes"][0];
  const std::vector<Comparison>& comparisons = report.scenes.front().comparisons;
  ASSERT_EQ(scene["curves"].size(), comparisons.size() + 1);
  EXPECT_FALSE(scene["spatial"]);
  EXPECT_EQ(scene["curves"][0]["kind"], "rod");
  for (std::size_t i = 0; i < comparisons.size(); ++i) {
    const json& curve = scene["curves"][i + 1];
    const Shape& shape = comparisons[i].force.shape;
    ASSERT_EQ(curve["s"].size(), shape.arc_length.size());
    EXPECT_TRUE(curve["curvature"].front().is_null()) << "an end has no joint";
    double largest = 0;
    for (std::size_t k = 0; k < shape.arc_length.size(); ++k) {
      const auto column = static_cast<Eigen::Index>(k);
      EXPECT_NEAR(curve["y"][k], shape.points(1, column), 1e-4);
      largest = std::max(largest, curve["distance"][k].get<double>());
    }
    EXPECT_NEAR(largest, comparisons[i].deviation.max_m, 1e-4 * largest);
  }
}

// A rod that hangs straight down carries the weight below: a straight line from all of it to none.
TEST(PageData, TensionIsTheWeightBelow) {
  const Scene scene = test::heavy_scene(2, -90);
  const json rod = json::parse(page_data(report_on(scene)))["scenes"][0]["curves"][0];
  const double weight = scene.weight_per_length().norm() * scene.length;
  ASSERT_EQ(rod["tension"].size(), rod["s"].size());
  for (std::size_t i = 0; i < rod["s"].size(); ++i) {
    const double below = 1 - rod["s"][i].get<double>() / scene.length;
    EXPECT_NEAR(rod["tension"][i], weight * below, 1e-4 * weight);
    EXPECT_EQ(rod["curvature"][i], 0) << "rounding is no curvature";
  }
}

TEST(PageData, GridSaysWhatIsMissing) {
  const Report report = report_on(test::heavy_scene(2, -30));
  const json grid = json::parse(page_data(report))["grid"];
  ASSERT_TRUE(report.grid);
  ASSERT_EQ(grid["cells"].size(), 4U);
  EXPECT_THAT(grid["cells"][2]["failure"].get<std::string>(),
              testing::HasSubstr("would rotate by"));
  const GridCell& cell = report.grid->cells[1];
  EXPECT_EQ(grid["models"][1]["law"], "hooke");
  EXPECT_NEAR(grid["cells"][1]["rms"], cell.rms_over_length, 1e-4 * cell.rms_over_length);
  EXPECT_EQ(grid["cells"][1]["rod"]["x"].back(),
            std::lround(1e4 * cell.rod(0, cell.rod.cols() - 1)));
  Report without = report;
  without.grid.reset();
  EXPECT_TRUE(json::parse(page_data(without))["grid"].is_null());
}

}  // namespace
}  // namespace dlo::compare
