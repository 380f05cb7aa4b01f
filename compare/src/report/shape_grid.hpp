#pragma once

#include <string>
#include <vector>

#include "dlo/compare/comparison.hpp"
#include "dlo/compare/progress.hpp"
#include "dlo/compare/scene.hpp"

namespace dlo::compare {

/// Which shapes a page shows when its sliders are moved: every combination of the lists, with both
/// laws. A rod that one clamp holds, in the plane of gravity.
struct ShapeGridOptions {
  std::vector<double> gammas = {0.2, 1, 3, 10, 30, 100};  ///< w l^3 / (EI), > 0, growing
  std::vector<double> angles_deg = {-60, -30, 0,
                                    30,  60,  80};  ///< of the clamp above the horizontal
  std::vector<int> points = {8, 16, 32};            ///< N, growing
};

/// A force model of the grid: its law with the bookkeeping that goes with it on the page.
struct GridModel {
  BendingLaw law = BendingLaw::paper;            ///< of bending
  Bookkeeping bookkeeping = Bookkeeping::paper;  ///< of the polygon
};

/// Both models at one place of the grid.
struct GridCell {
  std::string failure;   ///< why there are no shapes; empty: there are
  Eigen::Matrix2Xd rod;  ///< the energy model's points over the length [-], at equal arc lengths
  Eigen::Matrix2Xd polygon;      ///< the force model's points over the length [-]
  std::vector<double> s;         ///< arc lengths of these over the length [-]
  std::vector<double> distance;  ///< of these from the rod at equal arc length over the length [-]
  double rms_over_length = 0;    ///< of the deviation at equal arc length [-]
  double max_over_length = 0;    ///< the largest distance of a point [-]
  double max_at = 0;             ///< its arc length over the length [-]
};

/// Shapes for all combinations.
struct ShapeGrid {
  ShapeGridOptions options;       ///< as given
  std::vector<GridModel> models;  ///< law paper, then law hooke
  std::vector<GridCell> cells;    ///< Gamma by Gamma, in it angle by angle, then N, then model

  /// Of the indices in their lists.
  [[nodiscard]] std::size_t index(std::size_t gamma, std::size_t angle, std::size_t points,
                                  std::size_t model) const {
    return ((gamma * options.angles_deg.size() + angle) * options.points.size() + points) *
               models.size() +
           model;
  }
};

/// The scene of a place: the paper's rod, 0.5 m long, with the modulus that gives it this Gamma.
[[nodiscard]] Scene grid_scene(double gamma, double angle_deg, int points, const GridModel& model);

/// Compares both models at every place, on the threads of the arena that it is called in. The force
/// model makes implicit steps, which are few; what they are limited to bounds the time of a cell.
[[nodiscard]] ShapeGrid make_shape_grid(const ShapeGridOptions& options,
                                        const Progress& progress = {});

}  // namespace dlo::compare
