#pragma once

#include <string>
#include <vector>

#include "dlo/energy_model/equilibrium.hpp"
#include "rod_flow.hpp"
#include "rod_span.hpp"

namespace dlo::energy_model {

/// An equilibrium of a span in its own units, or why there is none.
struct SpanEquilibrium {
  bool converged = false;
  std::string message = "never ran";
  int shots = 0;
  double residual = -1;
  Eigen::VectorXd s;            ///< nodes, which are grips, loads and some between
  std::vector<RodState> nodes;  ///< n is the force after the node
  Energies energy;              ///< zero where points sit at the problem's first grip
};

/// Equilibria that Newton's method finds from the lowest minima of polygons (relaxed_polygon.hpp),
/// in the span's plane and out of it, by energy. If it finds none, one that has failed.
[[nodiscard]] std::vector<SpanEquilibrium> search_span(const RodSpan& span, double tolerance);

/// The equilibrium that Newton's method leads to from a shape of the problem that the span is of.
[[nodiscard]] SpanEquilibrium refine_span(const RodSpan& span, const Problem& problem,
                                          const Equilibrium& shape, double tolerance);

/// The cross-section at s.
[[nodiscard]] RodState state_at(const SpanEquilibrium& span, const Eigen::Vector3d& weight,
                                double s, double tolerance);

}  // namespace dlo::energy_model
