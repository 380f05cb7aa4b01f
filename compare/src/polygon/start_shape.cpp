#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "polygon/point_layout.hpp"
#include "polygon/scalar_search.hpp"

namespace dlo::compare {
namespace {

constexpr int curve_points = 400;
/// Displacement of an arch out of its plane, divided by the rod length.
constexpr double lean = 1e-6;

/// A grip as the curve uses it, with a direction for pins too.
struct GripPoint {
  double at;
  Eigen::Vector3d position;
  Eigen::Vector3d direction;
};

/// Returns the component of `vector` perpendicular to the unit vector `axis`; zero if only rounding
/// is left.
Eigen::Vector3d across(const Eigen::Vector3d& vector, const Eigen::Vector3d& axis) {
  const Eigen::Vector3d result = vector - vector.dot(axis) * axis;
  return result.norm() > 1e-9 * vector.norm() ? result : Eigen::Vector3d::Zero();
}

/// Returns the unit vector perpendicular to an axis that is nearest to +x, or to +y for an axis
/// within about 26 degrees of the x axis. The same convention applies in the whole project.
Eigen::Vector3d any_across(const Eigen::Vector3d& axis) {
  const Eigen::Vector3d towards =
      std::abs(axis.x()) < 0.9 ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitY();
  return across(towards, axis).normalized();
}

Eigen::Vector3d load_between(const Scene& scene, double begin, double end) {
  Eigen::Vector3d load = scene.weight_per_length() * (end - begin);
  load += scene.distributed_between(begin, end);
  for (const PointLoad& point_load : scene.loads) {
    if (point_load.at > begin && point_load.at < end) load += point_load.force;
  }
  return load;
}

std::vector<GripPoint> grip_points(const Scene& scene, const std::vector<std::size_t>& along) {
  std::vector<GripPoint> knots;
  for (std::size_t k = 0; k < along.size(); ++k) {
    const Gripper& gripper = scene.grippers[along[k]];
    Eigen::Vector3d direction = Eigen::Vector3d::Zero();
    if (gripper.direction) {
      direction = *gripper.direction;
    } else {
      const Gripper& before = scene.grippers[along[k > 0 ? k - 1 : 0]];
      const Gripper& after = scene.grippers[along[std::min(k + 1, along.size() - 1)]];
      direction = after.position - before.position;
      // A rod on a single pin hangs from it.
      if (!(direction.norm() > 0)) direction = load_between(scene, gripper.at, scene.length);
      direction = direction.norm() > 0 ? direction.normalized() : Eigen::Vector3d::UnitX();
    }
    knots.push_back({gripper.at, gripper.position, direction});
  }
  return knots;
}

/// The curve between two knots.
class Arch {
 public:
  Arch(const Scene& scene, const GripPoint& begin, const GripPoint& end, Side side)
      : begin_(begin), end_(end), slope_(end.at - begin.at) {
    const double rod = end.at - begin.at;
    const Eigen::Vector3d chord = end.position - begin.position;
    if (chord.norm() > 1e-6 * rod) {
      axis_ = chord.normalized();
    } else {
      axis_ = begin.direction;
    }
    up_ = across(load_between(scene, begin.at, end.at), axis_);
    if (up_.norm() == 0) up_ = across(begin.direction - end.direction, axis_);
    up_ = up_.norm() > 0 ? up_.normalized() : any_across(axis_);
    if (side == Side::against_load) up_ = -up_;
    lean_ = lean * rod * axis_.cross(up_);
    if (lengths_along().back() > rod) {
      solve(slope_, slope_, rod);
    } else {
      solve(height_, 2 * rod, rod);
    }
  }

  /// Returns the points at the given fractions of the curve's length.
  [[nodiscard]] Eigen::Matrix3Xd at(const std::vector<double>& shares) const {
    const std::vector<double> lengths = lengths_along();
    Eigen::Matrix3Xd result(3, static_cast<Eigen::Index>(shares.size()));
    for (std::size_t k = 0; k < shares.size(); ++k) {
      const double wanted = shares[k] * lengths.back();
      const auto above = std::upper_bound(lengths.begin() + 1, lengths.end() - 1, wanted);
      const double part = (wanted - *(above - 1)) / (*above - *(above - 1));
      const double i = static_cast<double>(above - 1 - lengths.begin());
      result.col(static_cast<Eigen::Index>(k)) = point(i + part);
    }
    return result;
  }

 private:
  [[nodiscard]] Eigen::Vector3d point(double i) const {
    const double u = i / curve_points;
    const double w = 1 - u;
    const double bump = 16 * u * u * w * w;
    // A high arch is also widened, so that its two sides do not touch.
    const double width = 1.7 * height_ * height_ / (end_.at - begin_.at);
    return begin_.position * (w * w * (1 + 2 * u)) + end_.position * (u * u * (1 + 2 * w)) +
           slope_ * (u * w * w * begin_.direction - u * u * w * end_.direction) +
           bump * (height_ * up_ + lean_) - width * bump * (w - u) * axis_;
  }

  /// Returns the length of the curve up to each of its points.
  [[nodiscard]] std::vector<double> lengths_along() const {
    std::vector<double> lengths(1, 0);
    Eigen::Vector3d last = point(0);
    for (int i = 1; i <= curve_points; ++i) {
      const Eigen::Vector3d next = point(i);
      lengths.push_back(lengths.back() + (next - last).norm());
      last = next;
    }
    return lengths;
  }

  /// Sets one parameter of the curve, between 0 and `most`, so that the curve has the length of the
  /// rod. Sets it to 0 if the curve is longer even then, as between grips that are too far apart.
  void solve(double& number, double most, double rod) {
    constexpr double rounding = 1e-15;
    const Function length_at = [&](double value) {
      number = value;
      return lengths_along().back();
    };
    number = length_at(0) < rod ? find_crossing(length_at, 0, most, rod, rounding * most) : 0;
  }

  GripPoint begin_, end_;
  Eigen::Vector3d axis_, up_, lean_;
  double slope_;  // scale of the directions in the cubic [m]
  double height_ = 0;
};

/// Returns the direction of a segment of length L that begins at `from`. A segment that would enter
/// a body is rotated into the body's surface.
/// @param last  direction along the surface if the segment points straight into the body
Eigen::Vector3d direction_along_surface(const obstacle::Body& body, const Eigen::Vector3d& from,
                                        const Eigen::Vector3d& direction, double L,
                                        const Eigen::Vector3d& last) {
  const obstacle::Gap gap = body.gap(from + L * direction);
  if (gap.value >= 0) return direction;
  const Eigen::Vector3d normal = gap.gradient;
  const double height = std::max(0.0, gap.value - L * direction.dot(normal));
  if (height + L * direction.dot(normal) >= 0) return direction;
  Eigen::Vector3d face = across(direction, normal);
  if (face.norm() < 1e-3) face = across(last, normal);
  face = face.norm() < 1e-3 ? any_across(normal) : Eigen::Vector3d(face.normalized());
  const double down = std::min(1.0, height / L);
  return std::sqrt(1 - down * down) * face - down * normal;
}

}  // namespace

Eigen::Matrix3Xd start_shape(const Scene& scene, const std::vector<std::size_t>& along,
                             const std::vector<double>& arc_length, Side side) {
  const std::vector<GripPoint> knots = grip_points(scene, along);
  Eigen::Matrix3Xd points(3, static_cast<Eigen::Index>(arc_length.size()));
  const auto straight = [&](const GripPoint& knot, std::size_t i) {
    points.col(static_cast<Eigen::Index>(i)) =
        knot.position + (arc_length[i] - knot.at) * knot.direction;
  };
  std::size_t i = 0;
  for (; i < arc_length.size() && arc_length[i] < knots.front().at; ++i) straight(knots.front(), i);
  for (std::size_t k = 0; k + 1 < knots.size(); ++k) {
    const double rod = knots[k + 1].at - knots[k].at;
    std::vector<double> shares;
    const auto first = static_cast<Eigen::Index>(i);
    for (; i < arc_length.size() && arc_length[i] < knots[k + 1].at; ++i) {
      shares.push_back((arc_length[i] - knots[k].at) / rod);
    }
    points.middleCols(first, static_cast<Eigen::Index>(shares.size())) =
        Arch(scene, knots[k], knots[k + 1], side).at(shares);
  }
  for (; i < arc_length.size(); ++i) straight(knots.back(), i);
  return points;
}

void keep_free_ends_clear(const force_model::Rod& rod, Eigen::Ref<Eigen::Matrix3Xd> points) {
  if (!rod.has_obstacles()) return;
  std::vector<obstacle::Body> bodies;
  for (const force_model::Wall& wall : rod.walls) {
    bodies.push_back(obstacle::Body::half_space(wall.point, wall.normal));
  }
  for (const force_model::Solid& solid : rod.solids) bodies.push_back(solid.body);
  Eigen::Index first = points.cols();
  Eigen::Index last = 0;
  for (const force_model::Grip& grip : rod.grips) {
    first = std::min(first, grip.first_point);
    last = std::max(last, grip.first_point + grip.targets.cols() - 1);
  }
  const Eigen::Matrix3Xd start = points;
  const auto walk = [&](Eigen::Index begin, Eigen::Index end, Eigen::Index stride) {
    Eigen::Vector3d before = Eigen::Vector3d::Zero();
    for (Eigen::Index i = begin; i != end; i += stride) {
      const Eigen::Vector3d step = start.col(i + stride) - start.col(i);
      const double L = step.norm();
      Eigen::Vector3d direction = step / L;
      for (const obstacle::Body& body : bodies) {
        direction = direction_along_surface(body, points.col(i), direction, L, before);
      }
      before = direction;
      points.col(i + stride) = points.col(i) + L * direction;
    }
  };
  walk(last, points.cols() - 1, 1);
  walk(first, 0, -1);
}

}  // namespace dlo::compare
