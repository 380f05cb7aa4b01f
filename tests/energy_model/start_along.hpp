#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "dlo/energy_model/equilibrium.hpp"

namespace dlo::test {

/// Returns an initial guess of unit length along a line from corner to corner.
inline energy_model::Equilibrium start_along(const std::vector<Eigen::Vector3d>& corners) {
  std::vector<double> at = {0};
  for (std::size_t i = 1; i < corners.size(); ++i) {
    at.push_back(at.back() + (corners[i] - corners[i - 1]).norm());
  }
  energy_model::Equilibrium shape;
  shape.status = energy_model::SolveStatus::converged;
  shape.sample = [corners, at](std::span<const double> s) {
    energy_model::Samples samples;
    samples.arc_length.assign(s.begin(), s.end());
    const auto count = static_cast<Eigen::Index>(s.size());
    samples.points.resize(3, count);
    samples.tangents.resize(3, count);
    samples.curvature.setZero(3, count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const double way = s[static_cast<std::size_t>(i)] * at.back();
      std::size_t k = 1;
      while (k + 1 < at.size() && at[k] < way) ++k;
      samples.tangents.col(i) = (corners[k] - corners[k - 1]).normalized();
      samples.points.col(i) = corners[k - 1] + (way - at[k - 1]) * samples.tangents.col(i);
    }
    return samples;
  };
  return shape;
}

}  // namespace dlo::test
