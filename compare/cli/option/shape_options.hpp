#pragma once

#include <string>

#include "dlo/compare/alignment.hpp"
#include "option/command_line.hpp"

namespace dlo::cli {

/// Options that define the meaning of the numbers in a shape file.
class ShapeOptions {
 public:
  void add_to(Command& command);

  /// Reads a shape file in the given unit. @throws compare::InputError
  [[nodiscard]] compare::MeasuredShape load(const std::string& path) const;
  /// Returns a hint such as "polyline is 1/998 of the rod: --unit m?", or an empty string if the
  /// unit may be right.
  [[nodiscard]] std::string unit_hint(double polyline_m, double length) const;
  /// Checks the unit. @throws compare::InputError with the hint if another unit is almost certain
  void require_likely_unit(const compare::MeasuredShape& shape, double length) const;
  [[nodiscard]] compare::PoseFreedom pose() const {
    return compare::from_name<compare::PoseFreedom>(pose_);
  }
  [[nodiscard]] compare::ArcLengths arc_lengths() const { return arc_lengths_; }

 private:
  std::string unit_ = "m";
  std::string pose_ = "known";
  compare::ArcLengths arc_lengths_ = compare::ArcLengths::automatic;
};

}  // namespace dlo::cli
