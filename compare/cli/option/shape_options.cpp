#include "option/shape_options.hpp"

#include <fmt/format.h>

#include "dlo/compare/error.hpp"
#include "dlo/compare/shape_file.hpp"
#include "shape/curve.hpp"
#include "toml/quantity.hpp"

namespace dlo::cli {
void ShapeOptions::add_to(Command& command) {
  command.add("--unit", unit_, compare::unit_names(compare::Dimension::length));
  command.add("--register", pose_, compare::names<compare::PoseFreedom>());
  command.add("--arc-lengths", arc_lengths_);
}

compare::MeasuredShape ShapeOptions::load(const std::string& path) const {
  return compare::load_shape(path,
                             compare::parse_quantity("1 " + unit_, compare::Dimension::length));
}

std::string ShapeOptions::unit_hint(double polyline_m, double length) const {
  const double ratio = polyline_m / length;
  const bool short_one = ratio < 1.0 / 50;
  if (!short_one && !(ratio > 1.1)) return {};
  std::string hint = short_one ? fmt::format("polyline is 1/{:.0f} of the rod: ", 1 / ratio)
                               : fmt::format("polyline is {:.4g} times the rod: ", ratio);
  const double given = compare::parse_quantity("1 " + unit_, compare::Dimension::length);
  for (const std::string& unit : compare::unit_names(compare::Dimension::length)) {
    const double value = compare::parse_quantity("1 " + unit, compare::Dimension::length);
    const double share = ratio * value / given;
    // The shape may be a large part of the rod, and noise may lengthen the polyline.
    if (unit != unit_ && share > 0.2 && share < 2) return hint + fmt::format("--unit {}?", unit);
  }
  return hint + (short_one ? "a small piece, or --unit?" : "noise between points, or --unit?");
}

void ShapeOptions::require_likely_unit(const compare::MeasuredShape& shape, double length) const {
  constexpr double unit_suspicion_ratio = 5;
  const double polyline_m = compare::polyline_length(shape.points);
  const std::string hint = unit_hint(polyline_m, length);
  const bool is_other = polyline_m > unit_suspicion_ratio * length || polyline_m < length / 50;
  if (!hint.empty() && is_other) {
    throw compare::InputError(fmt::format("{}: {}", shape.file, hint));
  }
}

}  // namespace dlo::cli
