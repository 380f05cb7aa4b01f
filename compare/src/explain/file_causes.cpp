#include "explain/file_causes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "shape/arc_lengths.hpp"

namespace dlo::compare {
namespace {

MeasuredShape scaled(MeasuredShape shape, double factor) {
  shape.points *= factor;
  for (double& s : shape.arc_length) s *= factor;
  return shape;
}

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

constexpr std::array names = {"x", "y", "z"};

/// Which axis of the file is the scene's vertical, if it is another one; else what is wrong.
std::string name_of(const Eigen::Matrix3d& axes, const Eigen::Vector3d& gravity) {
  Eigen::Index vertical = 0;
  if (gravity.cwiseAbs().maxCoeff(&vertical) > 0.999 * gravity.norm() && gravity.norm() > 0) {
    for (Eigen::Index from = 0; from < 3; ++from) {
      const double sign = axes(vertical, from) * (gravity[vertical] < 0 ? 1 : -1);
      if (sign == 0 || (from == vertical && axes(vertical, from) > 0)) continue;
      return fmt::format("{} is {} in the file", names[static_cast<std::size_t>(from)],
                         sign > 0 ? "up" : "down");
    }
  }
  return axes.determinant() < 0 ? "the file is mirrored" : "the file's axes are turned";
}

/// In words which of the file's axes are the scene's.
std::string axes_text(const Eigen::Matrix3d& axes) {
  std::string text;
  for (Eigen::Index to = 0; to < 3; ++to) {
    for (Eigen::Index from = 0; from < 3; ++from) {
      const double sign = axes(to, from);
      if (sign == 0 || (to == from && sign > 0)) continue;
      text += fmt::format("{}the scene's {} is the file's {}{}", text.empty() ? "" : ", ",
                          names[static_cast<std::size_t>(to)], sign < 0 ? "-" : "",
                          names[static_cast<std::size_t>(from)]);
    }
  }
  return text;
}

/// Other axes, those with the fewest changes first, of exchanged ones proper turns before mirror
/// images.
std::vector<Eigen::Matrix3d> other_axes() {
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

void add_units(const MeasuredShape& shape, std::vector<FileCause>& causes) {
  struct Unit {
    const char* name;
    double metres;
  };
  constexpr std::array units = {Unit{"mm", 1e-3}, Unit{"cm", 1e-2}, Unit{"inches", 0.0254},
                                Unit{"feet", 0.3048}, Unit{"km", 1e3}};
  for (const Unit& unit : units) {
    causes.push_back(
        {fmt::format("the file is in {}, not in metres", unit.name), scaled(shape, unit.metres)});
  }
}

/// The scene's axes as those of a picture, in which y is up or down.
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

/// A picture: of any scale, and it counts from a corner, often downwards.
void add_pixels(const Scene& scene, const MeasuredShape& shape, std::vector<FileCause>& causes) {
  const double per_unit = scene.length / lengths_along(shape.points).back();
  const bool other_scale = std::abs(std::log(per_unit)) > 0.1;
  for (const double up : {-1.0, 1.0}) {
    const Eigen::Matrix3d axes = picture_axes(scene.gravity, up);
    if (!other_scale && axes.isIdentity()) continue;
    const char* const direction = up < 0 ? "down" : "up";
    FileCause cause;
    cause.words =
        other_scale
            ? fmt::format("the file is in pixels of {:.4g} mm, y {}, with an origin of its own",
                          per_unit * 1e3, direction)
            : fmt::format("y is {} in the file, which has another origin", direction);
    cause.shape = turned(other_scale ? scaled(shape, per_unit) : shape, axes);
    cause.pose = PoseFreedom::translation;
    cause.numbers = other_scale ? 2 : 1;
    cause.same_as = other_scale ? "pixels" : "axes";
    causes.push_back(std::move(cause));
  }
}

/// From a point on, each the nearest of those that are left, and how long that way is.
std::pair<double, std::vector<Eigen::Index>> way_from(Eigen::Index start,
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

/// Points whose shortest way past all of them is another one than the file's.
void add_order(const MeasuredShape& shape, const ShapeCheck& check,
               std::vector<FileCause>& causes) {
  constexpr Eigen::Index most_points = 300;
  constexpr double clearly_shorter = 0.95;
  const Eigen::Index count = shape.points.cols();
  if (!shape.arc_length.empty() || count > most_points) return;
  std::pair<double, std::vector<Eigen::Index>> shortest{clearly_shorter * check.polyline_length_m,
                                                        {}};
  for (Eigen::Index start = 0; start < count; ++start) {
    auto way = way_from(start, shape.points);
    if (way.first < shortest.first) shortest = std::move(way);
  }
  std::vector<Eigen::Index>& order = shortest.second;
  if (order.empty()) return;
  if (order.front() > order.back()) std::ranges::reverse(order);
  MeasuredShape sorted = shape;
  std::string numbers;
  constexpr Eigen::Index most_told = 6;
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Index from = order[static_cast<std::size_t>(i)];
    sorted.points.col(i) = shape.points.col(from);
    if (i < most_told) numbers += fmt::format("{}{}", i == 0 ? "" : ", ", from + 1);
  }
  if (count > most_told) numbers += ", ..";
  causes.push_back(
      {fmt::format("the file's points are out of order: along the rod they are {}", numbers),
       std::move(sorted)});
}

/// Points at an end that lead away from the rod, and a rod that is stretched as a whole.
void add_lengths(const MeasuredShape& shape, const ShapeCheck& check,
                 std::vector<FileCause>& causes) {
  const std::vector<double>& s = check.reference.arc_length;
  constexpr double short_of = 0.99;
  if (s.back() - s.front() < short_of * check.length_m &&
      check.polyline_length_m < short_of * check.length_m) {
    const std::string part = fmt::format("s = {:.4g} to {:.4g} m", s.front(), s.back());
    causes.push_back(
        {lacks_one_segment(shape.points, check.length_m)
             ? fmt::format("an end point is missing, as in MuJoCo's xpos: the file has {}", part)
             : fmt::format("the file is a part of the rod, {}: cut off", part),
         shape, PoseFreedom::known, 0, true});
  }
  const Eigen::Index count = shape.points.cols();
  const Eigen::Index most = std::min<Eigen::Index>(3, count - 3);
  for (Eigen::Index k = 1; k <= most; ++k) {
    const std::string points = k == 1 ? "point leads" : fmt::format("{} points lead", k);
    causes.push_back({fmt::format("the file's last {} away from the rod: a hook", points),
                      without(shape, 0, count - k), PoseFreedom::known, 0, true, "last points"});
    causes.push_back({fmt::format("the file's first {} away from the rod: a hook", points),
                      without(shape, k, count - k), PoseFreedom::known, 0, true, "first points"});
  }
  const double stretch = check.polyline_length_m / check.length_m;
  if (stretch > 0.5 && stretch < 2 && std::abs(stretch - 1) > 1e-3) {
    MeasuredShape right = shape;
    const Eigen::Vector3d fixed = check.alignment.reversed
                                      ? Eigen::Vector3d(shape.points.rightCols<1>())
                                      : Eigen::Vector3d(shape.points.leftCols<1>());
    right.points = ((shape.points.colwise() - fixed) / stretch).colwise() + fixed;
    causes.push_back(
        {fmt::format("the file's rod is {} by {:.3g} %", stretch > 1 ? "stretched" : "compressed",
                     std::abs(stretch - 1) * 100),
         right});
  }
}

}  // namespace

std::vector<FileCause> file_causes(const Scene& scene, const MeasuredShape& shape,
                                   const ShapeCheck& check) {
  std::vector<FileCause> causes;
  for (const Eigen::Matrix3d& axes : other_axes()) {
    causes.push_back({fmt::format("{} ({})", name_of(axes, scene.gravity), axes_text(axes)),
                      turned(shape, axes)});
    causes.back().same_as = "axes";
  }
  if (!shape.arc_length.empty()) {
    MeasuredShape against = shape;
    for (double& s : against.arc_length) s = check.length_m - s;
    causes.push_back({"the file's arc lengths count from the other end", against});
  }
  causes.push_back({scene.grippers.size() == 1
                        ? "the file has another origin, or the gripper is elsewhere"
                        : "the file has another origin",
                    shape, PoseFreedom::translation, 1});
  add_units(shape, causes);
  add_pixels(scene, shape, causes);
  add_order(shape, check, causes);
  add_lengths(shape, check, causes);
  return causes;
}

}  // namespace dlo::compare
