#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "base/spin.hpp"
#include "kirchhoff/relaxed_polygon.hpp"

namespace dlo::energy_model {
namespace {

using Eigen::Quaterniond;
using std::numbers::pi;
using Frames = std::vector<Quaterniond>;

/// Returns the frame from which the initial guesses are rotated. For a round rod it is arbitrary in
/// space; in a plane its d2 is across the plane.
Quaterniond base_frame(const RodSpan& span) {
  if (span.round() && span.plane) return Quaterniond(frame_along(span.plane->x, span.plane->y));
  return Quaterniond(span.first_frame);
}

/// Rotates a frame to a tangent by the shortest rotation. The axis of half a rotation is
/// undetermined; d2 is used, so that the frame stays in the plane.
Quaterniond rotated_to_tangent(const Quaterniond& frame, const Eigen::Vector3d& tangent) {
  const Eigen::Vector3d t = frame * Eigen::Vector3d::UnitZ();
  if (t.dot(tangent) < 1e-9 - 1) return frame * Quaterniond(0, 0, 1, 0);
  return Quaterniond::FromTwoVectors(t, tangent) * frame;
}

double middle_of(const RodMesh& mesh, Eigen::Index i) { return (mesh.s[i] + mesh.s[i + 1]) / 2; }

/// Line along which the span roughly extends, and the ratio of the distance of the outermost grips
/// to the length of rod between them (0.7 with a single grip).
struct SpanLine {
  Eigen::Vector3d direction;
  double share;
};

SpanLine line_of(const RodSpan& span) {
  const RodSpan::Hold& first = span.holds.front();
  const RodSpan::Hold& last = span.holds.back();
  const Eigen::Vector3d chord = last.position - first.position;
  if (last.at > first.at && chord.norm() > 1e-6) {
    return {chord.normalized(), chord.norm() / (last.at - first.at)};
  }
  const double share = last.at > first.at ? 0 : 0.7;
  if (!span.clamps.empty()) return {span.clamps.front().direction, share};
  return {base_frame(span) * Eigen::Vector3d::UnitZ(), share};
}

/// Returns the axes across the line about which frames along it are rotated away from it.
std::vector<Eigen::Vector3d> axes_of(const RodSpan& span, const Quaterniond& along, Motion motion) {
  const Eigen::Vector3d line = along * Eigen::Vector3d::UnitZ();
  // Normal of the plane, if the span has one.
  const Eigen::Vector3d normal = along * Eigen::Vector3d::UnitY();
  if (motion == Motion::in_plane) return {normal, -normal};
  std::vector<Eigen::Vector3d> axes;
  // A polygon of frames is more expensive than one of tangents.
  const int count = span.round() ? 6 : 4;
  for (int i = 0; i < count; ++i) {
    // The axes avoid the plane itself, which the planar search covers.
    const double angle = 2 * pi * (i - 0.1) / count;
    axes.emplace_back(std::cos(angle) * line.cross(normal) - std::sin(angle) * normal);
  }
  return axes;
}

/// Returns the frames of the stress-free rod with the frame of its first clamp, or without a clamp
/// `along` at its begin.
Frames natural_shape(const RodSpan& span, const RodMesh& mesh, const Quaterniond& along) {
  Frames shape(static_cast<std::size_t>(mesh.intervals()));
  const auto half = [&](Eigen::Index i, double side) {
    if (!span.natural) return Quaterniond::Identity();
    const Eigen::Vector3d rate = span.natural(middle_of(mesh, i));
    return from_rotation_vector(side * mesh.width(i) / 2 * rate);
  };
  const Quaterniond first = span.clamps.empty() ? along : Quaterniond(span.first_frame);
  const Eigen::Index node = span.clamps.empty() ? 0 : node_at(mesh.s, span.clamps.front().at);
  Quaterniond at = first;
  for (Eigen::Index i = node; i < mesh.intervals(); ++i) {
    shape[static_cast<std::size_t>(i)] = at * half(i, 1);
    at = shape[static_cast<std::size_t>(i)] * half(i, 1);
  }
  at = first;
  for (Eigen::Index i = node; i-- > 0;) {
    shape[static_cast<std::size_t>(i)] = at * half(i, -1);
    at = shape[static_cast<std::size_t>(i)] * half(i, -1);
  }
  return shape;
}

/// Rotates the tangents along the carried force, or against it if `side` is negative.
Frames rotated_along_force(const RodSpan& span, const RodMesh& mesh, Frames frames, double side) {
  const Eigen::Matrix3Xd carried = internal_force(span, mesh).on_interval;
  for (Eigen::Index i = 0; i < mesh.intervals(); ++i) {
    if (carried.col(i).norm() == 0) continue;
    frames[static_cast<std::size_t>(i)] =
        rotated_to_tangent(base_frame(span), side * carried.col(i).normalized());
  }
  return frames;
}

/// Rotates frames out of the plane, because shapes that lie in it may be unstable in space.
void tilt_out_of_plane(const RodSpan& span, const RodMesh& mesh, Frames& frames) {
  const double from = span.clamps.empty() ? 0 : span.clamps.front().at;
  const Eigen::Vector3d axis = base_frame(span) * Eigen::Vector3d(1, 0, 1);
  for (Eigen::Index i = 0; i < mesh.intervals(); ++i) {
    Quaterniond& q = frames[static_cast<std::size_t>(i)];
    const double x = (middle_of(mesh, i) - from) / span.length;
    q = from_rotation_vector(0.2 * std::sin(2 * x) * axis) * q;
  }
}

}  // namespace

std::vector<Frames> polygon_starts(const RodSpan& span, const RodMesh& mesh, Motion motion) {
  const SpanLine line = line_of(span);
  const Quaterniond along = rotated_to_tangent(base_frame(span), line.direction);
  const Frames straight(static_cast<std::size_t>(mesh.intervals()), along);
  std::vector<Frames> starts = {straight, rotated_along_force(span, mesh, straight, 1)};
  if (!span.round()) {
    starts.push_back(natural_shape(span, mesh, along));
    starts.push_back(rotated_along_force(span, mesh, straight, -1));
    if (motion == Motion::in_space) {
      for (Frames& frames : starts) tilt_out_of_plane(span, mesh, frames);
    }
  }
  const double amplitude = 2 * std::sqrt(std::max(0.0, 1 - line.share));
  const std::vector<std::function<double(double)>> angles = {
      [&](double x) { return amplitude * std::cos(pi * x); },
      [&](double x) { return amplitude * std::sin(2 * pi * x); },
      [&](double x) { return amplitude * std::cos(2 * pi * x); },
      [&](double x) { return 2 * pi * x; }};
  for (const auto& angle : angles) {
    for (const Eigen::Vector3d& axis : axes_of(span, along, motion)) {
      starts.push_back(straight);
      for (Eigen::Index i = 0; i < mesh.intervals(); ++i) {
        const double a = angle(middle_of(mesh, i) / span.length);
        starts.back()[static_cast<std::size_t>(i)] = from_rotation_vector(a * axis) * along;
      }
    }
  }
  return starts;
}

}  // namespace dlo::energy_model
