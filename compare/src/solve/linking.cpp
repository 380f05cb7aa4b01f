#include "solve/linking.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "scene/reach.hpp"

namespace dlo::compare {
namespace {

constexpr double two_pi = 2 * std::numbers::pi;

/// Gauss's integral over two segments, ab and cd: the solid angle of the directions in which they
/// are seen to cross [rad].
double crossing_angle(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                      const Eigen::Vector3d& d) {
  const Eigen::Vector3d ac = c - a;
  const Eigen::Vector3d ad = d - a;
  const Eigen::Vector3d bc = c - b;
  const Eigen::Vector3d bd = d - b;
  std::array<Eigen::Vector3d, 4> normals = {ac.cross(ad), ad.cross(bd), bd.cross(bc), bc.cross(ac)};
  for (Eigen::Vector3d& normal : normals) {
    const double size = normal.norm();
    if (size == 0) return 0;  // in one plane
    normal /= size;
  }
  double angle = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    angle += std::asin(std::clamp(normals[k].dot(normals[(k + 1) % 4]), -1.0, 1.0));
  }
  const double side = (d - c).cross(b - a).dot(ac);
  return side == 0 ? 0 : std::copysign(angle, side);
}

/// Whether the half-line from `from` passes the segment ab at less than `distance`.
bool passes(const Eigen::Vector3d& from, const Eigen::Vector3d& direction, const Eigen::Vector3d& a,
            const Eigen::Vector3d& b, double distance) {
  const auto across = [&](const Eigen::Vector3d& v) -> Eigen::Vector3d {
    return v - v.dot(direction) * direction;
  };
  const Eigen::Vector3d to_a = across(a - from);
  const Eigen::Vector3d side = across(b - a);
  const double squared = side.squaredNorm();
  const double t = squared > 0 ? std::clamp(-to_a.dot(side) / squared, 0.0, 1.0) : 0.0;
  const double along = (a + t * (b - a) - from).dot(direction);
  return along > distance && (to_a + t * side).norm() < distance;
}

/// The turns that the frames at a part's ends hold, by them alone: the rolls, and where both say
/// where d1 is the angle between them after the shortest rotation of the one direction into the
/// other. None for opposite directions, which have no shortest one.
std::optional<double> held_turns(const Gripper& first, const Gripper& last) {
  double angle = last.frame->roll - first.frame->roll;
  if (first.direction->dot(*last.direction) < -1 + 1e-9) return std::nullopt;
  if (first.frame->d1 && last.frame->d1) {
    const Eigen::Vector3d carried =
        Eigen::Quaterniond::FromTwoVectors(*first.direction, *last.direction) * *first.frame->d1;
    const Eigen::Vector3d& d1 = *last.frame->d1;
    angle += std::atan2(carried.cross(d1).dot(*last.direction), carried.dot(d1));
  }
  return angle / two_pi;
}

/// The writhe of a part of a shape, by polygons with more and more points.
std::optional<double> writhe_of_part(const energy_model::Equilibrium& equilibrium, double begin,
                                     double end) {
  constexpr int first_points = 64;
  constexpr int most_points = 1024;
  constexpr double tolerance = 1e-2;
  std::optional<double> before;
  for (int points = first_points; points <= most_points; points *= 2) {
    std::vector<double> arc_lengths(static_cast<std::size_t>(points));
    for (int i = 0; i < points; ++i) {
      arc_lengths[static_cast<std::size_t>(i)] = begin + (end - begin) * i / (points - 1);
    }
    const energy_model::Samples samples = equilibrium.sample(arc_lengths);
    const std::optional<double> now =
        writhe(samples.points, samples.tangents.col(0), samples.tangents.col(points - 1));
    if (!now || (before && std::abs(*now - *before) < tolerance)) return now;
    before = now;
  }
  return std::nullopt;
}

/// By how many turns a shape misses those that are held. Each passage through itself takes or gives
/// two. Less than one is none: a roll without d1 counts from the rod without twist, whose writhe
/// the grips alone do not tell. A half-turn between frames may have been meant either way round.
double turns_lost(const Linking& part) {
  const double missing = part.held - part.twist - part.writhe;
  const double one_way = 2 * std::round(missing / 2);
  const double other_way = 2 * std::round((missing - 1) / 2);
  const bool half_turn = std::abs(std::abs(std::remainder(part.held, 1.0)) - 0.5) < 1e-6;
  return half_turn && std::abs(other_way) < std::abs(one_way) ? other_way : one_way;
}

}  // namespace

std::optional<double> writhe(const Eigen::Matrix3Xd& points, const Eigen::Vector3d& first,
                             const Eigen::Vector3d& last) {
  const Eigen::Index size = points.cols();
  const double length =
      (points.rightCols(size - 1) - points.leftCols(size - 1)).colwise().norm().sum();
  const double far = 1e4 * length;
  const double near = 1e-6 * length;
  Eigen::Matrix3Xd all(3, size + 2);
  all << points.col(0) - far * first, points, points.col(size - 1) + far * last;
  for (Eigen::Index i = 1; i < size; ++i) {
    if (passes(points.col(0), -first, all.col(i + 1), all.col(i + 2), near)) return std::nullopt;
    if (passes(points.col(size - 1), last, all.col(i - 1), all.col(i), near)) return std::nullopt;
  }
  double angle = 0;
  for (Eigen::Index i = 0; i + 1 < all.cols(); ++i) {
    for (Eigen::Index j = i + 2; j + 1 < all.cols(); ++j) {
      angle += crossing_angle(all.col(i), all.col(i + 1), all.col(j), all.col(j + 1));
    }
  }
  return angle / two_pi;
}

std::vector<Linking> linking_of(const Scene& scene, const energy_model::Equilibrium& equilibrium) {
  std::vector<const Gripper*> framed = grippers_along(scene);
  std::erase_if(framed, [](const Gripper* gripper) { return !gripper->frame; });
  std::vector<Linking> parts;
  for (const energy_model::TwistedPart& twist : equilibrium.twists) {
    const auto last = std::ranges::find_if(
        framed, [&](const Gripper* gripper) { return gripper->at >= twist.end; });
    if (last == framed.begin() || last == framed.end()) continue;
    const std::optional<double> held = held_turns(**(last - 1), **last);
    const std::optional<double> writhe = writhe_of_part(equilibrium, twist.begin, twist.end);
    if (!held || !writhe) continue;
    parts.push_back({.begin = twist.begin,
                     .end = twist.end,
                     .held = *held,
                     .twist = twist.angle / two_pi,
                     .writhe = *writhe});
  }
  return parts;
}

double unsigned_zero(double turns) { return std::abs(turns) < 0.5e-3 ? 0.0 : turns; }

std::string lost_turns(const std::vector<Linking>& parts) {
  for (const Linking& part : parts) {
    if (turns_lost(part) == 0) continue;
    return fmt::format(
        "not verified: the grips hold {:.3f} turns from s = {:g} to {:g} m and the shape has "
        "{:.3f} "
        "(twist {:.3f}, writhe {:.3f}): it has passed through itself",
        part.held, part.begin, part.end, unsigned_zero(part.twist + part.writhe),
        unsigned_zero(part.twist), unsigned_zero(part.writhe));
  }
  return {};
}

}  // namespace dlo::compare
