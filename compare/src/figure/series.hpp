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

/// Names of a plot's axes, by the numbers that View has.
inline constexpr const char* axis_names = "xyz";

/// One shape of a figure.
struct Series {
  std::string id;     ///< its name in the script
  std::string title;  ///< in the key; empty: not there
  Look look;
  Eigen::Matrix3Xd points;  ///< [m]; a column of NaN: a line ends before it, the next begins after
  std::vector<double> arc_length;
  std::vector<double> curvature;  ///< empty: none to show; NaN at the ends of polygons
  int view = -1;                  ///< the only one that shows it, which it does not widen; or all
};

/// Which axes a plot has, to the right and up.
struct View {
  int right = 0;
  int up = 1;
};

/// Shapes, and from where they are seen.
struct Drawing {
  std::vector<View> views;
  std::vector<Series> series;  ///< those behind first
};

/// The part of a convex outline that is in a rectangle of a view: of one that goes on past a plot,
/// gnuplot draws no border.
[[nodiscard]] Series within(Series outline, const View& view, const std::array<double, 2>& low,
                            const std::array<double, 2>& high);

/// The points of all of them.
[[nodiscard]] Eigen::Matrix3Xd side_by_side(const std::vector<const Eigen::Matrix3Xd*>& parts);

/// Whether points lie in a plane that the scene has: rods leave it where they buckle out of it.
/// @param points  of the rod [m]
[[nodiscard]] bool stays_in_plane(const Scene& scene, const Eigen::Matrix3Xd& points);

/// The plane that the points stay in if it is a coordinate plane; else two projections that share
/// an axis, the first with gravity upright.
/// @param points  of the rod [m]
[[nodiscard]] std::vector<View> views_of(const Scene& scene, const Eigen::Matrix3Xd& points);

/// A rod as a line, with its curvature; where it stays in a plane that turns to the left is
/// positive.
[[nodiscard]] Series rod_series(const Reference& rod, const Scene& scene, const View& view);

/// A polygon, with the curvature of its joints.
[[nodiscard]] Series polygon_series(const Shape& shape, const Scene& scene, const View& view);

/// The straight rod of a scene with a single clamp; of another nothing.
[[nodiscard]] std::optional<Series> unbent_series(const Scene& scene);

/// Grippers as points, and of each clamp a stub along its direction.
[[nodiscard]] std::vector<Series> gripper_series(const Scene& scene);

/// Points of a rod at arc lengths [m], 3 x M.
using RodPoints = std::function<Eigen::Matrix3Xd(const std::vector<double>&)>;

/// What touches a rod: points of what lies, and single ones; nothing if nothing does.
/// @param rod  its points at arc lengths;  @param length  of the rod [m]
[[nodiscard]] std::optional<Series> contact_series(
    const std::vector<energy_model::ContactPart>& contacts, const RodPoints& rod, double length);

/// Outlines of the obstacles in reach in each view, to be drawn behind everything: what the rod's
/// axis stays out of.
/// @param rod  points of what else is drawn
[[nodiscard]] std::vector<Series> obstacle_series(const Scene& scene,
                                                  const std::vector<View>& views,
                                                  const Eigen::Matrix3Xd& rod);

/// Shapes in one or two views at equal aspect, by construction: both axes have the same number of
/// pixels a metre.
[[nodiscard]] std::vector<Panel> shape_panels(const Drawing& drawing);

/// The same in space, in one plot.
[[nodiscard]] Panel spatial_panel(const Drawing& drawing);

/// Curvature of the series that have one against arc length.
[[nodiscard]] Panel curvature_panel(const std::vector<Series>& all, bool planar);

}  // namespace dlo::compare
