#include "contact/penetration.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <sstream>
#include <utility>
#include <vector>

#include "contact/clearance.hpp"
#include "dlo/energy_model/energy.hpp"

namespace dlo::energy_model {
namespace {

/// Number of grid points. Between two of them a shape of curvature k penetrates l^2 k / (8 grid^2)
/// deeper, 3e-8 l for k = 1/l.
constexpr Eigen::Index penetration_grid = 2001;

bool is_rigid(const Obstacle& obstacle) { return std::isinf(obstacle.stiffness); }

/// Returns the largest depth of a shape within a body [m]. A body of small radius may lie between
/// grid points; where the shape may be deeper there, it is sampled again 16 times as densely.
double depth_within(const obstacle::Body& body, const Equilibrium& shape, std::vector<double> s,
                    double h, const Samples& grid, double enough) {
  constexpr int closer = 16;
  constexpr int most_levels = 4;
  Eigen::VectorXd clearance = body.clearances(grid.points);
  double deepest = -clearance.minCoeff();
  const double length = s.back();
  for (int level = 0; level < most_levels; ++level) {
    const double sag = h * h / (8 * body.smallest_radius());
    if (!(sag > enough)) break;
    std::vector<double> between;
    for (std::size_t i = 0; i < s.size(); ++i) {
      const double here = clearance[static_cast<Eigen::Index>(i)];
      if (here - sag > -std::max(deepest, enough)) continue;
      for (int k = 1 - closer; k < closer; ++k) {
        const double at = s[i] + h * k / closer;
        if (k != 0 && at >= 0 && at <= length) between.push_back(at);
      }
    }
    if (between.empty()) break;
    std::sort(between.begin(), between.end());
    s = std::move(between);
    clearance = body.clearances(shape.sample(s).points);
    deepest = std::max(deepest, -clearance.minCoeff());
    h /= closer;
  }
  return deepest;
}

/// Returns the grid points that may be within a rigid obstacle or adjacent to an unsampled part
/// within one, and the ends.
std::vector<double> near_obstacles(const Problem& problem, const Equilibrium& shape) {
  constexpr std::size_t stride = 40;
  const std::vector<double> s = equal_arc_lengths(problem.length, penetration_grid);
  // Half a coarse interval, plus what may lie between two points.
  const double most = (static_cast<double>(stride) / 2 + 2) * s[1];
  const auto clearances = [&](const std::vector<double>& coarse) {
    const Samples samples = shape.sample(coarse);
    Eigen::VectorXd least = Eigen::VectorXd::Constant(samples.points.cols(), INFINITY);
    for (const Obstacle& obstacle : problem.obstacles) {
      if (is_rigid(obstacle)) least = least.cwiseMin(obstacle.body.clearances(samples.points));
    }
    return least;
  };
  std::vector<double> near = {s.front()};
  for (const std::size_t i : near_points(s, stride, most, clearances)) {
    if (i > 0) near.push_back(s[i]);
  }
  if (near.back() < s.back()) near.push_back(s.back());
  return near;
}

/// Returns the largest depth within a rigid obstacle [m], and that obstacle.
Penetration penetration(const Problem& problem, const Equilibrium& shape) {
  const double h = problem.length / (penetration_grid - 1);
  const std::vector<double> s = near_obstacles(problem, shape);
  const Samples grid = shape.sample(s);
  Penetration deepest;
  for (std::size_t i = 0; i < problem.obstacles.size(); ++i) {
    const Obstacle& obstacle = problem.obstacles[i];
    if (!is_rigid(obstacle)) continue;
    const double depth =
        depth_within(obstacle.body, shape, s, h, grid, allowed_penetration * problem.length);
    if (depth > deepest.depth) deepest = {depth, i};
  }
  return deepest;
}

}  // namespace

Penetration judge_penetration(const Problem& problem, Equilibrium& equilibrium) {
  if (std::none_of(problem.obstacles.begin(), problem.obstacles.end(), is_rigid)) return {};
  const double l = problem.length;
  const Penetration deepest = penetration(problem, equilibrium);
  equilibrium.penetration = deepest.depth;
  if (!succeeded(equilibrium.status)) return deepest;
  if (equilibrium.penetration <= allowed_penetration * l) return deepest;
  std::ostringstream why;
  why.precision(2);
  why << "the shape penetrates a rigid obstacle by " << equilibrium.penetration
      << " m = " << equilibrium.penetration / l << " l (allowed: at most " << allowed_penetration
      << " l)";
  equilibrium.status = SolveStatus::not_verified;
  equilibrium.message = std::string(to_string(equilibrium.status)) + ": " + why.str();
  return deepest;
}

}  // namespace dlo::energy_model
