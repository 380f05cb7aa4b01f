#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "dlo/energy_model/equilibrium.hpp"
#include "dlo/energy_model/problem.hpp"
#include "frames/span_shape.hpp"
#include "problem/span.hpp"
#include "strain/span_solution.hpp"

namespace dlo::energy_model {

/// Clearance of a point of a shape, and its derivatives by the arc length.
struct Clearance {
  double value = 0;
  double slope = 0;
  double rate = 0;  ///< second derivative by the arc length
};
[[nodiscard]] Clearance clearance_at(const obstacle::Body& body, const Samples& samples,
                                     Eigen::Index i);

/// A point where a shape is nearest to a rigid obstacle or deepest within it.
struct GapMinimum {
  Span::Obstacle obstacle;
  double s = 0;
  double clearance = 0;
  int feature = 0;  ///< feature of the body (face, edge, corner) nearest to the point
};

/// Returns the local minima of the clearances from each rigid obstacle along the rod that are below
/// `below`, ends included, by ascending s. They are searched for on a dense grid and, more densely,
/// beside contacts, and then refined. Points at grips count.
[[nodiscard]] std::vector<GapMinimum> gap_minima(const Span& span, const SpanShape& shape,
                                                 double below);

/// Depth of a shape within rigid obstacles.
struct Penetration {
  double depth = 0;          ///< largest depth [m]; 0 if the shape is outside
  std::size_t obstacle = 0;  ///< index in the problem of the obstacle with that depth
};

/// Checks a returned equilibrium for penetration, independently of the search that found it.
/// Measures the depth within rigid obstacles on a grid much finer than the solver's nodes, and
/// changes a successful status to `not_verified` if the depth exceeds `allowed_penetration` rod
/// lengths. Soft obstacles are penetrated in proportion to their force and are not checked.
/// @param[in,out] equilibrium  status, message and penetration
Penetration judge_penetration(const Problem& problem, Equilibrium& equilibrium);

/// Largest depth within a rigid obstacle of a shape that counts as on it, divided by the span's
/// length, and largest distance from the obstacle of a grip that counts as on it [l]: rounding.
inline constexpr double contact_tolerance = 1e-9;
/// Largest depth, divided by the span's length, while coefficients may be missing.
inline constexpr double coarse_contact_tolerance = 1e-6;

/// Whether a shape has all coefficients that it needs; before that the pressure on a part is not
/// meaningful.
enum class Resolution {
  coarse,
  resolved,
};

/// Checks whether the contacts are those of an equilibrium: no obstacle pulls (concentrated forces
/// and pressures are above -1e-7 of all forces), and no point is deeper within an obstacle
/// than `contact_tolerance` span lengths (`coarse_contact_tolerance` unless resolved).
/// @return std::nullopt if so; otherwise the contacts to try next: points that pull are released,
///   parts that pull at an end or are too short become a point, parts that pull between their ends
///   become one or two points, contacts that meet are joined, and contacts are added or extended
///   where the rod is within an obstacle
[[nodiscard]] std::optional<std::vector<Span::Contact>> updated_contacts(
    const SpanSolution& solution, Resolution resolution);

}  // namespace dlo::energy_model
