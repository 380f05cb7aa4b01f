#include "span/plain_cantilever.hpp"

#include <cmath>
#include <memory>
#include <utility>

#include "span/refinement.hpp"
#include "span/span_starts.hpp"

namespace dlo::energy_model {
namespace {

/// Sum of weight and loads [EI/l^2] above which a rod is closer to its soft limit than to the
/// straight rod.
constexpr double soft_load = 12;

/// Whether all tangents of a plain cantilever that is pulled in one direction lie between the
/// clamp's direction and the load's, on the shorter way. An equilibrium with this property is the
/// lowest one. With the angle chi from the load's opposite and the force n(s) of everything beyond
/// s,
///     chi'' = -n sin(chi),  chi(0) given,  chi'(length) = 0,
/// the energy's minimum has chi in [0, pi], as reflecting values outside does not raise the energy.
/// There is only one such solution, because sin(chi) / chi decreases (Brezis and Oswald, 1986). A
/// second one, chi = 0, exists only if the clamp points against the load; it is unstable unless it
/// is the only one.
bool turns_to_load(const Span& span, const Eigen::Matrix3Xd& tangents) {
  constexpr double rounding = 1e-9;  // sine of the angle error by truncation
  Eigen::Vector3d force = span.weight_between(0, span.length);
  for (const Span::Load& load : span.loads) force += load.force;
  const Eigen::Vector3d across(-force.y(), force.x(), 0);
  const double side = std::copysign(1.0, across.dot(*span.start_direction));
  for (Eigen::Index q = 0; q < tangents.cols(); ++q) {
    if (side * across.dot(tangents.col(q)) < -rounding * force.norm()) return false;
  }
  return true;
}

/// Bends the straight rod in proportion to the load's gradient if that lowers its energy; otherwise
/// leaves it straight.
void bend_slightly(SpanSolution& solution, NewtonBuffers& buffers) {
  const SpanEnergy& model = *solution.model;
  const std::shared_ptr<SpanPoint> straight = buffers.new_point(model);
  const std::shared_ptr<SpanPoint> bent = buffers.new_point(model);
  solution.evaluate(Eigen::VectorXd::Zero(model.size()), *straight);
  solution.evaluate(-straight->gradient, *bent);
  solution.point = bent->energy < straight->energy ? bent : straight;
  solution.x = solution.point->x;
}

}  // namespace

SpanSolution plain_cantilever(LocalSolver& on) {
  SpanSolution at_once = on.empty_solution(on.terms());
  if (on.traits().load < soft_load) {
    bend_slightly(at_once, on.workspace().newton());
  } else {
    at_once.x = at_once.model->fit(soft_field(on.span())(at_once.model->nodes()));
  }
  on.newton(at_once);
  at_once = refined(on, std::move(at_once));
  if (succeeded(at_once.status) && at_once.evaluations <= on.options().max_evaluations &&
      turns_to_load(on.span(), at_once.at_x()->tangents())) {
    return at_once;
  }
  SpanSolution solution = refined(on, on.from_start(Start{soft_field(on.span())}));
  solution.evaluations += at_once.evaluations;
  return solution;
}

}  // namespace dlo::energy_model
