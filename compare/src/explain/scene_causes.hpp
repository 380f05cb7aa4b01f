#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape.hpp"

namespace dlo::compare {

/// A way in which a scene may be another one, by some numbers that are zero if it is not.
struct SceneCause {
  Eigen::VectorXd start;    ///< of the search
  Eigen::VectorXd stride;   ///< of differences; zero: the start is it
  double longest_step = 0;  ///< of any number
  std::function<Scene(const Eigen::VectorXd&)> changed;
  std::function<std::string(const Eigen::VectorXd&)> words;
  /// Of several starts of the same cause the best is told; empty: there is one.
  std::string same_as = {};
  /// The rod is held in another way, so that its state may be none that is near.
  bool other_state = false;
};

/// Whether nothing but its weight bends the rod, so that a stiffness times a number is the weight
/// over it.
[[nodiscard]] bool is_pulled_by_weight_alone(const Scene& scene);

/// All that can be wrong with this scene, what takes longest last.
/// @param shape     that it is held against, in the scene's frame
/// @param length_of_shape  along its points [m]
/// @param flat      the shape lies in the scene's plane: nothing leads out of it
[[nodiscard]] std::vector<SceneCause> scene_causes(const Scene& scene, const Shape& shape,
                                                   double length_of_shape, bool flat);

}  // namespace dlo::compare
