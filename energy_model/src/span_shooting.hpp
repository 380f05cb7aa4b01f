#pragma once

#include <string>
#include <vector>

#include "deadline.hpp"
#include "dlo/energy_model/equilibrium.hpp"
#include "rod_flow.hpp"
#include "rod_span.hpp"
#include "second_variation.hpp"

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
  SecondVariation stability;    ///< of an equilibrium that has converged
  Eigen::Matrix3Xd tangents;    ///< of an equilibrium, at equal distances, to compare it

  [[nodiscard]] bool stable() const { return converged && stability.stable(); }
};

/// What a search has found, and whether it came to its end.
struct SpanSearchResult {
  std::vector<SpanEquilibrium> found;  ///< stable ones first, by energy; never empty
  bool complete = true;                ///< false: the deadline has cut it short
};

/// Equilibria that Newton's method finds from the minima of polygons (relaxed_polygon.hpp), in the
/// span's plane and out of it: from the six lowest ones, from six more while none of what they led
/// to is stable. Where a polygon's force is large for its mesh, or Newton's method does not
/// converge, it is relaxed again on a finer one. What is unstable and lower than all that is stable
/// is left both ways along the mode of its smallest eigenvalue, and the polygon is relaxed from
/// there. If nothing is found, one that has failed.
[[nodiscard]] SpanSearchResult search_span(const RodSpan& span, double tolerance,
                                           const Deadline& deadline);

/// The equilibrium that Newton's method leads to from a shape of the problem that the span is of.
[[nodiscard]] SpanEquilibrium refine_span(const RodSpan& span, const Problem& problem,
                                          const Equilibrium& shape, double tolerance,
                                          const Deadline& deadline);

/// Force of what lies beyond the arc length s (over l) on what lies before, just after it, that the
/// grips' forces of a shape imply, in EI/l^2.
[[nodiscard]] Eigen::Vector3d implied_force(const Problem& problem, const Equilibrium& shape,
                                            double s);

/// The cross-section at s; NaN if the integrator gave up.
[[nodiscard]] RodState state_at(const SpanEquilibrium& span, const Eigen::Vector3d& weight,
                                double s, double tolerance);

/// The same at arc lengths that grow, each from the one before.
[[nodiscard]] std::vector<RodState> states_at(const SpanEquilibrium& span,
                                              const Eigen::Vector3d& weight,
                                              const std::vector<double>& s, double tolerance);

}  // namespace dlo::energy_model
