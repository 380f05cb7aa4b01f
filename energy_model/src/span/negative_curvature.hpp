#pragma once

#include <Eigen/Core>
#include <optional>

#include "strain/span_solution.hpp"

namespace dlo::energy_model {

/// A direction of negative curvature of an unstable equilibrium.
struct NegativeCurvature {
  Span span;                  ///< the solution's; in space where a planar one leaves its plane
  Eigen::VectorXd direction;  ///< unit, of the unknowns of a model of `span` with as many terms
};

/// That of the smallest eigenvalue: in its plane if there is one there. None if it is stable.
[[nodiscard]] std::optional<NegativeCurvature> negative_curvature(const SpanSolution& solution);

}  // namespace dlo::energy_model
