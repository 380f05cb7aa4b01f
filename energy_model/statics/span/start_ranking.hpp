#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <vector>

#include "base/deadline.hpp"
#include "strain/span_energy.hpp"

namespace dlo::energy_model {

/// An initial guess and, if starts were ranked, its unknowns in the model of the ranking.
struct Start {
  TangentField field;
  std::shared_ptr<const SpanEnergy> model;
  Eigen::VectorXd x;
  /// Cost: energy plus that of springs at the grips, or energy alone once the constraints are
  /// satisfied.
  double cost = 0;
  /// Shape at the nodes of the ranking, before a fit.
  StartShape shape = {};
  /// Lower bound of the cost once the constraints are satisfied.
  double least = 0;
};

/// Parameters of a ranking of starts.
struct StartRanking {
  std::shared_ptr<SpanEnergy> model;  ///< model with few coefficients
  double load = 0;                    ///< weight plus loads [EI/l^2]
  std::size_t followed = 0;           ///< number of starts that are followed in any case
  bool keeps_unknowns = false;        ///< descents use as many coefficients as the model has
  /// Stiffness of springs at the grips, for starts that need not satisfy the constraints; the
  /// largest stiffness of a taut segment [EI/l^3].
  double stiffness = 0;
  bool satisfies_constraints = false;  ///< starts are first bent to satisfy the constraints
  const Deadline* deadline = nullptr;
};

/// Sorts starts by cost, cheapest first.
/// @return number of energy evaluations
int rank_starts(std::vector<Start>& starts, const StartRanking& ranking);

}  // namespace dlo::energy_model
