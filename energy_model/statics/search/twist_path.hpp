#pragma once

#include <optional>

#include "problem/split.hpp"
#include "span/span_solver.hpp"

namespace dlo::energy_model {

/// The end frame that holds a span's twist.
struct EndFrame {
  Eigen::Vector3d d1;  ///< Span::Twist::end_d1
  double twist;        ///< of the rod that has been twisted from the untwisted shape [rad]
};

/// A shape of a span, planar or not.
struct UntwistedShape {
  const SpanSolution& solution;
  Eigen::Vector3d end_d1;  ///< transported from Span::first_d1() at its start
  double twist;            ///< of a rod with material directors; else 0 [rad]
  std::optional<Writhe> writhe;
};

[[nodiscard]] UntwistedShape untwisted_shape(const SpanSolution& solution,
                                             SpanWorkspace& workspace);

/// Span::Twist::end_d1 of a span whose frames are held so.
[[nodiscard]] Eigen::Vector3d held_end_d1(const HeldFrames& held, const Span& span);

/// Where the later clamp holds d1, and how far that twists this shape, whole turns counted.
[[nodiscard]] EndFrame end_frame(const HeldFrames& held, const UntwistedShape& untwisted);

/// Turns the end of a stable shape until it meets the frame, by the angle nearest to `frame.twist`,
/// little by little, as a gripper would: each step by Newton's method from where the last two point
/// at, and where the shape has lost its stability or the branch has ended, downhill to the next
/// one. Certified, or `failed` or `time_limit` with the angle that it came to.
/// @param span       without twist
/// @param stiffness  GJ / EI
[[nodiscard]] SpanSolution twist_to(const EndFrame& frame, const Span& span, double stiffness,
                                    const UntwistedShape& untwisted, const SpanOptions& options,
                                    SpanWorkspace& workspace);

/// The equilibrium next to a twisted shape that is known, by its tangents and its twist.
[[nodiscard]] SpanSolution twist_from(const TangentField& field, const EndFrame& frame,
                                      const Span& span, double stiffness,
                                      const SpanOptions& options, SpanWorkspace& workspace);

}  // namespace dlo::energy_model
