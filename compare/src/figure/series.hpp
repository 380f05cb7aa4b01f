#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "dlo/compare/deviation.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape.hpp"
#include "dlo/energy_model/equilibrium.hpp"
#include "figure/layout.hpp"

namespace dlo::compare {

/// Names of the axes of a plot, indexed by the numbers in View.
inline constexpr const char* axis_names = "xyz";

/// One shape of a figure.
struct Series {
  std::string id;     ///< name of the curve in the script
  std::string title;  ///< text in the legend; empty: no entry
  CurveStyle look;
  Eigen::Matrix3Xd points;         ///< [m]; a column of NaN interrupts the line
  std::vector<double> arc_length;  ///< of the points [m]; only for a series with curvature
  std::vector<double> curvature;   ///< empty if not shown; NaN where it is not defined
  /// Index of the only view that shows the series, without extending its limits; -1: all views.
  int view = -1;
};

/// Coordinate axes that a plot shows to the right and upwards.
struct View {
  int right = 0;
  int up = 1;
};

/// Shapes and the views in which they are drawn.
struct Drawing {
  std::vector<View> views;
  std::vector<Series> series;  ///< in drawing order, the rearmost first
};

/// Returns the part of a convex outline within a rectangle of a view. It is needed because gnuplot
/// draws no border of an outline that extends beyond the plot.
[[nodiscard]] Series within(Series outline, const View& view, const std::array<double, 2>& low,
                            const std::array<double, 2>& high);

/// Returns the points of all parts in one matrix.
[[nodiscard]] Eigen::Matrix3Xd concatenated(const std::vector<const Eigen::Matrix3Xd*>& parts);

/// Whether points are in the plane that the scene has. A rod may have left it by buckling.
/// @param points  points of the rod [m]
[[nodiscard]] bool stays_in_plane(const Scene& scene, const Eigen::Matrix3Xd& points);

/// Returns one view of the plane that contains the points if it is a coordinate plane. Otherwise it
/// returns two projections with a common axis, the first with the vertical axis that is nearest to
/// gravity (y without gravity).
/// @param points  points of the rod [m]
[[nodiscard]] std::vector<View> views_of(const Scene& scene, const Eigen::Matrix3Xd& points);

/// Returns a rod as a line, with its curvature. If the rod is planar, curvature to the left is
/// positive and curvature to the right negative; otherwise it is the magnitude.
[[nodiscard]] Series rod_series(const Reference& rod, const Scene& scene, const View& view);

/// Returns a polygon with the curvature of its joints, with the sign of rod_series() and NaN at
/// both ends.
[[nodiscard]] Series polygon_series(const Shape& shape, const Scene& scene, const View& view);

/// Returns the straight rod of a scene with a single clamp; std::nullopt for other scenes.
[[nodiscard]] std::optional<Series> straight_rod_series(const Scene& scene);

/// Returns grippers as points, and for each clamp a short line along its direction.
[[nodiscard]] std::vector<Series> gripper_series(const Scene& scene);

/// Function that returns the points of a rod at arc lengths [m], 3 x M.
using RodPoints = std::function<Eigen::Matrix3Xd(const std::vector<double>&)>;

/// Returns the contacts of a rod: points along each contact interval, and single points;
/// std::nullopt if there is none.
/// @param rod  gives its points at arc lengths;  @param length  length of the rod [m]
[[nodiscard]] std::optional<Series> contact_series(
    const std::vector<energy_model::ContactPart>& contacts, const RodPoints& rod, double length);

/// Returns outlines of the obstacles in reach in each view, to be drawn behind everything: the
/// regions that the rod's axis cannot enter.
/// @param rod  points of the shapes that are drawn
[[nodiscard]] std::vector<Series> obstacle_series(const Scene& scene,
                                                  const std::vector<View>& views,
                                                  const Eigen::Matrix3Xd& rod);

/// Returns panels of the shapes in one or two views. Both axes of a panel have the same number of
/// pixels per metre by construction.
[[nodiscard]] std::vector<Panel> shape_panels(const Drawing& drawing);

/// Returns one panel with the shapes in space.
[[nodiscard]] Panel spatial_panel(const Drawing& drawing);

/// Returns a panel of curvature against arc length, for the series that have curvature.
[[nodiscard]] Panel curvature_panel(const std::vector<Series>& all, bool planar);

}  // namespace dlo::compare
