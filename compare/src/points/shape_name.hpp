#pragma once

#include <string>

namespace dlo::compare {

/// What a shape is called by: a file, and what of it. FILE.npy:INDEX is a frame of an array of
/// frames, FILE.npz:KEY an array of an archive, FILE.npz:KEY:INDEX a frame of that.
struct ShapeName {
  std::string file;   ///< to be read
  std::string key;    ///< empty: the only array of points
  std::string index;  ///< empty: all of the array
};

/// The parts of a name; a file may have colons in its own.
[[nodiscard]] ShapeName shape_name(const std::string& name);

}  // namespace dlo::compare
