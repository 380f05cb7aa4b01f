#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <numbers>
#include <vector>

#include "../../helpers.hpp"
#include "../rolled_chain.hpp"

namespace dlo::test {

/// Returns the points at rest of a hinged chain for a rod of 0.5 kg/m whose clamp points 20 degrees
/// up. The springs are EI/h and linear in the angle.
/// @param lengths    of the segments [m]
/// @param h          length of rod that one spring represents [m]
/// @param stiffness  EI [N m^2]
/// @param welded     whether the clamp holds the first segment; else it holds a hinge

inline Eigen::Matrix3Xd hinged_chain(const std::vector<double>& lengths, double h, double stiffness,
                                     bool welded) {
  constexpr double weight = 0.5 * 9.81;  // per length [N/m]
  const Eigen::Rotation2Dd direction(20 * std::numbers::pi / 180);
  // A hinge at the clamp is modelled as a joint behind a clamped segment of length zero.
  const Eigen::Index before = welded ? 0 : 1;
  const auto n = static_cast<Eigen::Index>(lengths.size());
  Eigen::VectorXd segments = Eigen::VectorXd::Zero(before + n);
  segments.tail(n) = Eigen::Map<const Eigen::VectorXd>(lengths.data(), n);
  Eigen::Matrix2Xd forces = Eigen::Matrix2Xd::Zero(2, before + n + 1);
  forces.row(1).head(before + n) -= weight / 2 * segments.transpose();
  forces.row(1).tail(before + n) -= weight / 2 * segments.transpose();

  const Eigen::VectorXd springs = Eigen::VectorXd::Constant(before + n - 1, stiffness / h);
  Eigen::Matrix3Xd points =
      chain_at_rest(segments, springs, direction.inverse().toRotationMatrix() * forces,
                    linear_moment)
          .rightCols(n + 1);
  points.topRows<2>() = (direction.toRotationMatrix() * points.topRows<2>()).eval();
  return points;
}

}  // namespace dlo::test
