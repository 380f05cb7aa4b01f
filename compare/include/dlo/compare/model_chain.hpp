#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace dlo::compare {

/// Chain of bodies in a simulator's model that a scene was made from.
struct ModelChain {
  std::string words;               ///< kind of model: "MJCF, a composite cable"
  std::vector<std::string> notes;  ///< assumptions, for people
  /// Number of segments, one body each; a body's position is the start of its segment.
  Eigen::Index segments = 0;
  /// Index of the chain's first body among all bodies of the model; the world has 0.
  Eigen::Index first_body = 1;
  Eigen::Index bodies = 0;  ///< number of bodies of the model, with the world

  /// Compares all fields.
  bool operator==(const ModelChain&) const = default;
};

}  // namespace dlo::compare
