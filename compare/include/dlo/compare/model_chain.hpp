#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace dlo::compare {

/// The chain of bodies in a simulator's model that a scene was made from.
struct ModelChain {
  std::string words;               ///< what it is: "MJCF, a composite cable"
  std::vector<std::string> notes;  ///< what was assumed, for people
  Eigen::Index segments = 0;       ///< each a body, whose position is where it begins
  Eigen::Index first_body = 1;     ///< of the chain among all bodies of the model, the world's is 0
  Eigen::Index bodies = 0;         ///< of the model, with the world

  /// In every field.
  bool operator==(const ModelChain&) const = default;
};

}  // namespace dlo::compare
