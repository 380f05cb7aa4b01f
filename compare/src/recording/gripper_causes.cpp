#include "recording/gripper_causes.hpp"

#include <fmt/format.h>

#include <Eigen/QR>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

#include "dlo/compare/error.hpp"

namespace dlo::compare {
namespace {

/// Displacement of a gripper for differences, divided by the length: far above the energy model's
/// error of 1e-9, and too small to change how the rod bends.
constexpr double displacement_share = 1e-3;

Scene displaced(Scene scene, std::size_t gripper, const Eigen::Vector3d& by) {
  Gripper& moved = scene.grippers[gripper];
  moved.position += by;
  std::vector<Pose> poses = moved.trajectory.poses();
  for (Pose& pose : poses) pose.position += by;
  if (!poses.empty()) moved.trajectory = Trajectory(std::move(poses));
  return scene;
}

/// Returns the residuals of a scene's rod at rest [m].
Eigen::Matrix3Xd residuals_at_rest(const Scene& scene, const TrackOptions& options,
                                   const MarkerMotion& recorded) {
  const Track moved = track(scene, options);
  if (moved.stopped) throw ConvergenceError(moved.stopped->why);
  std::vector<Eigen::Matrix3Xd> frames;
  frames.reserve(moved.frames.size());
  for (const TrackFrame& frame : moved.frames) frames.push_back(frame.shape.points);
  const ModelMotion model(*options.from, *options.to, scene.length, std::move(frames));
  return motion_residuals(recorded, model);
}

/// Returns the derivatives of the model's coordinates at all recorded positions by the position of
/// a gripper, by differences [-]: three rows for each recorded position, three columns.
/// @param here  residuals at the scene's position of the gripper
Eigen::MatrixX3d sensitivity(const Scene& scene, const TrackOptions& options,
                             const MarkerMotion& recorded, std::size_t gripper,
                             const Eigen::Matrix3Xd& here) {
  const double by = displacement_share * scene.length;
  Eigen::MatrixX3d result(here.size(), 3);
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Matrix3Xd there = residuals_at_rest(
        displaced(scene, gripper, by * Eigen::Vector3d::Unit(axis)), options, recorded);
    result.col(axis) = (here - there).reshaped() / by;
  }
  return result;
}

MotionCause constant_cause(std::size_t gripper, const Eigen::MatrixX3d& design,
                           const Eigen::VectorXd& residuals) {
  const Eigen::Vector3d by = design.colPivHouseholderQr().solve(residuals);
  const double residual_norm = (residuals - design * by).norm();
  return {MotionCause::Kind::gripper,
          fmt::format("gripper {} is displaced by [{:.3g}, {:.3g}, {:.3g}] mm", gripper + 1,
                      by.x() * 1e3, by.y() * 1e3, by.z() * 1e3),
          residual_norm / std::sqrt(static_cast<double>(residuals.size()) / 3)};
}

/// Returns the cause that a gripper has another displacement in each frame; std::nullopt if frames
/// have too few points.
std::optional<MotionCause> path_cause(std::size_t gripper, const Eigen::MatrixX3d& design,
                                      const Eigen::VectorXd& residuals,
                                      const MarkerMotion& recorded) {
  double squares = 0;
  double moved = 0;
  Eigen::Index frames = 0;
  for (std::size_t begin = 0; begin < recorded.positions.size();) {
    std::size_t end = begin;
    while (end < recorded.positions.size() &&
           recorded.positions[end].time == recorded.positions[begin].time) {
      ++end;
    }
    const auto first = static_cast<Eigen::Index>(3 * begin);
    const auto rows = static_cast<Eigen::Index>(3 * (end - begin));
    const Eigen::MatrixX3d of_frame = design.middleRows(first, rows);
    const Eigen::VectorXd there = residuals.segment(first, rows);
    const Eigen::Vector3d by = of_frame.colPivHouseholderQr().solve(there);
    squares += (there - of_frame * by).squaredNorm();
    moved += by.squaredNorm();
    ++frames;
    begin = end;
  }
  const Eigen::Index freedom = residuals.size() - 3 * frames;
  if (freedom < 3 * frames) return std::nullopt;
  return MotionCause{MotionCause::Kind::gripper_path,
                     fmt::format("gripper {} has another path, {:.3g} mm away (RMS)", gripper + 1,
                                 std::sqrt(moved / static_cast<double>(frames)) * 1e3),
                     std::sqrt(3 * squares / static_cast<double>(freedom))};
}

}  // namespace

std::vector<MotionCause> gripper_causes(const Scene& scene, const TrackOptions& options,
                                        const MarkerMotion& recorded, const ModelMotion& at_rest,
                                        const Eigen::Matrix3Xd& residuals) {
  std::vector<MotionCause> result;
  const Eigen::Matrix3Xd here = motion_residuals(recorded, at_rest);
  const Eigen::VectorXd all = residuals.reshaped();
  for (std::size_t gripper = 0; gripper < scene.grippers.size(); ++gripper) {
    try {
      const Eigen::MatrixX3d design = sensitivity(scene, options, recorded, gripper, here);
      result.push_back(constant_cause(gripper, design, all));
      if (auto path = path_cause(gripper, design, all, recorded)) result.push_back(*path);
    } catch (const ResultError&) {
      continue;  // such as a displacement that pulls the rod taut
    }
  }
  return result;
}

}  // namespace dlo::compare
