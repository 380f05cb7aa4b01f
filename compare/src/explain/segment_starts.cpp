#include "explain/segment_starts.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

namespace dlo::compare {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

/// Lengths of a chain's segments are the model's to this share.
constexpr double like_the_model = 0.02;

bool are_starts(const Eigen::Matrix3Xd& points, double segment) {
  const Index n = points.cols() - 1;
  const Eigen::VectorXd h = (points.rightCols(n) - points.leftCols(n)).colwise().norm();
  return (h.array() - segment).abs().maxCoeff() <= like_the_model * segment;
}

/// The end of a last segment that a gripper holds.
std::optional<Vector3d> held_end(const Scene& scene, const Vector3d& last, double segment) {
  for (const Gripper& gripper : scene.grippers) {
    const bool at_end = std::abs(gripper.at - scene.length) < 1e-6 * scene.length;
    const double way = (gripper.position - last).norm();
    if (at_end && std::abs(way - segment) <= like_the_model * segment) return gripper.position;
  }
  return std::nullopt;
}

Vector3d free_end(const Eigen::Matrix3Xd& points, double segment) {
  const Index n = points.cols();
  const Vector3d before = points.col(n - 2) - points.col(n - 3);
  const Vector3d last = points.col(n - 1) - points.col(n - 2);
  Eigen::AngleAxisd turn(Eigen::Quaterniond::FromTwoVectors(before, last));
  constexpr double moment_ratio = 0.25;
  turn.angle() *= moment_ratio;
  return points.col(n - 1) + turn * (segment * last.normalized());
}

}  // namespace

MeasuredShape whole_of_segment_starts(const Scene& scene, const MeasuredShape& shape) {
  if (!scene.model || scene.model->segments < 3 || !shape.arc_length.empty()) return shape;
  const ModelChain& model = *scene.model;
  const Index n = model.segments;
  const double segment = scene.length / static_cast<double>(n);
  MeasuredShape whole = shape;
  if (shape.points.cols() == model.bodies && model.bodies > n) {
    const Eigen::Matrix3Xd chain = shape.points.middleCols(model.first_body, n);
    // A chain with its end may have as many points as the model bodies.
    if (are_starts(shape.points, segment) || !are_starts(chain, segment)) return shape;
    whole.points = chain;
    whole.notes.push_back(fmt::format("of all {} bodies those of the cable are taken, {} to {}",
                                      model.bodies, model.first_body, model.first_body + n - 1));
  }
  if (whole.points.cols() != n || !are_starts(whole.points, segment)) return shape;
  const Vector3d last = whole.points.col(n - 1);
  const std::optional<Vector3d> held = held_end(scene, last, segment);
  const Vector3d end = held ? *held : free_end(whole.points, segment);
  whole.points.conservativeResize(Eigen::NoChange, n + 1);
  whole.points.col(n) = end;
  whole.d1.resize(3, 0);
  whole.notes.push_back(fmt::format(
      "its {} points are where the segments begin; the end of the last one is appended, "
      "{}",
      n, held ? "where a gripper holds it" : "extrapolated"));
  return whole;
}

}  // namespace dlo::compare
