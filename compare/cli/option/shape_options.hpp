#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "dlo/compare/alignment.hpp"

namespace dlo::cli {

/// Whether a command takes arc lengths from the chords between points, known to 1e-4 l.
enum class ChordLengths { offered, not_exact_enough };

/// Options that say what a shape file's numbers mean.
class ShapeOptions {
 public:
  /// @param chord  chord lengths of a whole rod are good enough for the command
  void add_to(CLI::App& command, ChordLengths chord);

  /// Reads a shape file in the unit that was given. @throws compare::InputError
  [[nodiscard]] compare::MeasuredShape load(const std::string& path) const;
  /// "polyline is 1/998 of the rod: --unit m?", or nothing if the unit may be right.
  [[nodiscard]] std::string unit_hint(double polyline_m, double length) const;
  /// @throws compare::InputError with the hint if another unit is as good as certain
  void require_likely_unit(const compare::MeasuredShape& shape, double length) const;
  [[nodiscard]] compare::PoseFreedom pose() const {
    return compare::from_name<compare::PoseFreedom>(pose_);
  }
  [[nodiscard]] compare::ArcLengths arc_lengths() const {
    return compare::from_name<compare::ArcLengths>(arc_lengths_);
  }

 private:
  std::string unit_ = "m";
  std::string pose_ = "known";
  std::string arc_lengths_ = "auto";
};

}  // namespace dlo::cli
