#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <span>
#include <stdexcept>
#include <vector>

#include "../helpers.hpp"
#include "dlo/energy_model/equilibrium.hpp"
#include "dlo/energy_model/status.hpp"
#include "problems.hpp"

namespace dlo::test {

/// Returns a solver's result, which must have converged: otherwise its message ends the test.
template <typename Result>
[[nodiscard]] Result converged(Result result) {
  EXPECT_EQ(result.status, energy_model::SolveStatus::converged) << result.message;
  if (result.status != energy_model::SolveStatus::converged) {
    throw std::runtime_error("not converged: " + result.message);
  }
  return result;
}

/// Returns a solver's result whose shape is usable: otherwise its message ends the test.
template <typename Result>
[[nodiscard]] Result require_usable(Result result) {
  if (!succeeded(result.status)) throw std::runtime_error("no shape: " + result.message);
  return result;
}

/// Samples a shape, such as an equilibrium or a frame of a motion, at one arc length [m].
template <typename Shape>
auto sample_at(const Shape& shape, double s) {
  return shape.sample(std::span<const double>(&s, 1));
}

template <typename Shape>
Eigen::Vector3d point_at(const Shape& shape, double s) {
  return sample_at(shape, s).points.col(0);
}

/// Returns the largest distance of two shapes' points at the same arc lengths [m].
/// @param s  arc lengths [m]; default: 41 of a rod of unit length
template <typename A, typename B>
double largest_point_distance(const A& a, const B& b,
                              const std::vector<double>& s = energy_model::equal_arc_lengths(1,
                                                                                             41)) {
  return (a.sample(s).points - b.sample(s).points).colwise().norm().maxCoeff();
}

/// Returns a director at a sample, carried to the next sample without twist by double reflection
/// (Wang, Juettler, Zheng and Liu 2008), which is right to the fourth power of the step.
inline Eigen::Vector3d carried(const energy_model::Samples& samples, Eigen::Index i,
                               const Eigen::Vector3d& director) {
  const auto reflected = [](const Eigen::Vector3d& x, const Eigen::Vector3d& normal) {
    return Eigen::Vector3d(x - 2 * x.dot(normal) / normal.squaredNorm() * normal);
  };
  const Eigen::Vector3d chord = samples.points.col(i + 1) - samples.points.col(i);
  const Eigen::Vector3d t = reflected(samples.tangents.col(i), chord);
  return reflected(reflected(director, chord), samples.tangents.col(i + 1) - t);
}

}  // namespace dlo::test
