#pragma once

#include <vector>

#include "frames/span_shape.hpp"
#include "problem/span.hpp"

namespace dlo::energy_model {

/// Shapes that a span's equilibria are searched from, physically chosen: without further grips the
/// pendulum's profile that turns from the clamp to the load, either way round, down onto an
/// obstacle and along it, and past bodies on either side; between grips arches and S-shapes of the
/// right slack to either side, and loops. Of each pair the one that the load favours comes first.
[[nodiscard]] std::vector<TangentField> start_fields(const Span& span);

/// The pendulum's profile 4 atan(tan(psi/4) exp(-sqrt(n) s)) from a clamp towards the sum n of
/// weight and loads by the shorter way: the limit shape of a soft rod.
[[nodiscard]] TangentField soft_field(const Span& span);

/// A shape through a span's grips, one or more beside the anchor: arches of the right slack that
/// hang as the load pulls, and beyond the outermost grips the pendulum's profile.
/// @param span  has to outlive it
[[nodiscard]] TangentField arch_field(const Span& span);

/// Of a rod with material directors: the stress-free shape, and in the plane bent evenly to the
/// directions of its end's clamp next to where it points; and the shapes of start_fields(), in
/// space each with the rod's frame turned on evenly from the start to several angles. Where the
/// frame at the end is held too, these shapes with frames that are rotated on evenly until they
/// meet it, by the two angles of the class of Span::Twist::turns that are nearest to zero.
[[nodiscard]] std::vector<TangentField> natural_fields(const Span& span);

}  // namespace dlo::energy_model
