#include "explain/file_axes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace dlo::compare {
namespace {

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

/// Describes which axes of the file are the scene's axes.
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

/// Returns all signed permutations except the identity: those with the fewest changes first, and
/// among exchanged axes proper rotations before mirror images.
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

}  // namespace

std::vector<FileAxes> other_axes(const Eigen::Vector3d& gravity, const Eigen::Matrix3Xd& points) {
  constexpr double rounding = 1e-9;
  const double extent = points.cwiseAbs().maxCoeff();
  std::vector<FileAxes> result;
  std::vector<Eigen::Matrix3Xd> told = {points};
  for (const Eigen::Matrix3d& axes : signed_permutations()) {
    Eigen::Matrix3Xd said = axes * points;
    const bool is_told = std::ranges::any_of(told, [&](const Eigen::Matrix3Xd& other) {
      return (said - other).cwiseAbs().maxCoeff() <= rounding * extent;
    });
    if (is_told) continue;
    told.push_back(std::move(said));
    result.push_back({axes, fmt::format("{} ({})", name_of(axes, gravity), axes_text(axes))});
  }
  return result;
}

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

}  // namespace dlo::compare
