#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <span>

#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape.hpp"
#include "dlo/energy_model/problem.hpp"

namespace dlo::compare {

/// A continuous shape: returns samples at arc lengths, as the energy model does.
using Reference = std::function<energy_model::Samples(std::span<const double>)>;

/// Distance of a shape from a reference at equal arc length. A polygon is compared at its points
/// only, since its edges are not meant to approximate the rod. Integrals over the arc length use
/// the trapezoidal rule. l is the arc length from the first point to the last.
struct Deviation {
  double rms_m = 0;            ///< sqrt(1/l int |dr|^2 ds)
  double max_m = 0;            ///< largest distance of a point [m]
  double max_at_m = 0;         ///< arc length of the point with the largest distance [m]
  double tip_m = 0;            ///< distance at the free end [m]; NaN without one
  double rms_over_length = 0;  ///< RMS distance divided by l [-]
  /// RMS distance divided by the RMS displacement of the reference from the straight rod [-]; NaN
  /// without a straight rod or such a displacement.
  double rms_over_movement = 0;
  double angle_rms_rad = 0;  ///< RMS angle between each segment and the tangent at its middle
  /// RMS difference between the shape's curvature vector at its inner points (rotation angle of the
  /// tangent per segment length) and the reference's.
  double curvature_rms_per_m = 0;
};

/// Computes the deviation of a shape from a reference.
/// @param straight  the undeformed rod at the shape's arc lengths [m], 3 x M, if there is one
/// @param tip       index of the free end, 0 or M-1, if there is one
[[nodiscard]] Deviation deviation(const Shape& shape, const Reference& reference,
                                  const std::optional<Eigen::Matrix3Xd>& straight,
                                  std::optional<Eigen::Index> tip);

/// Returns sqrt(1/l int |difference|^2 ds) by the trapezoidal rule [m].
/// @param difference  at the arc lengths, 3 x M
/// @throws std::invalid_argument unless there are two or more points, one per arc length
[[nodiscard]] double rms(const std::vector<double>& arc_length, const Eigen::Matrix3Xd& difference);

/// Returns the RMS distance of a shape from a reference at the shape's arc lengths [m].
[[nodiscard]] double distance(const Shape& shape, const Reference& reference);

/// Returns the straight rod of a scene with a single clamp, at arc lengths s [m], 3 x M. Empty if
/// there are several grips, or a pin, which define no straight shape.
[[nodiscard]] std::optional<Eigen::Matrix3Xd> straight_rod(const Scene& scene,
                                                           const std::vector<double>& s);

/// Returns the RMS distance of a shape from straight_rod() [m]; NaN if there is no straight rod.
[[nodiscard]] double distance_from_straight(const Scene& scene, const Shape& shape);

/// Computes the deviation of a scene's shape; free end and straight rod follow from the scene.
[[nodiscard]] Deviation shape_deviation(const Scene& scene, const Shape& shape,
                                        const Reference& reference);

}  // namespace dlo::compare
