#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/timer.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape.hpp"
#include "dlo/compare/shape_check.hpp"
#include "dlo/energy_model/energy.hpp"

namespace dlo::compare {

/// A possible error of a scene, described by numbers. They are zero without the error, unless
/// `changes_support`; a cause may have no number.
struct SceneCause {
  Eigen::VectorXd start;            ///< start of the fit
  Eigen::VectorXd difference_step;  ///< steps of differences; zero: the start is not fitted
  double longest_step = 0;          ///< longest step of any number
  std::function<Scene(const Eigen::VectorXd&)> changed;
  std::function<std::string(const Scene& changed, const Eigen::VectorXd&)> words;
  /// Name of a group of causes of which only the best is reported; empty: reported by itself.
  std::string cause_group = {};
  /// Whether the rod is held in another way, so that its equilibrium may be far from the compared
  /// one.
  bool changes_support = false;
};

/// Whether weight is the only load, so that a factor on the stiffness has the effect of the inverse
/// factor on the weight.
[[nodiscard]] bool is_loaded_by_weight_alone(const Scene& scene);

/// Returns the single errors of a scene that are considered.
/// @param shape     compared shape, in the scene's frame
/// @param estimated_shape_length  length along its points [m]
/// @param flat      whether the shape lies in the scene's plane: positions and directions of
/// grippers then stay in it, and torsional stiffness and twist are no causes; only gravity may
/// leave it
[[nodiscard]] std::vector<SceneCause> scene_causes(const Scene& scene, const Shape& shape,
                                                   double estimated_shape_length, bool flat);

/// Numbers of a cause whose rod is nearest to a shape, and that rod.
struct FittedCause {
  Eigen::VectorXd numbers;
  energy_model::Equilibrium rod;
};

/// Fits the numbers of a cause to a shape.
/// @param rod    rod with which the shape was compared
/// @param noise  differences up to this count as equal [m]
/// @param timer  started when the time limit begins
/// @return std::nullopt if the scene at the start of the cause is invalid or has no equilibrium
/// @throws ConvergenceError if no time is left; InputError in the cases of align()
[[nodiscard]] std::optional<FittedCause> fit_cause(const SceneCause& cause,
                                                   const MeasuredShape& shape,
                                                   const energy_model::Equilibrium& rod,
                                                   const ShapeCheckOptions& options, double noise,
                                                   const Timer& timer);

}  // namespace dlo::compare
