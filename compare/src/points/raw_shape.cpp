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

void require_as_many_d1(const RawShape& raw, const std::string& file) {
  if (raw.d1.empty() || raw.d1.size() == raw.points.size()) return;
  throw InputError(fmt::format("{}: d1: {} vectors of {} points (allowed: one a point, or none)",
                               file, raw.d1.size(), raw.points.size()));
}

}  // namespace dlo::compare
