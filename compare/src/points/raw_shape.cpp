#include "points/raw_shape.hpp"

#include <fmt/format.h>

#include "dlo/compare/error.hpp"
#include "dlo/compare/shape_file.hpp"

namespace dlo::compare {

void require_point_count(std::size_t count, const std::string& where) {
  if (count <= static_cast<std::size_t>(most_shape_points)) return;
  throw InputError(
      fmt::format("{}: {} points (allowed: 2 to {})", where, count, most_shape_points));
}

}  // namespace dlo::compare
