#pragma once

#include <string_view>

namespace dlo::compare {

/// What may be said of an element: attributes that are read, and such as have no effect on the
/// shape at rest of a chain of segments.
struct MjcfElement {
  std::string_view name;
  std::string_view read;  ///< with blanks between
  std::string_view without_effect;
};

/// Nothing of an element that has no place in a rod's scene.
[[nodiscard]] const MjcfElement* mjcf_element(std::string_view name);

/// Parts of the file beside the bodies that have no effect on a shape at rest.
[[nodiscard]] bool mjcf_without_effect(std::string_view name);

}  // namespace dlo::compare
