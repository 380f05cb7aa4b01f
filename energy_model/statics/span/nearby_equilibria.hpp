#pragma once

#include <Eigen/Core>
#include <optional>

#include "span/found.hpp"
#include "span/span_options.hpp"
#include "span/span_workspace.hpp"
#include "strain/span_solution.hpp"

namespace dlo::energy_model {

/// A direction of negative curvature of an unstable equilibrium.
struct NegativeCurvature {
  Span span;                  ///< the solution's; in space where a planar one leaves its plane
  Eigen::VectorXd direction;  ///< unit, of the unknowns of a model of `span` with as many terms
};

/// That of the smallest eigenvalue: in its plane if there is one there. None if it is stable.
[[nodiscard]] std::optional<NegativeCurvature> negative_curvature(const SpanSolution& solution);

/// Unit vector along the eigenvalue of the projected second variation that is nearest to zero,
/// rigid-body modes left aside; none if the constraints leave no other.
[[nodiscard]] std::optional<Eigen::VectorXd> mode_nearest_zero(const SpanSolution& solution);

/// Downhill from an unstable equilibrium, along its direction of negative curvature, to the minimum
/// below; out of its plane if that is the only way in which it gives way. None where no such
/// direction is seen. Not certified.
[[nodiscard]] std::optional<SpanSolution> leave_saddle(const SpanSolution& solution,
                                                       const SpanOptions& options,
                                                       SpanWorkspace& workspace);

/// Between two minima there is a pass, and a saddle on it: by Newton's method from where the
/// unknowns of two of the equilibria found are joined.
void look_between(const SpanOptions& options, SpanWorkspace& workspace, Found& found);

/// At a fold two equilibria come from one, and lie on both sides of it along its soft mode: by
/// Newton's method from beside those found, also those found that way.
void look_beside(const SpanOptions& options, SpanWorkspace& workspace, Found& found);

}  // namespace dlo::energy_model
