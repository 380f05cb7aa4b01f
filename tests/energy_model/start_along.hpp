#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "../helpers.hpp"
#include "dlo/energy_model/equilibrium.hpp"
#include "problems.hpp"

namespace dlo::test {

/// Returns an initial guess for a rod of unit length along a line from corner to corner. Arc
/// lengths from 0 to 1 are scaled to the length of the line.
inline energy_model::Equilibrium start_along_polyline(const std::vector<Eigen::Vector3d>& corners) {
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

/// Returns a weightless rod whose end is drawn down beyond a peg below it.
/// @param aside  part of the load along the peg's axis, over that along -y
inline energy_model::Problem rod_pulled_over_peg(double radius, double tension, double aside = 0) {
  energy_model::Problem problem = heavy_cantilever(0, 0);
  problem.loads = {{1, tension * Eigen::Vector3d(0, -1, aside).normalized()}};
  problem.obstacles = {{obstacle::Body::cylinder({0.4, -radius, 0}, {0, 0, 1}, radius)}};
  return problem;
}

/// Returns an initial guess for rod_pulled_over_peg() that passes over the peg.
inline energy_model::Equilibrium start_over_peg(double radius) {
  return start_along_polyline({{0, 0, 0}, {0.4 + radius, 0, 0}, {0.4 + radius, radius - 0.6, 0}});
}

}  // namespace dlo::test
