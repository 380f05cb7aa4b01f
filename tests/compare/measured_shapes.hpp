#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "../helpers.hpp"
#include "dlo/compare/alignment.hpp"
#include "dlo/compare/material_fit.hpp"
#include "dlo/compare/reference.hpp"
#include "dlo/compare/shape_file.hpp"
#include "dlo/compare/solution.hpp"

namespace dlo::test {

/// Returns `count` uneven arc lengths on a rod [m] in ascending order, no two closer than 2 % of
/// its length.
inline std::vector<double> uneven_arc_lengths(std::mt19937& random, int count, double length) {
  std::uniform_real_distribution<double> anywhere(0, length);
  std::vector<double> s;
  while (static_cast<int>(s.size()) < count) {
    const double next = anywhere(random);
    const bool apart = std::none_of(
        s.begin(), s.end(), [&](double other) { return std::abs(next - other) < 0.02 * length; });
    if (apart) s.push_back(next);
  }
  std::sort(s.begin(), s.end());
  return s;
}

/// Returns a uniformly distributed random rotation and a translation of about a metre.
inline compare::RigidMotion random_pose(std::mt19937& random) {
  std::normal_distribution<double> normal;
  const Eigen::Quaterniond turn(normal(random), normal(random), normal(random), normal(random));
  return {turn.normalized().toRotationMatrix(),
          Eigen::Vector3d(normal(random), normal(random), normal(random))};
}

inline Eigen::Matrix3Xd with_noise(Eigen::Matrix3Xd points, double sigma, std::mt19937& random) {
  std::normal_distribution<double> normal(0, sigma);
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    for (Eigen::Index k = 0; k < 3; ++k) points(k, i) += normal(random);
  }
  return points;
}

/// Returns noise of standard deviation `sigma` per coordinate that is correlated over the arc
/// length `length` [m]: a first-order autoregression.
inline Eigen::Matrix3Xd correlated_noise(const std::vector<double>& s, double sigma, double length,
                                         std::mt19937& random) {
  std::normal_distribution<double> normal(0, sigma);
  Eigen::Matrix3Xd noise(3, static_cast<Eigen::Index>(s.size()));
  for (Eigen::Index k = 0; k < 3; ++k) {
    noise(k, 0) = normal(random);
    for (Eigen::Index i = 1; i < noise.cols(); ++i) {
      const auto at = static_cast<std::size_t>(i);
      const double kept = std::exp(-(s[at] - s[at - 1]) / length);
      noise(k, i) = kept * noise(k, i - 1) + std::sqrt(1 - kept * kept) * normal(random);
    }
  }
  return noise;
}

/// Whether an interval contains the true value; a missing bound is infinite.
inline bool interval_contains(const compare::FittedValue& value, double truth) {
  return (!value.low || *value.low <= truth) && (!value.high || *value.high >= truth);
}

inline compare::MeasuredShape reversed(const compare::MeasuredShape& shape) {
  compare::MeasuredShape result{shape.file, shape.points.rowwise().reverse(), shape.arc_length};
  std::reverse(result.arc_length.begin(), result.arc_length.end());
  return result;
}

/// Returns the exact shape of a scene at these arc lengths, which the result does not contain.
inline compare::MeasuredShape exact_shape(const compare::Scene& scene,
                                          const std::vector<double>& s) {
  const energy_model::Equilibrium exact = compare::solve_reference(scene, compare::Model::exact);
  return {"exact", exact.sample(s).points, {}};
}

/// Returns the energy model's shape of a scene with these arc lengths.
inline compare::MeasuredShape energy_model_shape(const compare::Scene& scene,
                                                 const std::vector<double>& s) {
  return {"seen", compare::solve_reference(scene, compare::Model::energy).sample(s).points, s};
}

}  // namespace dlo::test
