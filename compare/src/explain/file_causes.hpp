#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "dlo/compare/explanation.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape_check.hpp"
#include "dlo/compare/shape_file.hpp"
#include "dlo/energy_model/energy.hpp"

namespace dlo::compare {

/// A possible error of a file that contains a correct shape.
struct FileCause {
  std::string words;    ///< a clause; empty if alignment of the shape determines the whole error
  MeasuredShape shape;  ///< the shape with the error corrected
  /// Unknown coordinates of the frame that alignment must find.
  PoseFreedom pose = PoseFreedom::known;
  int numbers = 0;  ///< number of fitted numbers as which this counts
  /// Whether the shape is compared only with the part of the rod that it covers.
  bool part = false;
  /// Name of a group of causes of which only the best is reported; empty: reported by itself.
  std::string cause_group = {};
};

/// Receives a possible error of a file.
using TakeFileCause = std::function<void(const FileCause&)>;

/// Returns a clause that states which ends of the rod a shape lacks.
/// @param s  arc lengths of the points on the rod [m];  @param points  [m], 3 x M
[[nodiscard]] std::string missing_ends_clause(const std::vector<double>& s,
                                              const Eigen::Matrix3Xd& points, double length);

/// Returns a clause that states the origin of the file.
/// @param translation  displacement from the file's points to the scene's [m]
[[nodiscard]] std::string origin_clause(const Eigen::Vector3d& translation);

/// Calls `take` for each single error of a file whose frame is stated to be the scene's: its unit,
/// axes, origin, direction of arc lengths, pixels, order of points, extent, scale and rotation.
void try_single_errors(const Scene& scene, const MeasuredShape& shape, const ShapeCheck& check,
                       const TakeFileCause& take);

/// Returns the explanation that the points are noisy, with the deviation that remains without the
/// noise. The noise of neighbours is independent, so little of it is left in their mean. Returns
/// std::nullopt for fewer than eight points.
[[nodiscard]] std::optional<Explanation> noise_of_points(const Shape& shape,
                                                         const energy_model::Equilibrium& rod);

/// Group name (FileCause::cause_group) of combinations of several errors.
inline constexpr const char* joint_cause = "several";

/// Calls `take` for all combinations of several errors of a file: its unit, axes, origin and, if
/// the polyline is shorter than 99 % of the rod, missing ends. Only units are considered in which
/// the polyline is 0.5 to 1.25 times as long as the rod. Each error after the first counts as one
/// number, and another origin as one more.
/// @param length  length of the rod's axis, with stretch [m]
void try_joint_errors(const Scene& scene, const MeasuredShape& shape, double length,
                      const TakeFileCause& take);

}  // namespace dlo::compare
