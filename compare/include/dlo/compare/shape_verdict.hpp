#pragma once

#include <string>

#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape.hpp"

namespace dlo::compare {

/// Whether a shape is a scene's.
struct ShapeVerdict {
  bool near = false;        ///< within the tolerance everywhere
  std::string explanation;  ///< one line: where it is worst, how far, and how far on the whole
};

/// Compares a shape with the energy model's, at equal arc length: near if no point is further away
/// than `tolerance` times the rod's length. A shape that is none (other numbers of points and arc
/// lengths, fewer than two, not finite, arc lengths that do not grow or leave the rod) is not near,
/// and the explanation says why.
/// @param tolerance  [-], > 0
/// @throws std::invalid_argument for such a tolerance, InputError, ConvergenceError
[[nodiscard]] ShapeVerdict judge_shape(const Shape& shape, const Scene& scene, double tolerance);

}  // namespace dlo::compare
