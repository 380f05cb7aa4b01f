#include "points/shape_name.hpp"

#include <string_view>

namespace dlo::compare {

ShapeName shape_name(const std::string& name) {
  constexpr std::string_view array = ".npy:";
  const std::size_t found = name.rfind(array);
  if (found == std::string::npos) return {name, ""};
  const std::size_t colon = found + array.size() - 1;
  return {name.substr(0, colon), name.substr(colon + 1)};
}

}  // namespace dlo::compare
