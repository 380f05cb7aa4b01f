#include "report/shape_grid.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "dlo/compare/comparison.hpp"

namespace dlo::compare {
namespace {

constexpr GridModel hooke = {BendingLaw::hooke, Bookkeeping::consistent};

TEST(ShapeGrid, ScenesHaveTheirGammaAndAngle) {
  for (const double gamma : {0.2, 100.0}) {
    const Scene scene = grid_scene(gamma, 60, 8, hooke);
    EXPECT_NEAR(scene.gamma(), gamma, 1e-12 * gamma);
    EXPECT_NEAR(scene.grippers.front().direction->y(), std::sqrt(3) / 2, 1e-15);
    EXPECT_EQ(scene.force_model.points, 8);
  }
}

// A rod that hardly bends sinks by w l^4 / (8 EI) at its end, to the third order in Gamma.
TEST(ShapeGrid, StiffRodsSinkAsBeamsDo) {
  const ShapeGrid grid = make_shape_grid({.gammas = {0.01}, .angles_deg = {0}, .points = {16}});
  const GridCell& cell = grid.cells.at(grid.index(0, 0, 0, 1));
  ASSERT_EQ(cell.failure, "");
  EXPECT_NEAR(cell.rod(1, cell.rod.cols() - 1), -0.01 / 8, 1e-8);
  EXPECT_LT(cell.rms_over_length, 1e-5);
}

TEST(ShapeGrid, CellsAreTheComparisonsOfTheirPlaces) {
  const ShapeGrid grid =
      make_shape_grid({.gammas = {1, 10}, .angles_deg = {-30, 60}, .points = {8, 16}});
  ASSERT_EQ(grid.cells.size(), 16U);
  const GridCell& cell = grid.cells[grid.index(1, 0, 1, 0)];
  const Comparison c =
      compare(grid_scene(10, -30, 16, grid.models[0]), {}, std::nullopt, ModulusSearch::no);
  const double l = c.length;
  ASSERT_EQ(cell.failure, "");
  EXPECT_NEAR(cell.rms_over_length, c.deviation.rms_over_length, 1e-6);
  EXPECT_NEAR(cell.max_over_length, c.deviation.max_m / l, 1e-6);
  EXPECT_LT((cell.polygon - c.force.shape.points.topRows<2>() / l).cwiseAbs().maxCoeff(), 1e-6);
  ASSERT_EQ(cell.distance.size(), 16U);
  EXPECT_NEAR(cell.distance.back(), c.deviation.tip_m / l, 1e-6);
  EXPECT_NEAR(cell.s.back(), 1, 1e-12);
}

// With eight points a joint of the paper's law would have to turn by more than half a turn.
TEST(ShapeGrid, CellsWithoutShapesSaySo) {
  const ShapeGrid grid = make_shape_grid({.gammas = {100}, .angles_deg = {60}, .points = {8, 32}});
  EXPECT_THAT(grid.cells.at(grid.index(0, 0, 0, 0)).failure, testing::HasSubstr("would rotate by"));
  EXPECT_EQ(grid.cells.at(grid.index(0, 0, 1, 1)).failure, "");
}

TEST(ShapeGrid, CountsItsCells) {
  std::int64_t last = 0;
  (void)make_shape_grid({.gammas = {1}, .angles_deg = {0, 30}, .points = {8}},
                        [&](std::int64_t done, std::int64_t total) {
                          EXPECT_EQ(total, 4);
                          EXPECT_EQ(done, ++last);
                        });
  EXPECT_EQ(last, 4);
  EXPECT_THROW((void)make_shape_grid({.gammas = {}}), std::invalid_argument);
}

}  // namespace
}  // namespace dlo::compare
