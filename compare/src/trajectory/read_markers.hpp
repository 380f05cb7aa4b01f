#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

namespace dlo::compare {

/// Where one marker on the rod was at one time.
struct MarkerPosition {
  double time = 0;                                     ///< [s]
  double arc_length = 0;                               ///< of the marker [m]
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< [m]
};

/// A recorded motion.
struct MarkerMotion {
  std::string file;                       ///< for messages
  std::vector<MarkerPosition> positions;  ///< by time, then by arc length; one or more
};

/// A recording as CSV: a header with time, s, x, y, z in any order, then a row for each marker that
/// was seen at a time, in s and m; a marker that was not seen has none. Rows may come in any order.
/// @throws InputError naming the file, the line, and what is allowed
[[nodiscard]] MarkerMotion parse_markers(std::string_view text, const std::string& file);

}  // namespace dlo::compare
