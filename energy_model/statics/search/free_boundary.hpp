#pragma once

#include <Eigen/Core>
#include <vector>

#include "problem/span.hpp"
#include "span/span_solver.hpp"
#include "strain/span_solution.hpp"

namespace dlo::energy_model {

/// An unknown arc length at which a contact begins or ends. A rod that touches an obstacle at one
/// point is parallel to it there; a part in contact lifts off without a moment, that is, without
/// curvature towards the obstacle.
struct FreeBoundary {
  std::size_t contact = 0;  ///< index in Span::contacts
  bool begins = true;       ///< begin of a part in contact; true for a contact at a point

  [[nodiscard]] double at(const Span& span) const;
  void move(Span& span, double way) const;
};

/// Returns the free boundaries of a span, by ascending s: ends of its contacts that are neither at
/// a grip nor at an end of the span.
[[nodiscard]] std::vector<FreeBoundary> free_boundaries(const Span& span);

/// Returns the residual at each free boundary. For a sliding contact at one point it is the
/// arc length of the boundary minus that of the point of smallest clearance. For a point contact
/// that does not slide it is the slope of the clearance times the shorter distance to the next
/// grip, contact or end of the rod; the slope divided by the curvature would be 0 / 0 where the rod
/// begins to lie on the obstacle. For a part in contact it is the second derivative of the
/// clearance times the length of the adjacent free interval.
[[nodiscard]] Eigen::VectorXd free_boundary_residual(const SpanSolution& solution,
                                                     const std::vector<FreeBoundary>& ends);

/// Distances by which a free boundary may move down and up without passing a grip, an end of the
/// span, another contact or the other end of its own.
struct MoveLimits {
  double down = 0, up = 0;
};
[[nodiscard]] MoveLimits move_limits(const Span& span, const FreeBoundary& end);

/// Solves the free-boundary problem of lift-off: moves the ends of a solution's contacts until the
/// residual (free_boundary_residual()) is zero, by Newton's method with finite differences, each of
/// which needs an equilibrium of its own, followed by Broyden updates. The energy is stationary in
/// the ends, so that the error of the shape is the square of theirs. Ends that do not converge stay
/// at their last positions.
/// @param[in,out] solution  an equilibrium with its contacts
/// @return number of energy evaluations
int free_boundary_newton(SpanSolution& solution, const Deadline& deadline,
                         SpanWorkspace& workspace);

}  // namespace dlo::energy_model
