#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape.hpp"

namespace dlo::compare {

/// A possible error of a scene, described by numbers that are zero without the error.
struct SceneCause {
  Eigen::VectorXd start;    ///< start of the fit
  Eigen::VectorXd stride;   ///< strides of differences; zero: the start is not fitted
  double longest_step = 0;  ///< longest step of any number
  std::function<Scene(const Eigen::VectorXd&)> changed;
  std::function<std::string(const Eigen::VectorXd&)> words;
  /// Name of a group of causes of which only the best is reported; empty: reported by itself.
  std::string same_as = {};
  /// Whether the rod is held in another way, so that its equilibrium may be far from the compared
  /// one.
  bool other_state = false;
};

/// Whether weight is the only load, so that a factor on the stiffness has the effect of the inverse
/// factor on the weight.
[[nodiscard]] bool is_pulled_by_weight_alone(const Scene& scene);

/// Returns all possible single errors of a scene, the slowest to fit last.
/// @param shape     compared shape, in the scene's frame
/// @param length_of_shape  length along its points [m]
/// @param flat      whether the shape lies in the scene's plane: no cause then leaves it
[[nodiscard]] std::vector<SceneCause> scene_causes(const Scene& scene, const Shape& shape,
                                                   double length_of_shape, bool flat);

}  // namespace dlo::compare
