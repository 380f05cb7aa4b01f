#include "dlo/compare/alignment.hpp"

#include <fmt/format.h>

#include "dlo/compare/error.hpp"
#include "shape/aligner.hpp"

namespace dlo::compare {

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
