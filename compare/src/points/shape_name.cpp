#include "points/shape_name.hpp"

#include <algorithm>
#include <string_view>

namespace dlo::compare {

ShapeName shape_name(const std::string& name) {
  constexpr std::string_view array = ".npy:";
  constexpr std::string_view archive = ".npz:";
  const std::size_t of_array = name.rfind(array);
  const std::size_t of_archive = name.rfind(archive);
  if (of_array != std::string::npos && (of_archive == std::string::npos || of_array > of_archive)) {
    const std::size_t colon = of_array + array.size() - 1;
    return {name.substr(0, colon), "", name.substr(colon + 1)};
  }
  if (of_archive == std::string::npos) return {name, "", ""};
  const std::size_t colon = of_archive + archive.size() - 1;
  const std::string rest = name.substr(colon + 1);
  const std::size_t second = rest.rfind(':');
  if (second == std::string::npos) return {name.substr(0, colon), rest, ""};
  return {name.substr(0, colon), rest.substr(0, second), rest.substr(second + 1)};
}

}  // namespace dlo::compare
