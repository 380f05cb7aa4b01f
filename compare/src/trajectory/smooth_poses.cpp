#include <fmt/format.h>

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "trajectory/read_trajectory.hpp"

namespace dlo::compare {
namespace {

using SparseMatrix = Eigen::SparseMatrix<double>;

/// Returns the time that each pose represents [s].
Eigen::VectorXd time_shares(const std::vector<Pose>& poses) {
  const auto count = static_cast<Eigen::Index>(poses.size());
  Eigen::VectorXd shares = Eigen::VectorXd::Zero(count);
  for (Eigen::Index k = 0; k + 1 < count; ++k) {
    const auto i = static_cast<std::size_t>(k);
    const double half = (poses[i + 1].time - poses[i].time) / 2;
    shares[k] += half;
    shares[k + 1] += half;
  }
  return shares;
}

/// Returns the operator of second derivatives at all poses except the first and the last.
SparseMatrix second_differences(const std::vector<Pose>& poses) {
  const auto count = static_cast<Eigen::Index>(poses.size());
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(3 * poses.size());
  for (Eigen::Index k = 0; k + 2 < count; ++k) {
    const auto i = static_cast<std::size_t>(k);
    const double before = poses[i + 1].time - poses[i].time;
    const double after = poses[i + 2].time - poses[i + 1].time;
    const double scale = 2 / (before + after);
    entries.emplace_back(k, k, scale / before);
    entries.emplace_back(k, k + 1, -scale / before - scale / after);
    entries.emplace_back(k, k + 2, scale / after);
  }
  SparseMatrix result(count - 2, count);
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}

/// Returns positions, directions and rolls, one pose per row.
Eigen::MatrixXd values_of(const std::vector<Pose>& poses) {
  Eigen::MatrixXd values = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(poses.size()), 7);
  for (Eigen::Index k = 0; k < values.rows(); ++k) {
    const Pose& pose = poses[static_cast<std::size_t>(k)];
    values.row(k).head<3>() = pose.position;
    if (pose.direction) values.row(k).segment<3>(3) = *pose.direction;
    values(k, 6) = pose.roll.value_or(0);
  }
  return values;
}

}  // namespace

std::vector<Pose> smooth_poses(std::vector<Pose> poses, double cutoff) {
  constexpr std::size_t least_count = 3;
  const double duration = poses.empty() ? 0 : poses.back().time - poses.front().time;
  const double step = duration / static_cast<double>(std::max(least_count, poses.size()) - 1);
  if (poses.size() < least_count || !(cutoff > 0) || !(2 * cutoff * step < 1)) {
    throw std::invalid_argument(
        fmt::format("smooth_poses: cutoff = {:g} Hz of {} poses (allowed: three or more poses, > 0 "
                    "and below half of their rate, {:g} Hz)",
                    cutoff, poses.size(), duration > 0 ? 0.5 / step : 0));
  }
  const double at_cutoff = 4 * std::pow(std::sin(std::numbers::pi * cutoff * step), 2);
  const double lambda = (std::numbers::sqrt2 - 1) * std::pow(step * step / at_cutoff, 2);
  const Eigen::VectorXd shares = time_shares(poses);
  const SparseMatrix second = second_differences(poses);
  SparseMatrix system =
      lambda *
      SparseMatrix(second.transpose() * shares.segment(1, second.rows()).asDiagonal() * second);
  system.diagonal() += shares;
  const Eigen::SimplicialLDLT<SparseMatrix> solver(system);
  const Eigen::MatrixXd values = solver.solve(shares.asDiagonal() * values_of(poses));
  for (Eigen::Index k = 0; k < values.rows(); ++k) {
    Pose& pose = poses[static_cast<std::size_t>(k)];
    pose.position = values.row(k).head<3>();
    if (pose.roll) pose.roll = values(k, 6);
    if (!pose.direction) continue;
    const Eigen::Vector3d direction = values.row(k).segment<3>(3);
    if (!(direction.norm() > 0)) {
      throw std::invalid_argument("smooth_poses: no direction is left (allowed: a higher cutoff)");
    }
    pose.direction = direction.normalized();
  }
  return poses;
}

}  // namespace dlo::compare
