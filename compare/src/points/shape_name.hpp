#pragma once

#include <string>

namespace dlo::compare {

/// The name of a shape: a file, or FILE.npy:INDEX, one frame of an array of frames.
struct ShapeName {
  std::string file;   ///< to be read
  std::string index;  ///< empty: all of the array
};

/// Returns the parts of a name; a file may have colons in its own.
[[nodiscard]] ShapeName shape_name(const std::string& name);

}  // namespace dlo::compare
