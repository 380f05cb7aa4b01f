#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "dlo/compare/scene.hpp"
#include "report/report.hpp"

namespace dlo::compare {

/// Names of a plot's axes, by the numbers that View has.
inline constexpr const char* axis_names = "xyz";

/// One shape of a figure.
struct Series {
  std::string id;     ///< in the CSV
  std::string title;  ///< in the key; empty: not there
  std::string style;  ///< gnuplot's
  Eigen::Matrix3Xd points;
  std::vector<double> arc_length;
  std::vector<double> curvature;  ///< empty: none to show; NaN at the ends of polygons
  int view = -1;                  ///< the only one that shows it, which it does not widen; or all
};

/// Which axes a plot has, to the right and up.
struct View {
  int right = 0;
  int up = 1;
};

/// The plane itself if it is a coordinate plane; else two projections that share an axis, the first
/// with gravity upright.
/// @param points  of the rod [m]
[[nodiscard]] std::vector<View> views_of(const Scene& scene, const Eigen::Matrix3Xd& points);

/// Everything that a scene's figures show, what is behind first.
[[nodiscard]] std::vector<Series> series_of(const SceneReport& report,
                                            const std::vector<View>& views);

/// The same as a CSV file.
[[nodiscard]] std::string scene_csv(const std::vector<Series>& all);

}  // namespace dlo::compare
