#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <span>

#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape.hpp"
#include "dlo/energy_model/problem.hpp"

namespace dlo::compare {

/// A continuous shape, as the energy model gives it.
using Reference = std::function<energy_model::Samples(std::span<const double>)>;

/// Distance of a shape from a reference at equal arc length. A polygon is measured at its points:
/// between them it claims nothing. Integrals over the arc length are trapezoidal.
struct Deviation {
  double rms_m = 0;            ///< sqrt(1/l int |dr|^2 ds)
  double max_m = 0;            ///< largest distance of a point [m]
  double max_at_m = 0;         ///< arc length of the largest
  double tip_m = 0;            ///< at the free end; NaN without one
  double rms_over_length = 0;  ///< RMS as a share of the length [-]
  /// Against the RMS way of the reference from the straight rod; NaN without one.
  double rms_over_movement = 0;
  double angle_rms_rad = 0;        ///< of the segments against the tangent in their middle
  double curvature_rms_per_m = 0;  ///< of turning angle over segment length against the curvature
};

/// @param straight  the undeformed rod at the shape's arc lengths [m], 3 x M, if there is one
/// @param tip       index of the free end, 0 or M-1, if there is one
[[nodiscard]] Deviation deviation(const Shape& shape, const Reference& reference,
                                  const std::optional<Eigen::Matrix3Xd>& straight,
                                  std::optional<Eigen::Index> tip);

/// sqrt(1/l int |difference|^2 ds) by the trapezoidal rule [m].
/// @param difference  at the arc lengths, 3 x M
[[nodiscard]] double rms(const std::vector<double>& arc_length, const Eigen::Matrix3Xd& difference);

/// RMS distance of a shape from a reference at its own arc lengths [m].
[[nodiscard]] double distance(const Shape& shape, const Reference& reference);

/// The straight rod of a scene with a single clamp, at arc lengths s [m], 3 x M. Several grips, or
/// a pin, leave no straight shape to start from: nothing.
[[nodiscard]] std::optional<Eigen::Matrix3Xd> straight_rod(const Scene& scene,
                                                           const std::vector<double>& s);

/// Deviation of any shape of a scene, with what the scene says about ends and straight rods.
[[nodiscard]] Deviation shape_deviation(const Scene& scene, const Shape& shape,
                                        const Reference& reference);

}  // namespace dlo::compare
