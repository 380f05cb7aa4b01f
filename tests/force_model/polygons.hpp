#pragma once

#include <Eigen/Geometry>
#include <random>

#include "../differences.hpp"
#include "../helpers.hpp"

namespace dlo::test {

/// Returns the points of a random walk in space with moderate angles between its segments, whose
/// lengths are `length` times 1 - length_spread to 1 + length_spread.
inline Eigen::Matrix3Xd random_polygon(unsigned seed, Eigen::Index segments, double length,
                                       double length_spread) {
  std::mt19937 engine(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(-1, 1);
  Eigen::Matrix3Xd points(3, segments + 1);
  points.col(0).setZero();
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();
  for (Eigen::Index i = 0; i < segments; ++i) {
    const Eigen::Vector3d perturbation(normal(engine), normal(engine), normal(engine));
    direction = (direction + 0.5 * perturbation).normalized();
    points.col(i + 1) = points.col(i) + length * (1 + length_spread * uniform(engine)) * direction;
  }
  return points;
}

inline Eigen::Vector3d net_torque(const Eigen::Matrix3Xd& points, const Eigen::Matrix3Xd& forces) {
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const Eigen::Vector3d arm = points.col(i);
    torque += arm.cross(Eigen::Vector3d(forces.col(i)));
  }
  return torque;
}

/// Returns minus the central differences of an energy by the points, with steps of h: its forces.
template <typename Energy>
Eigen::Matrix3Xd difference_forces(const Energy& energy, const Eigen::Matrix3Xd& points, double h) {
  return -difference_gradient(energy, points, h);
}

}  // namespace dlo::test
