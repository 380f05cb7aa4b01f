#pragma once

#include <optional>
#include <string>
#include <vector>

#include "dlo/compare/explanation.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape_check.hpp"
#include "dlo/compare/shape_file.hpp"
#include "dlo/energy_model/energy.hpp"

namespace dlo::compare {

/// A way in which a file may say a right shape wrongly.
struct FileCause {
  std::string words;    ///< a clause; empty if all that is wrong is found in laying the shape
  MeasuredShape shape;  ///< the shape, said rightly
  /// What is left of the frame to find out.
  PoseFreedom pose = PoseFreedom::known;
  int numbers = 0;  ///< that this counts as
  /// Only what the shape has of the rod is held against it.
  bool part = false;
  /// Of several ways to say the same the best is told; empty: there is one.
  std::string same_as = {};
};

/// A unit that a file may be in, other than the one in which it was read.
struct FileUnit {
  std::string words;  ///< a clause: "the file is in mm, not in metres"
  double factor = 1;  ///< of the shape, so that it is in metres
};

/// Returns the units that the shape may be in, other than the one in which it was read.
[[nodiscard]] std::vector<FileUnit> other_units(const MeasuredShape& shape);

/// The shape with its points and arc lengths times a factor.
[[nodiscard]] MeasuredShape scaled(MeasuredShape shape, double factor);
/// The shape in other axes.
[[nodiscard]] MeasuredShape turned(MeasuredShape shape, const Eigen::Matrix3d& axes);

/// Whether the points are clearly shorter than the rod.
[[nodiscard]] bool is_short(double polyline_length, double length);

/// What a shape lacks of the rod at its ends, a clause.
/// @param s  where it lies on the rod [m];  @param points  [m], 3 x M
[[nodiscard]] std::string missing_words(const std::vector<double>& s,
                                        const Eigen::Matrix3Xd& points, double length);

/// Where another origin is, a clause. @param way  from the file's points to the scene's [m]
[[nodiscard]] std::string origin_words(const Eigen::Vector3d& way);

/// All that can be wrong with a file, in a frame that is said to be the scene's; one at a time.
[[nodiscard]] std::vector<FileCause> file_causes(const Scene& scene, const MeasuredShape& shape,
                                                 const ShapeCheck& check);

/// A shape without its points' own noise: of that, neighbours have nothing in common, so little is
/// left of their mean. None of fewer than eight points.
[[nodiscard]] std::optional<Explanation> noise_of_points(const Shape& shape,
                                                         const energy_model::Equilibrium& rod);

}  // namespace dlo::compare
