#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <utility>
#include <vector>

#include "dlo/compare/alignment.hpp"
#include "fit/error_correlation.hpp"
#include "shape/curve.hpp"

namespace dlo::compare {

/// Points that lie in a plane to rounding: their third coordinate was not measured.
[[nodiscard]] bool lies_in_a_plane(const Eigen::Matrix3Xd& points);

/// A measured shape as it lies on a rod.
struct LaidShape {
  std::size_t index = 0;  ///< among the shapes
  const Alignment& alignment;
  const Curve& curve;               ///< of the rod
  bool flat = false;                ///< see lies_in_a_plane
  PoseFreedom pose;                 ///< what was unknown of its frame
  Eigen::Vector3d up;               ///< as in AlignOptions
  Eigen::Index first_of_frame = 0;  ///< column of its frame's first coordinate
};

/// How a fitted number moves the rod's points where the measured ones are [m per its unit], 3 x M,
/// and its column.
using Movement = std::pair<Eigen::Index, Eigen::Matrix3Xd>;

/// Residuals of a shape, points less rod, with the columns of its own frame's coordinates and of
/// the fitted numbers; the others are zero. With given arc lengths a series for each coordinate,
/// else for each of the directions across the rod; none out of the plane of a shape that lies in
/// one.
/// @param columns  of the design, of all shapes' frames and all numbers
[[nodiscard]] std::vector<ResidualSeries> residual_series(const LaidShape& laid,
                                                          const std::vector<Movement>& movements,
                                                          Eigen::Index columns);

}  // namespace dlo::compare
