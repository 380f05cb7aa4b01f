#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>

#include "span/found.hpp"
#include "span/span_options.hpp"
#include "strain/span_solution.hpp"

namespace dlo::energy_model {

/// Number of equilibria, in the order of discovery, from which a search goes on: by a descent if
/// the equilibrium is unstable, and by search_adjacent().
inline constexpr std::size_t most_searched_from = 8;

/// Length of the displacement along a unit mode with which a descent leaves an unstable
/// equilibrium.
inline constexpr double mode_amplitude = 0.5;

/// Direction of negative curvature of an unstable equilibrium.
struct NegativeCurvature {
  Span span;                  ///< the solution's; in space if a planar one leaves its plane
  Eigen::VectorXd direction;  ///< unit vector, in a model of `span` with as many coefficients
};

/// Returns the eigenvector of the smallest eigenvalue: in the span's plane if it is negative there,
/// otherwise out of the plane. Returns std::nullopt if no eigenvalue is negative in the directions
/// that the span allows.
[[nodiscard]] std::optional<NegativeCurvature> negative_curvature(const SpanSolution& solution);

/// Descends from an unstable equilibrium along its direction of negative curvature to a minimum
/// below, out of its plane if it is unstable only there. On soft obstacles the mode nearest
/// zero replaces a missing direction; otherwise returns std::nullopt if there is none. The result
/// is not certified, and no equilibrium if the descent fails.
[[nodiscard]] std::optional<SpanSolution> leave_saddle(const SpanSolution& solution,
                                                       const SpanOptions& options,
                                                       SpanWorkspace& workspace);

/// Searches for saddles between pairs of equilibria found, by Newton's method from points on the
/// line between their unknowns: between two minima there is a pass, and a saddle on it. Like
/// search_adjacent(), it needs SpanOptions::log.
void search_between(const SpanOptions& options, SpanWorkspace& workspace, Found& found);

/// Searches for equilibria next to those found, including the new ones, by Newton's method from
/// points along the eigenvector nearest zero: at a fold two equilibria coincide, and near it they
/// lie on both sides along this direction.
void search_adjacent(const SpanOptions& options, SpanWorkspace& workspace, Found& found);

/// Solves for the equilibrium near SpanOptions::start and certifies it, by Newton's method or by
/// descent as the start requests, and by the other method if the result is not stable or far from a
/// known shape, except for Approach::follow_only. A saddle is replaced by the equilibrium below it,
/// if that is stable, in two cases: only a descent is allowed (Approach::descend_only), or the
/// start is a known shape and not Approach::follow_only.
[[nodiscard]] SpanSolution solve_from_given_start(const Span& span, const SpanOptions& options,
                                                  SpanWorkspace& workspace);

}  // namespace dlo::energy_model
