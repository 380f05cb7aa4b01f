#include "shooting/boundary_value.hpp"

#include <algorithm>

#include "shooting/close_gaps.hpp"
#include "shooting/shooting_system.hpp"

namespace dlo::energy_model {

ShootingResult shoot(const RodSpan& span, const RodMesh& mesh, const std::vector<RodState>& start,
                     const ShootingOptions& options) {
  const ShootingSystem system(span, mesh, options,
                              std::max({1.0, total_load(span), largest_force(start)}));
  std::vector<ShootingNode> nodes;
  nodes.reserve(start.size());
  for (const RodState& state : start) nodes.push_back(system.make_node(state));
  ClosedGaps closed = close_gaps(system, nodes, options.max_iterations, options.frames.has_value());
  ShootingResult result;
  result.converged = closed.converged;
  result.message = std::move(closed.message);
  result.shots = closed.shots;
  result.residual = system.gap(nodes);
  for (const ShootingNode& node : nodes) result.nodes.push_back(node.state);
  if (!result.converged) return result;
  result.converged = result.residual <= system.closed();
  result.message = result.converged ? "converged" : "the rod does not close at a node";
  return result;
}

}  // namespace dlo::energy_model
