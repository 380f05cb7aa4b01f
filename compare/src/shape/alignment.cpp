#include "dlo/compare/alignment.hpp"

#include <fmt/format.h>

#include "base/words.hpp"
#include "dlo/compare/error.hpp"
#include "shape/aligner.hpp"

namespace dlo::compare {
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
  return choice_from<PoseFreedom>(name, pose_names());
}
ArcLengths arc_lengths_from(const std::string& name) {
  return choice_from<ArcLengths>(name, arc_lengths_names());
}

Eigen::Vector3d up_of(const Scene& scene, PoseFreedom pose) {
  if (pose != PoseFreedom::upright) return Eigen::Vector3d::UnitY();
  if (!(scene.gravity.norm() > 0)) {
    throw InputError(fmt::format(
        "{}: no gravity, so no frame is upright (allowed: translation, rigid)", scene.file));
  }
  return -scene.gravity.normalized();
}

Alignment align(const MeasuredShape& shape, const Reference& reference, double length,
                const AlignOptions& options) {
  return Aligner(shape, length, options).align(Curve(reference, length));
}

}  // namespace dlo::compare
