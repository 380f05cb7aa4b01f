#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <vector>

#include "base/deadline.hpp"
#include "strain/span_energy.hpp"

namespace dlo::energy_model {

/// A shape to start from and, where starts were ranked, its unknowns in the model of the ranking.
struct Start {
  TangentField field;
  std::shared_ptr<const SpanEnergy> model;
  Eigen::VectorXd x;
  /// Energy and that of springs at the grips, or without a gap.
  double cost = 0;
  /// At the nodes of the ranking, before a fit.
  StartShape shape = {};
  /// The least that it may cost without a gap.
  double least = 0;
};

/// What starts are weighed by.
struct StartRanking {
  std::shared_ptr<SpanEnergy> model;  ///< few terms
  double load = 0;                    ///< weight and loads [EI/l^2]
  std::size_t followed = 0;           ///< so many are descended from in any case
  bool keeps_unknowns = false;        ///< descents begin with as many terms as the model has
  /// Of springs at the grips where a start does not have to meet them: where the rod is taut, as
  /// stiff as it is between them.
  double stiffness = 0;
  bool meets_grips = false;  ///< starts are weighed once they are bent to meet the grips
  const Deadline* deadline = nullptr;
};

/// Sorts starts by what they cost, cheapest first.
/// @return evaluations that it took
int rank_starts(std::vector<Start>& starts, const StartRanking& ranking);

}  // namespace dlo::energy_model
