#include "contact/clearance.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "dlo/energy_model/problem.hpp"

namespace dlo::energy_model {
namespace {

constexpr Eigen::Index grid_points = 1001;
/// Newton's steps from the grid to a minimum; they stay between the neighbouring points.
constexpr int refinements = 6;

}  // namespace

Clearance clearance_at(const obstacle::Body& body, const SpanSamples& samples, Eigen::Index i) {
  const obstacle::Gap gap = body.gap(samples.points.col(i));
  const Eigen::Vector3d t = samples.tangents.col(i);
  return {gap.value, gap.gradient.dot(t),
          gap.gradient.dot(samples.curvature.col(i)) + t.dot(gap.hessian * t)};
}

std::vector<Lowest> lowest_points(const Span& span, const SpanShape& shape, double below) {
  const std::vector<double> s = equal_arc_lengths(span.length, grid_points);
  const SpanSamples grid = shape.sample(s);
  const double h = s[1];
  const double bent = grid.curvature.colwise().norm().maxCoeff();
  std::vector<Lowest> found;
  for (const Span::Obstacle& obstacle : span.rigid_obstacles) {
    // Between two points of the grid it may be lower by this.
    const double sag = h * h / 8 * (bent + 1 / obstacle.body.smallest_radius());
    const Eigen::VectorXd clearance = obstacle.body.clearances(grid.points);
    for (Eigen::Index i = 0; i < grid_points; ++i) {
      const bool falls_to = i == 0 || clearance[i] < clearance[i - 1];
      const bool rises_from = i + 1 == grid_points || clearance[i] <= clearance[i + 1];
      if (!falls_to || !rises_from || clearance[i] > below + 2 * sag) continue;
      const double low = s[static_cast<std::size_t>(std::max<Eigen::Index>(0, i - 1))];
      const double high = s[static_cast<std::size_t>(std::min(grid_points - 1, i + 1))];
      Lowest lowest{obstacle, s[static_cast<std::size_t>(i)], clearance[i]};
      double at = lowest.s;
      for (int k = 0; k < refinements; ++k) {
        const Clearance here = clearance_at(obstacle.body, shape.sample(std::array{at}), 0);
        if (here.value < lowest.clearance) lowest = {obstacle, at, here.value};
        if (!(here.rate > 0)) break;
        at = std::clamp(at - here.slope / here.rate, low, high);
      }
      if (!(lowest.clearance < below)) continue;
      lowest.feature = obstacle.body.feature(shape.sample(std::array{lowest.s}).points.col(0));
      found.push_back(lowest);
    }
  }
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.s < b.s; });
  return found;
}

}  // namespace dlo::energy_model
