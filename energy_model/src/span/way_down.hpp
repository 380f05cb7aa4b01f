#pragma once

#include <Eigen/Core>
#include <optional>

#include "strain/span_solution.hpp"

namespace dlo::energy_model {

/// How an equilibrium gives way that cannot hold itself.
struct WayDown {
  Span span;              ///< the solution's; in space where a planar one leaves its plane
  Eigen::VectorXd along;  ///< unit, of the unknowns of a model of `span` with as many terms
};

/// The direction in which it gives way first: in its plane if it does there. None if it is stable.
[[nodiscard]] std::optional<WayDown> way_down(const SpanSolution& solution);

}  // namespace dlo::energy_model
