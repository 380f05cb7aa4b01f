#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "base/deadline.hpp"
#include "dlo/energy_model/equilibrium.hpp"
#include "kirchhoff/rod_span.hpp"
#include "shooting/span_equilibrium.hpp"

namespace dlo::energy_model {

/// Result of a search for equilibria of a span.
struct SpanSearchResult {
  std::vector<SpanEquilibrium> found;  ///< stable ones first, by energy; never empty
  bool complete = true;                ///< whether the search ended before its deadline
  std::string not_searched;            ///< description of an omitted part; empty: none
};

/// Finds equilibria by Newton's method from the minima of polygons (relaxed_polygon.hpp), in the
/// span's plane and out of it: from the six lowest ones, and from ten more while none of the
/// results is stable. If a polygon's force is large for its mesh, or Newton's method does not
/// converge, the polygon is relaxed again on a finer mesh. An unstable equilibrium below all stable
/// ones is left in both directions along the mode of its smallest eigenvalue, and the polygon is
/// relaxed from there. If nothing is stable then, the gradient flow starts from the lowest
/// equilibrium. If nothing is found, a failed result is returned.
///
/// For a span that stretches, the results without stretch are continued (stretch_span()), and
/// Newton's method also starts from straight lines between the grips. It starts from these alone if
/// neighbouring grips are at least as far apart as the rod between them is long.
///
/// Frames after the first clamp are released for this search. If clamps hold frames, those of the
/// lowest equilibrium are then rotated to the held ones (twist_span()); the result is then one
/// equilibrium, or a failed one.
[[nodiscard]] SpanSearchResult search_span(const RodSpan& span, double tolerance,
                                           const Deadline& deadline);

/// Whether a round span is planar and inextensible and has one clamp, no other grip, one section
/// and uniform weight, and shooting from its tip is well posed. The sum of weight and loads over
/// EI/l^2 may be at most 4e5 if they are parallel (beyond, the tip angle against them is below the
/// smallest number), and at most 60 otherwise (beyond, rounding at the tip is amplified too much).
[[nodiscard]] bool tip_can_be_scanned(const RodSpan& span);

/// Finds equilibria of a span in its plane, stable and unstable ones, by shooting from the free
/// end:
///     theta' = kappa,  EI kappa' = n_x sin theta - n_y cos theta,  theta(0) given, kappa(l) = 0,
/// n(s) the sum of weight and loads beyond s. The solution that grows towards the clamp is the one
/// that is integrated, and the angle is measured from the last force. The problem therefore stays
/// well posed if that angle is exponentially small (Gamma >> 1).
///
/// All tip angles are scanned. Each cell of the grid is halved, at most six times, until a cubic
/// from the residual of the clamp's angle and its derivative at both ends has an error below 2 % in
/// the middle. A change of sign of the residual is a root. Two roots are in a cell if the residual
/// approaches zero from both ends and its extremum is beyond zero. If the extremum is below 1e-11,
/// they are one double root. If there is no root, a failed result is returned.
/// @param span       a span of which tip_can_be_scanned()
/// @param tolerance  local error of the integrator per step
[[nodiscard]] SpanSearchResult scan_tip(const RodSpan& span, double tolerance,
                                        const Deadline& deadline);

/// Returns the equilibrium to which Newton's method converges from a shape of the span's problem,
/// or of a similar one. If the shape has no `twists` for a round span, the span is refined without
/// twist and then twisted. Material directors are those of the shape's d1. If it has none, they
/// rotate from those of the first clamp by the torque that the grips' reactions imply.
/// @throws std::invalid_argument if the span is not round and has no clamp, or if its loads are too
/// large (check_load())
[[nodiscard]] SpanEquilibrium refine_span(const RodSpan& span, const Problem& problem,
                                          const Equilibrium& shape, double tolerance,
                                          const Deadline& deadline);

/// Returns the force of the part beyond the arc length s (over l) on the part before, just after s,
/// that a shape's grip forces, weight and loads imply, in EI/l^2; without contacts and drag.
[[nodiscard]] Eigen::Vector3d implied_force(const Problem& problem, const Equilibrium& shape,
                                            double s);

/// Returns the length of intervals that resolves the bends by a force over b and by the natural
/// strains.
[[nodiscard]] double resolving_interval(const RodSpan& span, double force);

/// Checks that weight and loads are not too large for the softest section.
/// @throws std::invalid_argument if they are
void check_load(const RodSpan& span);

}  // namespace dlo::energy_model
