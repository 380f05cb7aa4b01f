#pragma once

#include <Eigen/Core>
#include <optional>

#include "base/timer.hpp"
#include "dlo/compare/shape_check.hpp"
#include "dlo/energy_model/energy.hpp"
#include "explain/scene_causes.hpp"

namespace dlo::compare {

/// Numbers of a cause whose rod is nearest to a shape.
struct FittedCause {
  Eigen::VectorXd numbers;
  energy_model::Equilibrium rod;
};

struct CauseFitLimits {
  double noise = 0;  ///< what is nearer is the same [m]
  Timer timer;       ///< from when on the time limit is
};

/// @param rod  that the shape was compared with
/// @return none if the scene that the cause begins with has no equilibrium
/// @throws ConvergenceError if no time is left; InputError if there is no such scene, or the shape
///         has too few points
[[nodiscard]] std::optional<FittedCause> fit_cause(const SceneCause& cause,
                                                   const MeasuredShape& shape,
                                                   const energy_model::Equilibrium& rod,
                                                   const ShapeCheckOptions& options,
                                                   const CauseFitLimits& limits);

}  // namespace dlo::compare
