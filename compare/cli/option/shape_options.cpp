#include "option/shape_options.hpp"

#include <fmt/format.h>

#include "dlo/compare/error.hpp"
#include "dlo/compare/shape_file.hpp"
#include "option/option_values.hpp"
#include "option/output.hpp"
#include "toml/quantity.hpp"

namespace dlo::cli {
void ShapeOptions::add_to(CLI::App& command, ChordLengths chord) {
  const OptionGroup group(command, "Shape files");
  std::vector<std::string> rules = compare::names<compare::ArcLengths>();
  if (chord == ChordLengths::not_exact_enough) {
    std::erase(rules, compare::to_string(compare::ArcLengths::chord));
  }
  const std::vector<std::string> units = compare::unit_names(compare::Dimension::length);
  add_checked(command, "--unit", unit_, CLI::IsMember(units),
              "what the numbers are in: " + compare::one_of(units));
  command
      .add_flag("--register{rigid}", pose_,
                "the file's frame is unknown: find it. --register=upright if its vertical is "
                "known, --register=translation if all directions are")
      ->check(CLI::IsMember(compare::names<compare::PoseFreedom>()));
  add_checked(
      command, "--arc-lengths", arc_lengths_, CLI::IsMember(rules),
      chord == ChordLengths::offered
          ? "of the points: file (its column s), nearest (points of the reference), chord (lengths "
            "along the polyline of a whole rod) or auto: file if there is a column s, else nearest"
          : "of the points: file (its column s), nearest (points of the rod) or auto: file if "
            "there is a column s, else nearest");
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
  constexpr double another_unit = 5;
  const Eigen::Index segments = shape.points.cols() - 1;
  const double polyline_m =
      (shape.points.rightCols(segments) - shape.points.leftCols(segments)).colwise().norm().sum();
  const std::string hint = unit_hint(polyline_m, length);
  const bool is_other = polyline_m > another_unit * length || polyline_m < length / 50;
  if (!hint.empty() && is_other) {
    throw compare::InputError(fmt::format("{}: {}", shape.file, hint));
  }
}

}  // namespace dlo::cli
