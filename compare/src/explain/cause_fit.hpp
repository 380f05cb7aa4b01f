#pragma once

#include <Eigen/Core>
#include <optional>

#include "base/timer.hpp"
#include "dlo/compare/shape_check.hpp"
#include "dlo/energy_model/energy.hpp"
#include "explain/scene_causes.hpp"

namespace dlo::compare {

/// Numbers of a cause whose rod is nearest to a shape, and that rod.
struct FittedCause {
  Eigen::VectorXd numbers;
  energy_model::Equilibrium rod;
};

struct CauseFitLimits {
  double noise = 0;  ///< differences up to this count as equal [m]
  Timer timer;       ///< started when the time limit begins
};

/// Fits the numbers of a cause to a shape. @param rod  rod with which the shape was compared
/// @return std::nullopt if the scene at the start of the cause has no equilibrium
/// @throws ConvergenceError if no time is left; InputError if the scene is invalid, or the shape
/// has too few points
[[nodiscard]] std::optional<FittedCause> fit_cause(const SceneCause& cause,
                                                   const MeasuredShape& shape,
                                                   const energy_model::Equilibrium& rod,
                                                   const ShapeCheckOptions& options,
                                                   const CauseFitLimits& limits);

}  // namespace dlo::compare
