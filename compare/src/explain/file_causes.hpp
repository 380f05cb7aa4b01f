#pragma once

#include <string>
#include <vector>

#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape_check.hpp"
#include "dlo/compare/shape_file.hpp"

namespace dlo::compare {

/// A way in which a file may say a right shape wrongly.
struct FileCause {
  std::string words;
  MeasuredShape shape;  ///< the shape, said rightly
  /// What is left of the frame to find out.
  PoseFreedom pose = PoseFreedom::known;
  int numbers = 0;  ///< that this counts as
  /// Only what the shape has of the rod is held against it.
  bool part = false;
  /// Of several ways to say the same the best is told; empty: there is one.
  std::string same_as = {};
};

/// All that can be wrong with a file, in a frame that is said to be the scene's.
[[nodiscard]] std::vector<FileCause> file_causes(const Scene& scene, const MeasuredShape& shape,
                                                 const ShapeCheck& check);

}  // namespace dlo::compare
