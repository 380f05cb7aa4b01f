#pragma once

#include <vector>

#include "frames/span_shape.hpp"
#include "problem/span.hpp"

namespace dlo::energy_model {

/// Returns initial guesses for a span's equilibria, chosen by physical limits. With one clamp they
/// are shapes that come down onto a half-space and lie along it, the pendulum's profile from the
/// clamp's direction to the load's, by the shorter and the longer way, and the straight rod.
/// Otherwise they are arches and S-shapes of the right slack to both sides, in space also arches
/// across the weight, and loops if there are two grips and slack. Of each pair of arches the one
/// that the weight favours comes first.
/// @param span  has to outlive the result
[[nodiscard]] std::vector<TangentField> start_fields(const Span& span);

/// Returns the pendulum's profile 4 atan(tan(psi/4) exp(-sqrt(n) s)) from a clamp towards the sum n
/// of weight and loads: the limit shape of a soft rod.
/// @param span   has to outlive the result
/// @param turns  0: by the shorter way; 1: by the longer way
[[nodiscard]] TangentField soft_limit_field(const Span& span, int turns = 0);

/// Returns a shape through the anchor and the other grips of a span: arches of the right slack that
/// hang in the direction of the weight, and beyond the outermost grips the pendulum's profile.
/// @param span  has to outlive the result
[[nodiscard]] TangentField arch_field(const Span& span);

/// Returns initial guesses for a rod with material directors: the stress-free shape, and the
/// shapes of start_fields(), in space each also with the rod's frame rotated evenly along the rod,
/// to several angles. If Span::Twist::turns is given, only the shapes of start_fields(), with
/// frames that are rotated evenly until they meet the frame at the end. Each is rotated by the two
/// angles of the class of these turns that are nearest to zero; shapes without a writhe are
/// omitted.
/// @param span  has to outlive the result
[[nodiscard]] std::vector<TangentField> natural_fields(const Span& span);

}  // namespace dlo::energy_model
