#pragma once

#include <optional>

#include "span_solver.hpp"
#include "split.hpp"

namespace dlo::energy_model {

/// The end frame that holds a span's twist.
struct EndFrame {
  Eigen::Vector3d d1;  ///< Span::Twist::end_d1
  double twist;        ///< of the rod that has been twisted from the untwisted shape [rad]
};

/// d1 at the end where both clamps say where d1 is, whatever the shape: Span::Twist::end_d1.
[[nodiscard]] std::optional<Eigen::Vector3d> known_end_d1(const HeldFrames& held, const Span& span);

/// Where the later clamp holds d1, and how far that twists this untwisted shape of the span, whole
/// turns counted.
[[nodiscard]] EndFrame end_frame(const HeldFrames& held, const SpanSolution& untwisted);

/// Of another untwisted shape the twist nearest to `frame.twist` that makes its end meet the frame.
[[nodiscard]] double twist_to(const EndFrame& frame, const SpanSolution& untwisted);

/// Turns the end of an untwisted, stable shape by this angle, little by little, as a gripper would:
/// each step by Newton's method from where the last two point at, and where the shape has lost its
/// stability or the branch has ended, downhill to the next one. Ends with few terms, stable, or as
/// `failed` or `time_limit` with the angle that it came to.
/// @param span  of the untwisted shape, planar or not
[[nodiscard]] SpanSolution twist_by(double angle, const Span& span, const HeldFrames& held,
                                    const SpanSolution& untwisted, const SpanOptions& options,
                                    SpanWorkspace& workspace);

/// The equilibrium next to a twisted shape that is known: its tangents, and its twist, whole turns
/// counted.
/// @param end_d1  where the end's clamp holds d1; none: where the shape has it
[[nodiscard]] SpanSolution twist_from(const TangentField& field, double twist,
                                      const std::optional<Eigen::Vector3d>& end_d1,
                                      const Span& span, double stiffness,
                                      const SpanOptions& options, SpanWorkspace& workspace);

}  // namespace dlo::energy_model
