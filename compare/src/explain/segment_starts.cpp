#include "explain/segment_starts.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "shape/curve.hpp"

namespace dlo::compare {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

/// Largest relative difference between the segments of a chain and those of the model.
constexpr double segment_length_tolerance = 0.02;

bool are_segment_starts(const Eigen::Matrix3Xd& points, double segment) {
  return (chord_lengths(points).array() - segment).abs().maxCoeff() <=
         segment_length_tolerance * segment;
}

/// Returns the position of the gripper at the rod's end if it is one segment away from `last`; else
/// std::nullopt.
std::optional<Vector3d> gripped_end(const Scene& scene, const Vector3d& last, double segment) {
  for (const Gripper& gripper : scene.grippers) {
    const bool at_end = std::abs(gripper.at - scene.length) < 1e-6 * scene.length;
    const double distance = (gripper.position - last).norm();
    if (at_end && std::abs(distance - segment) <= segment_length_tolerance * segment)
      return gripper.position;
  }
  return std::nullopt;
}

Vector3d extrapolated_end(const Eigen::Matrix3Xd& points, double segment) {
  const Index n = points.cols();
  const Vector3d before = points.col(n - 2) - points.col(n - 3);
  const Vector3d last = points.col(n - 1) - points.col(n - 2);
  Eigen::AngleAxisd turn(Eigen::Quaterniond::FromTwoVectors(before, last));
  constexpr double moment_ratio = 0.25;
  turn.angle() *= moment_ratio;
  return points.col(n - 1) + turn * (segment * last.normalized());
}

/// Returns the number of grippers that hold an end of the rod, and the number of those that hold it
/// at `point`.
std::pair<int, int> count_end_grippers(const Scene& scene, const Vector3d& point, double segment) {
  std::pair<int, int> count;
  for (const Gripper& gripper : scene.grippers) {
    if (std::min(gripper.at, scene.length - gripper.at) > 1e-6 * scene.length) continue;
    ++count.first;
    if ((gripper.position - point).norm() <= segment_length_tolerance * segment) ++count.second;
  }
  return count;
}

/// Returns the shape with the end of its last segment added, and without directors.
MeasuredShape with_last_segment_end(const Scene& scene, MeasuredShape shape, double segment) {
  const Index n = shape.points.cols();
  const Vector3d last = shape.points.col(n - 1);
  const std::optional<Vector3d> end_position = gripped_end(scene, last, segment);
  const Vector3d end = end_position ? *end_position : extrapolated_end(shape.points, segment);
  shape.points.conservativeResize(Eigen::NoChange, n + 1);
  shape.points.col(n) = end;
  shape.d1.resize(3, 0);
  shape.notes.push_back(
      fmt::format("its {} points are the start points of the segments; the end of the last segment "
                  "is appended, {}",
                  n, end_position ? "where a gripper holds it" : "extrapolated"));
  return shape;
}

/// Returns the bodies of the cable if the shape has all bodies of the model; otherwise the shape.
MeasuredShape cable_points(const ModelChain& model, const MeasuredShape& shape, double segment) {
  if (shape.points.cols() != model.bodies || model.bodies <= model.segments) return shape;
  const Eigen::Matrix3Xd chain = shape.points.middleCols(model.first_body, model.segments);
  // A chain with its end may have as many points as the model has bodies.
  if (are_segment_starts(shape.points, segment) || !are_segment_starts(chain, segment))
    return shape;
  MeasuredShape cable = shape;
  cable.points = chain;
  cable.notes.push_back(fmt::format("of all {} bodies only those of the cable are used, {} to {}",
                                    model.bodies, model.first_body,
                                    model.first_body + model.segments - 1));
  return cable;
}

}  // namespace

MeasuredShape complete_segment_starts(const Scene& scene, const MeasuredShape& shape,
                                      PoseFreedom pose) {
  if (!shape.arc_length.empty()) return shape;
  if (scene.model) {
    const double segment = scene.length / static_cast<double>(scene.model->segments);
    const MeasuredShape cable = cable_points(*scene.model, shape, segment);
    const bool has_all = cable.points.cols() == scene.model->segments;
    if (has_all && cable.points.cols() > 2 && are_segment_starts(cable.points, segment)) {
      return with_last_segment_end(scene, cable, segment);
    }
    return shape;
  }
  const Index n = shape.points.cols();
  const double segment = scene.length / static_cast<double>(n);
  // With many points, those of a whole rod have nearly the same distances.
  const bool lacks_end = n > 3 && lacks_one_segment(shape.points, scene.length);
  if (pose != PoseFreedom::known || !lacks_end || !are_segment_starts(shape.points, segment))
    return shape;
  const Vector3d last = shape.points.rightCols<1>();
  const auto [ends, begins] = count_end_grippers(scene, shape.points.leftCols<1>(), segment);
  if (begins == 0 || count_end_grippers(scene, last, segment).second > 0) return shape;
  return ends == 1 || gripped_end(scene, last, segment)
             ? with_last_segment_end(scene, shape, segment)
             : shape;
}

}  // namespace dlo::compare
