#include "contact/penetration.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "dlo/energy_model/energy.hpp"

namespace dlo::energy_model {
namespace {

/// Points of the grid. Between two of them a shape of curvature k goes l^2 k / (8 grid^2) deeper,
/// 3e-8 l for k = 1/l.
constexpr Eigen::Index penetration_grid = 2001;

bool is_rigid(const Obstacle& obstacle) { return std::isinf(obstacle.stiffness); }

/// Largest depth behind a rigid obstacle [m].
double penetration(const Problem& problem, const Samples& shape) {
  double deepest = 0;
  for (const Obstacle& obstacle : problem.obstacles) {
    if (!is_rigid(obstacle)) continue;
    deepest = std::max(deepest, -obstacle.body.clearances(shape.points).minCoeff());
  }
  return deepest;
}

}  // namespace

void judge_penetration(const Problem& problem, Equilibrium& equilibrium) {
  if (std::none_of(problem.obstacles.begin(), problem.obstacles.end(), is_rigid)) return;
  const double l = problem.length;
  equilibrium.penetration =
      penetration(problem, equilibrium.sample(equal_arc_lengths(l, penetration_grid)));
  if (!succeeded(equilibrium.status)) return;
  if (equilibrium.penetration <= allowed_penetration * l) return;
  std::ostringstream why;
  why.precision(2);
  why << "the shape is " << equilibrium.penetration << " m = " << equilibrium.penetration / l
      << " l within a rigid obstacle (allowed: " << allowed_penetration << " l)";
  equilibrium.status = SolveStatus::not_resolved;
  equilibrium.message = std::string(to_string(equilibrium.status)) + ": " + why.str();
}

}  // namespace dlo::energy_model
