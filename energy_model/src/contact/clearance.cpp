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

std::vector<Lowest> lowest_points(const Span& span, const SpanShape& shape, double below) {
  const std::vector<double> s = equal_arc_lengths(span.length, grid_points);
  const SpanSamples grid = shape.sample(s);
  const double h = s[1];
  // Between two points of the grid it may be lower by this.
  const double sag = h * h / 8 * grid.curvature.colwise().norm().maxCoeff();
  std::vector<Lowest> found;
  for (const Span::Wall& wall : span.rigid_walls) {
    const Eigen::Vector3d& normal = wall.normal;
    const Eigen::VectorXd clearance =
        (normal.transpose() * grid.points).transpose().array() + wall.offset;
    for (Eigen::Index i = 0; i < grid_points; ++i) {
      const bool falls_to = i == 0 || clearance[i] < clearance[i - 1];
      const bool rises_from = i + 1 == grid_points || clearance[i] <= clearance[i + 1];
      if (!falls_to || !rises_from || clearance[i] > below + 2 * sag) continue;
      const double low = s[static_cast<std::size_t>(std::max<Eigen::Index>(0, i - 1))];
      const double high = s[static_cast<std::size_t>(std::min(grid_points - 1, i + 1))];
      Lowest lowest{wall, s[static_cast<std::size_t>(i)], clearance[i]};
      double at = lowest.s;
      for (int k = 0; k < refinements; ++k) {
        const SpanSamples here = shape.sample(std::array{at});
        const double value = wall.clearance(here.points.col(0));
        const double slope = normal.dot(here.tangents.col(0));
        if (value < lowest.clearance) lowest = {wall, at, value};
        const double rate = normal.dot(here.curvature.col(0));
        if (!(rate > 0)) break;
        at = std::clamp(at - slope / rate, low, high);
      }
      if (lowest.clearance < below) found.push_back(lowest);
    }
  }
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.s < b.s; });
  return found;
}

}  // namespace dlo::energy_model
