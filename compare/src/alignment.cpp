#include "dlo/compare/alignment.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "aligner.hpp"
#include "dlo/compare/error.hpp"

namespace dlo::compare {
namespace {

template <typename Choice>
Choice choice_of(const std::string& name, const std::vector<std::string>& names) {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) {
    throw InputError(
        fmt::format("unknown choice \"{}\" (allowed: {})", name, fmt::join(names, ", ")));
  }
  return static_cast<Choice>(found - names.begin());
}

}  // namespace

const std::vector<std::string>& pose_names() {
  static const std::vector<std::string> names = {"known", "translation", "upright", "rigid"};
  return names;
}
const std::vector<std::string>& arc_lengths_names() {
  static const std::vector<std::string> names = {"auto", "file", "chord", "nearest"};
  return names;
}
const char* to_string(PoseFreedom pose) {
  return pose_names()[static_cast<std::size_t>(pose)].c_str();
}
const char* to_string(ArcLengths arc_lengths) {
  return arc_lengths_names()[static_cast<std::size_t>(arc_lengths)].c_str();
}
PoseFreedom pose_from(const std::string& name) {
  return choice_of<PoseFreedom>(name, pose_names());
}
ArcLengths arc_lengths_from(const std::string& name) {
  return choice_of<ArcLengths>(name, arc_lengths_names());
}

Alignment align(const MeasuredShape& shape, const Reference& reference, double length,
                const AlignOptions& options) {
  return Aligner(shape, length, options).align(Curve(reference, length));
}

}  // namespace dlo::compare
