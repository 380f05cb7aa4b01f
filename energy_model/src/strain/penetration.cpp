#include "strain/penetration.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "dlo/energy_model/energy.hpp"

namespace dlo::energy_model {
namespace {

/// Points of the grid. Between two of them a shape of curvature k goes l^2 k / (8 grid^2) deeper,
/// 3e-8 l for k = 1/l.
constexpr Eigen::Index penetration_grid = 2001;
/// Change of the contact forces in the next round, over their stiffness, in lengths: what the
/// descent stops at is below 1e-9, and a round takes off a tenth or more.
constexpr double settled = 1e-7;

bool is_rigid(const Wall& wall) { return std::isinf(wall.stiffness); }

/// Largest depth behind a rigid wall [m].
double penetration(const Problem& problem, const Samples& shape) {
  double deepest = 0;
  for (const Wall& wall : problem.walls) {
    if (!is_rigid(wall)) continue;
    const Eigen::RowVectorXd height =
        wall.normal.normalized().transpose() * (shape.points.colwise() - wall.point);
    deepest = std::max(deepest, -height.minCoeff());
  }
  return deepest;
}

/// What the next round would change in the contact forces, in lengths.
double unsettled(const SpanSolution& span) {
  if (span.x.size() == 0 || !span.model->has_walls()) return 0;
  Eigen::VectorXd gradient(span.model->size());
  (void)span.model->value(span.x, gradient);
  return span.model->walls().violation();
}

}  // namespace

void judge_contact(const Problem& problem, const std::vector<const SpanSolution*>& spans,
                   Equilibrium& equilibrium) {
  if (std::none_of(problem.walls.begin(), problem.walls.end(), is_rigid)) return;
  const double l = problem.length;
  equilibrium.penetration =
      penetration(problem, equilibrium.sample(equal_arc_lengths(l, penetration_grid)));
  if (!succeeded(equilibrium.status)) return;
  double change = 0;
  for (const SpanSolution* span : spans) change = std::max(change, unsettled(*span));
  std::ostringstream why;
  why.precision(2);
  if (!(equilibrium.penetration <= allowed_penetration * l)) {
    why << "the shape is " << equilibrium.penetration << " m = " << equilibrium.penetration / l
        << " l behind a rigid wall (allowed: " << allowed_penetration << " l)";
  } else if (!(change <= settled)) {
    why << "the contact forces of the walls have not settled (" << change << " l)";
  } else {
    return;
  }
  equilibrium.status = SolveStatus::not_resolved;
  equilibrium.message = std::string(to_string(equilibrium.status)) + ": " + why.str();
}

}  // namespace dlo::energy_model
