#include "explain/file_causes.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>
#include <vector>

#include "base/number.hpp"
#include "shape/curve.hpp"

namespace dlo::compare {
namespace {

struct NamedUnit {
  const char* name;
  double metres;
};
constexpr NamedUnit named_units[] = {{"metres", 1}, {"mm", 1e-3},       {"cm", 1e-2},
                                     {"um", 1e-6},  {"inches", 0.0254}, {"feet", 0.3048},
                                     {"km", 1e3}};

/// Range of the length of a file's polyline, divided by the rod's, for which a unit is considered
/// together with other errors.
constexpr double shortest = 0.5;
constexpr double longest = 1.25;

/// A unit that a file may be in.
struct FileUnit {
  std::string words;  ///< a clause: "the file is in mm, not in metres"; empty: the unit as read
  double factor = 1;  ///< factor that converts the shape to metres
};

/// Returns the units that the shape may be in, other than the one in which it was read.
std::vector<FileUnit> other_units(const MeasuredShape& shape) {
  constexpr double tolerance = 1e-9;
  std::string as_read = fmt::format("units of {:g} m", shape.unit);
  for (const NamedUnit& unit : named_units) {
    if (std::abs(unit.metres / shape.unit - 1) < tolerance) as_read = unit.name;
  }
  std::vector<FileUnit> units;
  for (const NamedUnit& unit : named_units) {
    if (as_read == unit.name) continue;
    units.push_back({fmt::format("the file is in {}, not in {}", unit.name, as_read),
                     unit.metres / shape.unit});
  }
  return units;
}

constexpr std::array axis_names = {"x", "y", "z"};

/// Names the file's axis that is the scene's vertical, if it differs; otherwise what is wrong with
/// the axes.
std::string name_of(const Eigen::Matrix3d& axes, const Eigen::Vector3d& gravity) {
  Eigen::Index vertical = 0;
  if (gravity.cwiseAbs().maxCoeff(&vertical) > 0.999 * gravity.norm() && gravity.norm() > 0) {
    for (Eigen::Index from = 0; from < 3; ++from) {
      const double sign = axes(vertical, from) * (gravity[vertical] < 0 ? 1 : -1);
      if (sign == 0 || (from == vertical && axes(vertical, from) > 0)) continue;
      return fmt::format("{} is {} in the file", axis_names[static_cast<std::size_t>(from)],
                         sign > 0 ? "up" : "down");
    }
  }
  return axes.determinant() < 0 ? "the file is mirrored" : "the file's axes are turned";
}

/// Describes which axes of the file are the scene's axes, for those that differ.
std::string axes_text(const Eigen::Matrix3d& axes) {
  std::string text;
  for (Eigen::Index to = 0; to < 3; ++to) {
    for (Eigen::Index from = 0; from < 3; ++from) {
      const double sign = axes(to, from);
      if (sign == 0 || (to == from && sign > 0)) continue;
      text += fmt::format("{}the scene's {} is the file's {}{}", text.empty() ? "" : ", ",
                          axis_names[static_cast<std::size_t>(to)], sign < 0 ? "-" : "",
                          axis_names[static_cast<std::size_t>(from)]);
    }
  }
  return text;
}

/// Returns all signed permutations except the identity, in the order of the number of exchanged
/// axes, then (if axes are exchanged) proper rotations before mirror images, then in the order of
/// the number of negative signs.
std::vector<Eigen::Matrix3d> signed_permutations() {
  std::vector<Eigen::Matrix3d> all;
  std::array<Eigen::Index, 3> order = {0, 1, 2};
  do {
    for (int signs = 0; signs < 8; ++signs) {
      Eigen::Matrix3d axes = Eigen::Matrix3d::Zero();
      for (Eigen::Index i = 0; i < 3; ++i) {
        axes(i, order[static_cast<std::size_t>(i)]) = (signs >> i) % 2 == 0 ? 1 : -1;
      }
      if (!axes.isIdentity()) all.push_back(axes);
    }
  } while (std::next_permutation(order.begin(), order.end()));
  const auto changes = [](const Eigen::Matrix3d& axes) {
    const auto exchanged = static_cast<int>(std::lround(3 - axes.cwiseAbs().trace()));
    const int mirrored = axes.determinant() < 0 ? 1 : 0;
    const auto negative = static_cast<int>((axes.array() < 0).count());
    return std::array{exchanged, exchanged > 0 ? mirrored : 0, negative};
  };
  std::stable_sort(all.begin(), all.end(), [&](const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
    return changes(a) < changes(b);
  });
  return all;
}

/// Axes that a file may have; `words` is empty if they are the scene's.
struct FileAxes {
  Eigen::Matrix3d axes;  ///< from the file's coordinates to the scene's: signed permutation
  std::string words;     ///< a clause: "z is up in the file (the scene's y is the file's z, ..)"
};

/// Returns all axes with which the points differ from those in the scene's axes and in any axes
/// listed before, by more than 1e-9 of their largest coordinate. The order is that of
/// signed_permutations().
/// @param points  in the file's axes, 3 x M
std::vector<FileAxes> other_axes(const Eigen::Vector3d& gravity, const Eigen::Matrix3Xd& points) {
  constexpr double rounding = 1e-9;
  const double extent = points.cwiseAbs().maxCoeff();
  std::vector<FileAxes> result;
  std::vector<Eigen::Matrix3Xd> tried = {points};
  for (const Eigen::Matrix3d& axes : signed_permutations()) {
    Eigen::Matrix3Xd candidate = axes * points;
    const bool is_tried = std::ranges::any_of(tried, [&](const Eigen::Matrix3Xd& other) {
      return (candidate - other).cwiseAbs().maxCoeff() <= rounding * extent;
    });
    if (is_tried) continue;
    tried.push_back(std::move(candidate));
    result.push_back({axes, fmt::format("{} ({})", name_of(axes, gravity), axes_text(axes))});
  }
  return result;
}

/// Returns the shape with its points and arc lengths multiplied by a factor.
MeasuredShape scaled(MeasuredShape shape, double factor) {
  shape.points *= factor;
  for (double& s : shape.arc_length) s *= factor;
  return shape;
}

/// Returns the shape in other axes.
MeasuredShape turned(MeasuredShape shape, const Eigen::Matrix3d& axes) {
  shape.points = (axes * shape.points).eval();
  return shape;
}

MeasuredShape without(const MeasuredShape& shape, Eigen::Index first, Eigen::Index count) {
  MeasuredShape rest = shape;
  rest.points = shape.points.middleCols(first, count);
  if (!shape.arc_length.empty()) {
    rest.arc_length.assign(shape.arc_length.begin() + first,
                           shape.arc_length.begin() + first + count);
  }
  return rest;
}

/// Whether a polyline is shorter than 99 % of the rod.
bool is_short(double polyline_length, double length) { return polyline_length < 0.99 * length; }

/// Unit and axes of a file, and its points with both corrected.
struct CorrectedFile {
  const FileUnit& unit;
  const FileAxes& axes;
  MeasuredShape shape;
  double covered;  ///< length of its polyline, divided by that of the rod
};

/// Calls `take` for a file as it is, with another origin, with missing ends, and with both.
void combine_poses(const CorrectedFile& file, bool several, const TakeFileCause& take) {
  const int changed = (file.unit.words.empty() ? 0 : 1) + (file.axes.words.empty() ? 0 : 1);
  const std::string group = several ? joint_cause : file.axes.words.empty() ? "" : "axes";
  for (const auto& [part, moved] : {std::pair(0, 0), {0, 1}, {1, 0}, {1, 1}}) {
    const int errors = changed + part + moved;
    if (errors == 0 || several != (errors > 1)) continue;
    if (part == 1 && !(several && is_short(file.covered, 1))) continue;
    take({.words = file.unit.words + (changed == 2 ? ", and " : "") + file.axes.words,
          .shape = file.shape,
          .pose = moved == 1 ? PoseFreedom::translation : PoseFreedom::known,
          .numbers = errors - 1 + moved,
          .part = part == 1,
          .cause_group = group});
  }
}

/// Calls `take` for each of these errors of a file, or for each combination of several ones: its
/// unit, its axes, its origin and, in combinations, missing ends. Each error after the first counts
/// as one number, and another origin as one more.
/// @param length  length of the rod's axis, with stretch [m]
void combine_errors(const Scene& scene, const MeasuredShape& shape, double length, bool several,
                    const TakeFileCause& take) {
  std::vector<FileAxes> all_axes = other_axes(scene.gravity, shape.points);
  all_axes.insert(all_axes.begin(), {Eigen::Matrix3d::Identity(), ""});
  std::vector<FileUnit> units = other_units(shape);
  units.insert(units.begin(), {"", 1});
  const double share = arc_lengths_along(shape.points).back() / length;
  for (const FileUnit& unit : units) {
    const double covered = share * unit.factor;
    if (several && !(covered > shortest && covered < longest)) continue;
    const MeasuredShape in_metres = scaled(shape, unit.factor);
    for (const FileAxes& axes : all_axes) {
      combine_poses({unit, axes, turned(in_metres, axes.axes), covered}, several, take);
    }
  }
}

/// Returns the transformation from the axes of a picture to the scene's.
/// @param up  1 if the picture's y points up, -1 if it points down
Eigen::Matrix3d picture_axes(const Eigen::Vector3d& gravity, double up) {
  Eigen::Index vertical = 1;
  if (gravity.norm() > 0) gravity.cwiseAbs().maxCoeff(&vertical);
  const double against = gravity[vertical] > 0 ? -up : up;
  Eigen::Matrix3d axes = Eigen::Matrix3d::Zero();
  axes(vertical, 1) = against;
  axes(vertical == 0 ? 1 : 0, 0) = 1;
  axes(vertical == 2 ? 1 : 2, 2) = 1;
  return axes;
}

/// Adds pixel coordinates: of any scale, counted from a corner, often downwards. Adds none if the
/// polyline is as long as the rod within about 10 %.
void add_pixels(const Scene& scene, const MeasuredShape& shape, const TakeFileCause& take) {
  const double per_unit = scene.length / arc_lengths_along(shape.points).back();
  constexpr double least_log_change = 0.1;
  if (!(std::abs(std::log(per_unit)) > least_log_change)) return;
  for (const double up : {-1.0, 1.0}) {
    take({.words = fmt::format("the file is in pixels of {:.4g} mm, y {}", per_unit * 1e3,
                               up < 0 ? "down" : "up"),
          .shape = turned(scaled(shape, per_unit), picture_axes(scene.gravity, up)),
          .pose = PoseFreedom::translation,
          .numbers = 3,  // the scale, the axes and the origin
          .cause_group = "pixels"});
  }
}

/// Returns the length and the order of the greedy path from a point, always to the nearest
/// remaining point.
std::pair<double, std::vector<Eigen::Index>> greedy_path_from(Eigen::Index start,
                                                              const Eigen::Matrix3Xd& points) {
  std::vector<Eigen::Index> left(static_cast<std::size_t>(points.cols()));
  std::iota(left.begin(), left.end(), Eigen::Index{0});
  std::vector<Eigen::Index> order;
  double length = 0;
  std::swap(left[static_cast<std::size_t>(start)], left.back());
  while (true) {
    const Eigen::Index last = left.back();
    left.pop_back();
    order.push_back(last);
    if (left.empty()) return {length, std::move(order)};
    const auto distance = [&](Eigen::Index i) { return (points.col(i) - points.col(last)).norm(); };
    const auto next = std::ranges::min_element(left, {}, distance);
    length += distance(*next);
    std::swap(*next, left.back());
  }
}

/// Adds another order of the points, if the shortest greedy path through them is clearly shorter
/// than the file's polyline. Files with arc lengths or with more than 300 points are not
/// considered.
void add_point_order_cause(const MeasuredShape& shape, const ShapeCheck& check,
                           const TakeFileCause& take) {
  constexpr Eigen::Index most_points = 300;
  constexpr double shorter_length_share = 0.95;
  const Eigen::Index count = shape.points.cols();
  if (!shape.arc_length.empty() || count > most_points) return;
  std::pair<double, std::vector<Eigen::Index>> shortest{
      shorter_length_share * check.polyline_length_m, {}};
  for (Eigen::Index start = 0; start < count; ++start) {
    auto way = greedy_path_from(start, shape.points);
    if (way.first < shortest.first) shortest = std::move(way);
  }
  std::vector<Eigen::Index>& order = shortest.second;
  if (order.empty()) return;
  if (order.front() > order.back()) std::ranges::reverse(order);
  MeasuredShape sorted = shape;
  std::string numbers;
  constexpr Eigen::Index most_listed = 6;
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Index from = order[static_cast<std::size_t>(i)];
    sorted.points.col(i) = shape.points.col(from);
    if (i < most_listed) numbers += fmt::format("{}{}", i == 0 ? "" : ", ", from + 1);
  }
  if (count > most_listed) numbers += ", ..";
  take({fmt::format("the file's points are out of order: along the rod they are {}", numbers),
        std::move(sorted)});
}

/// Adds points at an end that lead away from the rod, and a file that covers only a part of the
/// rod.
void add_extent_causes(const MeasuredShape& shape, const ShapeCheck& check,
                       const TakeFileCause& take) {
  const std::vector<double>& s = check.reference.arc_length;
  // A shorter part lies close to the rod for almost any file.
  constexpr double least_part = 0.05;
  const double part = s.back() - s.front();
  if (is_short(part, check.length_m) && part > least_part * check.length_m &&
      is_short(check.polyline_length_m, check.stretched_length_m)) {
    take({"", shape, PoseFreedom::known, 0, true});
  }
  const Eigen::Index count = shape.points.cols();
  const Eigen::Index most = std::min<Eigen::Index>(3, count - 3);
  for (Eigen::Index k = 1; k <= most; ++k) {
    const std::string points = k == 1 ? "point leads" : fmt::format("{} points lead", k);
    take({fmt::format("the file's last {} away from the rod: a hook", points),
          without(shape, 0, count - k), PoseFreedom::known, 0, true, "last points"});
    take({fmt::format("the file's first {} away from the rod: a hook", points),
          without(shape, k, count - k), PoseFreedom::known, 0, true, "first points"});
  }
}

/// Adds the scale that makes the file as long as the rod, about the file's origin and about the
/// rod's first point, which an extension of the rod leaves where it is.
void add_scale(const MeasuredShape& shape, const ShapeCheck& check, const TakeFileCause& take) {
  constexpr double tolerance = 1e-3;
  const double stretch = check.polyline_length_m / check.stretched_length_m;
  if (!(stretch > 0) || std::abs(stretch - 1) <= tolerance) return;
  const bool may_be_strain = stretch > 0.5 && stretch < 2;
  const std::string words =
      may_be_strain
          ? fmt::format("the file's rod is {} by {:.3g} %",
                        stretch > 1 ? "stretched" : "compressed", std::abs(stretch - 1) * 100)
          : fmt::format("the file is in units of {:.4g} m", shape.unit / stretch);
  const Eigen::Vector3d first = check.alignment.reversed
                                    ? Eigen::Vector3d(shape.points.rightCols<1>())
                                    : Eigen::Vector3d(shape.points.leftCols<1>());
  for (const bool about_first : {true, false}) {
    const Eigen::Vector3d fixed = about_first ? first : Eigen::Vector3d(Eigen::Vector3d::Zero());
    MeasuredShape right = shape;
    right.points = ((shape.points.colwise() - fixed) / stretch).colwise() + fixed;
    // A strain about the first point follows from the file's length and counts as no number. Other
    // scales count as one number, so that a named unit, which counts as none, is preferred.
    const int numbers = may_be_strain && about_first ? 0 : 1;
    take({words, std::move(right), PoseFreedom::known, numbers, false, "scale"});
  }
}

/// Returns the rotation R for which the points R from[i] are nearest to the points to[i]; where the
/// points do not determine it, the one with the smallest angle.
Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3Xd& from, const Eigen::Matrix3Xd& to) {
  constexpr double regularisation = 1e-9;
  Eigen::Matrix3d moments = to * from.transpose();
  moments += regularisation * from.norm() * to.norm() * Eigen::Matrix3d::Identity();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(moments, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double sign = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  return svd.matrixU() * Eigen::Vector3d(1, 1, sign).asDiagonal() * svd.matrixV().transpose();
}

/// Adds the rotation of the file about each gripper that brings it nearest to the rod.
void add_rotations(const Scene& scene, const MeasuredShape& shape, const ShapeCheck& check,
                   const TakeFileCause& take) {
  const Eigen::Matrix3Xd& points = check.alignment.shape.points;
  std::vector<double> s = check.alignment.shape.arc_length;
  // Nearest points on the rod are biased if the file is rotated; lengths along the file are not.
  if (shape.arc_length.empty() && !is_short(check.polyline_length_m, check.stretched_length_m)) {
    s = arc_lengths_along(points);
    const double scale = check.length_m / s.back();
    for (double& at : s) at = std::min(at * scale, check.length_m);
  }
  const Eigen::Matrix3Xd rod = check.rod.sample(s).points;
  for (std::size_t i = 0; i < scene.grippers.size(); ++i) {
    const Eigen::Vector3d& centre = scene.grippers[i].position;
    const Eigen::Matrix3d rotation =
        nearest_rotation(points.colwise() - centre, rod.colwise() - centre);
    // The rotation back from the corrected shape to the file is the error that is reported.
    const Eigen::AngleAxisd error(rotation.transpose());
    MeasuredShape right = shape;
    right.points = ((rotation * (shape.points.colwise() - centre)).colwise() + centre).eval();
    take({.words = fmt::format("the file is rotated by {:.3g} deg about gripper {}",
                               error.angle() * 180 / std::numbers::pi, i + 1),
          .shape = std::move(right),
          .numbers = 3,  // the rotation vector, in any plane
          .cause_group = "rotated file"});
  }
}

}  // namespace

void try_joint_errors(const Scene& scene, const MeasuredShape& shape, double length,
                      const TakeFileCause& take) {
  combine_errors(scene, shape, length, true, take);
}

std::string missing_ends_clause(const std::vector<double>& s, const Eigen::Matrix3Xd& points,
                                double length) {
  if (!lacks_one_segment(points, length)) {
    return fmt::format("the file is a part of the rod, s = {:.4g} to {:.4g} m: cut off", s.front(),
                       s.back());
  }
  const double segment = length / static_cast<double>(points.cols());
  const double first = s.front() / segment;
  const char* const what = first < 0.25   ? "an end point is missing, as in MuJoCo's xpos"
                           : first < 0.75 ? "the points are the middles of the rod's segments"
                                          : "an end point is missing, the first";
  return fmt::format("{}: the file has s = {:.4g} to {:.4g} m", what, s.front(), s.back());
}

std::string origin_clause(const Eigen::Vector3d& translation) {
  const Eigen::Vector3d mm = translation * 1e3;
  const double large = mm.norm();
  return fmt::format("the file has another origin, [{:.4g}, {:.4g}, {:.4g}] mm away",
                     shown(mm.x(), large), shown(mm.y(), large), shown(mm.z(), large));
}

void try_single_errors(const Scene& scene, const MeasuredShape& shape, const ShapeCheck& check,
                       const TakeFileCause& take) {
  combine_errors(scene, shape, check.stretched_length_m, false, take);
  if (!shape.arc_length.empty()) {
    MeasuredShape against = shape;
    for (double& s : against.arc_length) s = check.length_m - s;
    take({"the file's arc lengths count from the other end", against});
  }
  add_pixels(scene, shape, take);
  add_point_order_cause(shape, check, take);
  add_extent_causes(shape, check, take);
  add_scale(shape, check, take);
  add_rotations(scene, shape, check, take);
}

std::optional<Explanation> noise_of_points(const Shape& shape,
                                           const energy_model::Equilibrium& rod) {
  const Eigen::Matrix3Xd gaps = shape.points - rod.sample(shape.arc_length).points;
  const Eigen::Index count = gaps.cols();
  const Eigen::Index around = std::max<Eigen::Index>(2, count / 10);
  if (count < 4 * around) return std::nullopt;
  Eigen::Matrix3Xd common(3, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Index first = std::max<Eigen::Index>(0, i - around);
    const Eigen::Index last = std::min(count - 1, i + around);
    common.col(i) = gaps.middleCols(first, last - first + 1).rowwise().mean();
  }
  const double noise = std::sqrt((gaps - common).colwise().squaredNorm().mean());
  const double left = std::sqrt(common.colwise().squaredNorm().mean());
  return Explanation{
      fmt::format("there were no noise from point to point, {:.3g} mm RMS", noise * 1e3), left, 0,
      ExplanationKind::file};
}

}  // namespace dlo::compare
