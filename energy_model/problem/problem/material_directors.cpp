#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/spin.hpp"
#include "dlo/energy_model/turns.hpp"
#include "problem/rod_law.hpp"
#include "problem/split.hpp"

namespace dlo::energy_model {
namespace {

using std::numbers::pi;

/// Returns the frame in which a clamp holds a rod with material directors. The clamp is the first
/// one, or it holds its frame.
Eigen::Matrix3d material_frame(const Problem& problem, const OrderedGrip& clamp) {
  if (clamp.index == first_clamp(problem)) return first_frame(problem);
  return held_frame(*clamp.grip, held_d1(problem, *clamp.grip));
}

/// Returns the rod's directors at the start of a span, as columns in the span's axes; its tangent
/// there is `along`. If no clamp holds the start, they are those of a rod in its plane.
Eigen::Matrix3d directors_at_start(const Problem& problem, const PlacedSpan& placed,
                                   const OrderedGrip& anchor, const Eigen::Vector3d& along) {
  Eigen::Matrix3d material_axes;
  if (placed.span.start_direction) {
    material_axes = placed.frame * material_frame(problem, anchor);
  } else {
    const Eigen::Vector3d normal = placed.frame * natural_normal(problem).value();
    material_axes << normal.cross(along), normal, along;
  }
  if (placed.reversed) material_axes.rightCols<2>() *= -1;
  return material_axes;
}

/// Chooses the frame at the start of the span, and the angle by which the rod's directors are ahead
/// of it. A round rod has the frame of Span::d1(), whatever the angle. A rod with two bending
/// stiffnesses needs a frame along its principal axes: of the four, the one nearest to Span::d1()
/// is chosen, so that a rod in a plane across one of its axes bends about the first axis of the
/// frame.
void place_start_frame(const Eigen::Vector3d& along, const Eigen::Matrix3d& material_axes,
                       bool is_round, PlacedSpan& placed) {
  Span& span = placed.span;
  const Eigen::Vector3d d1 = Span::d1(along);
  const Eigen::Matrix3d to_own = frame_along(along, d1).transpose() * material_axes;
  placed.ahead = std::atan2(to_own(1, 0), to_own(0, 0));
  if (is_round) return;
  const double quarters = std::round(placed.ahead / (pi / 2));
  const double roll_error = placed.ahead - quarters * pi / 2;
  placed.ahead = quarters * pi / 2;
  if (std::abs(roll_error) > planar_tolerance) {
    span.planar = false;
    span.principal_d1 = Eigen::AngleAxisd(roll_error, along) * frame_along(along, d1).col(0);
  }
  if (std::fmod(std::abs(quarters), 2) == 0) return;
  std::swap(span.stiffness[0], span.stiffness[1]);
  for (Span::Part& part : span.parts) std::swap(part.stiffness[0], part.stiffness[1]);
}

/// Places the natural strains of sections, about the same axes as the span's.
void place_natural_parts(const Problem& problem, PlacedSpan& placed) {
  const double l = problem.length;
  Span& span = placed.span;
  for (const Section& section : problem.sections) {
    if (!section.natural_curvature && !section.natural_twist) continue;
    const double a = placed.s_of(section.begin, l);
    const double b = placed.s_of(section.end, l);
    const double begin = std::max(std::min(a, b), 0.0);
    const double end = std::min(std::max(a, b), span.length);
    if (!(end > begin)) continue;
    NaturalStrains::Part part{begin, end, std::nullopt, std::nullopt};
    if (section.natural_curvature) {
      Eigen::Vector2d bend = l * *section.natural_curvature;
      if (placed.reversed) bend.x() *= -1;
      part.bend = Eigen::Rotation2Dd(placed.ahead) * bend;
    }
    if (section.natural_twist) part.twist = l * *section.natural_twist;
    span.natural.parts.push_back(part);
  }
  if (placed.reversed) std::reverse(span.natural.parts.begin(), span.natural.parts.end());
}

}  // namespace

void place_material_directors(const Problem& problem, const OrderedGrip& anchor,
                              PlacedSpan& placed) {
  Span& span = placed.span;
  const double l = problem.length;
  if (span.start_direction || span.planar) {
    const Eigen::Vector3d along =
        span.start_direction.value_or(Eigen::Vector3d(Eigen::Vector3d::UnitX()));
    place_start_frame(along, directors_at_start(problem, placed, anchor, along),
                      !has_two_stiffnesses(problem), placed);
  }
  const Eigen::AngleAxisd to_own(placed.ahead, Eigen::Vector3d::UnitZ());
  for (Eigen::Vector3d strain : problem.natural_strains) {
    if (placed.reversed) strain.x() *= -1;
    span.natural.coefficients.emplace_back(l * (to_own * strain));
  }
  if (span.natural.empty()) span.natural.coefficients = {Eigen::Vector3d::Zero()};
  place_natural_parts(problem, placed);
  const double sense = placed.reversed ? -1 : 1;
  span.natural.rate = 2 * sense;
  span.natural.from = 2 * placed.start / l - 1;
  // Whether contact keeps the rod from leaving the plane is decided in space.
  if (!span.soft_obstacles.empty() || !span.rigid_obstacles.empty()) span.planar = false;
  const double largest = span.natural.largest();
  for (Eigen::Vector3d& strain : span.natural.coefficients) {
    if (!span.planar) break;
    span.planar = strain.tail<2>().norm() <= planar_tolerance * largest;
    if (span.planar) strain.tail<2>().setZero();
  }
  for (NaturalStrains::Part& part : span.natural.parts) {
    if (!span.planar) break;
    const Eigen::Vector3d strain = part.over(Eigen::Vector3d::Zero());
    span.planar = strain.tail<2>().norm() <= planar_tolerance * largest;
    if (span.planar && part.bend) part.bend->y() = 0;
    if (span.planar && part.twist) part.twist = 0;
  }
}

}  // namespace dlo::energy_model
