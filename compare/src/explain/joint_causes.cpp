#include "explain/joint_causes.hpp"

#include <utility>
#include <vector>

#include "explain/file_causes.hpp"
#include "shape/curve.hpp"

namespace dlo::compare {
namespace {

/// Range of the length of a file's polyline, divided by the rod's, for which a unit is considered.
constexpr double shortest = 0.5;
constexpr double longest = 1.25;

/// Returns the units in which the shape is about as long as the rod or a part of it, with their
/// factors; the unit in which the file was read has an empty name.
std::vector<std::pair<std::string, double>> units_for(const MeasuredShape& shape, double length) {
  const double share = lengths_along(shape.points).back() / length;
  std::vector<std::pair<std::string, double>> units;
  const auto add = [&](const std::string& words, double metres) {
    if (share * metres > shortest && share * metres < longest) units.emplace_back(words, metres);
  };
  add("", 1);
  for (const FileUnit& unit : other_units(shape)) add(unit.words, unit.factor);
  return units;
}

/// Calls `look` for a file in this unit and these axes: with or without missing ends, at its place
/// or translated. Only combinations with at least two errors are used.
void look_at_poses(const std::string& unit, const FileAxes& axes, const MeasuredShape& in_metres,
                   bool lacks_ends, const std::function<void(const FileCause&)>& look) {
  const int changed = (unit.empty() ? 0 : 1) + (axes.words.empty() ? 0 : 1);
  const char* const both = changed == 2 ? ", and " : "";
  for (const bool part : {false, true}) {
    if (part && !lacks_ends) continue;
    for (const PoseFreedom pose : {PoseFreedom::known, PoseFreedom::translation}) {
      const int moved = pose == PoseFreedom::translation ? 1 : 0;
      const int faults = changed + (part ? 1 : 0) + moved;
      if (faults < 2) continue;
      look({.words = unit + both + axes.words,
            .shape = turned(in_metres, axes.axes),
            .pose = pose,
            .numbers = faults - 1 + moved,
            .part = part,
            .same_as = joint_cause});
    }
  }
}

}  // namespace

void look_at_joint_causes(const Scene& scene, const MeasuredShape& shape, double length,
                          const std::function<void(const FileCause&)>& look) {
  std::vector<FileAxes> all_axes = other_axes(scene.gravity, shape.points);
  all_axes.insert(all_axes.begin(), {Eigen::Matrix3d::Identity(), ""});
  for (const auto& [unit, metres] : units_for(shape, length)) {
    const MeasuredShape in_metres = scaled(shape, metres);
    const bool lacks_ends = is_short(lengths_along(in_metres.points).back(), length);
    for (const FileAxes& axes : all_axes) look_at_poses(unit, axes, in_metres, lacks_ends, look);
  }
}

}  // namespace dlo::compare
