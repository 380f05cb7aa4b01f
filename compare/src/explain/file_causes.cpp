#include "explain/file_causes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

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

void add_units(const MeasuredShape& shape, const ShapeCheck& check,
               std::vector<FileCause>& causes) {
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
  // A picture: of any scale, and it counts from a corner, often downwards.
  const double per_unit = check.length_m / check.polyline_length_m;
  const bool other_scale = std::abs(std::log(per_unit)) > 0.1;
  for (const bool down : {true, false}) {
    if (!down && !other_scale) continue;
    Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
    if (down) axes(1, 1) = -1;
    FileCause cause;
    cause.words =
        fmt::format("the file is in units of {:.4g} mm{} and has another origin, as pixels have",
                    per_unit * 1e3, down ? " with y down" : "");
    cause.shape = turned(scaled(shape, per_unit), axes);
    cause.pose = PoseFreedom::translation;
    cause.numbers = 2;
    causes.push_back(std::move(cause));
  }
}

/// Points at an end that lead away from the rod, and a rod that is stretched as a whole.
void add_lengths(const MeasuredShape& shape, const ShapeCheck& check,
                 std::vector<FileCause>& causes) {
  const std::vector<double>& s = check.reference.arc_length;
  constexpr double short_of = 0.99;
  if (s.back() - s.front() < short_of * check.length_m &&
      check.polyline_length_m < short_of * check.length_m) {
    causes.push_back({fmt::format("the file is a part of the rod, s = {:.4g} to {:.4g} m: cut off",
                                  s.front(), s.back()),
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
  add_units(shape, check, causes);
  add_lengths(shape, check, causes);
  return causes;
}

}  // namespace dlo::compare
