#pragma once

#include <optional>

#include "problem/split.hpp"
#include "span/span_solver.hpp"

namespace dlo::energy_model {

/// Number of coefficients with which a shape is described first if only its tangents are known.
inline constexpr int unknown_terms = 24;

/// The end frame that prescribes a span's twist.
struct EndFrame {
  Eigen::Vector3d d1;  ///< see Span::Twist::end_d1
  /// Twist [rad]: relative to the untwisted shape for twist_to(), SpanEnergy::twist() for
  /// twist_from().
  double twist;
};

/// A shape of a span without prescribed twist, planar or not.
struct UntwistedShape {
  const SpanSolution& solution;
  /// d1 at the end of the frame that has Span::first_d1() at the start: the rod's own frame for a
  /// rod with material directors, otherwise one transported without twist.
  Eigen::Vector3d end_d1;
  double twist;  ///< twist of a rod with material directors; else 0 [rad]
  std::optional<Writhe> writhe;
};

[[nodiscard]] UntwistedShape untwisted_shape(const SpanSolution& solution,
                                             SpanWorkspace& workspace);

/// Returns Span::Twist::end_d1 of a span with these prescribed frames.
[[nodiscard]] Eigen::Vector3d prescribed_end_d1(const HeldFrames& held, const Span& span);

/// Returns d1 of the later clamp, and the angle by which it twists this shape, with whole turns.
[[nodiscard]] EndFrame end_frame(const HeldFrames& held, const UntwistedShape& untwisted);

/// Rotates the end of a stable shape in small steps until it meets the frame, by the angle nearest
/// to `frame.twist`, as a gripper would. Each step is solved by Newton's method from the
/// extrapolation of the last two shapes. If the shape has become unstable or the branch has ended,
/// a descent leads to the next stable one. The result is certified, or `time_limit`, or `failed`
/// with the angle that was reached.
/// @param span       without twist
/// @param stiffness  GJ / EI
[[nodiscard]] SpanSolution twist_to(const EndFrame& frame, const Span& span, double stiffness,
                                    const UntwistedShape& untwisted, const SpanOptions& options,
                                    SpanWorkspace& workspace);

/// Solves for the equilibrium near a known twisted shape, given by its tangents and its twist. The
/// result is certified if Newton's method converges.
[[nodiscard]] SpanSolution twist_from(const TangentField& field, const EndFrame& frame,
                                      const Span& span, double stiffness,
                                      const SpanOptions& options, SpanWorkspace& workspace);

}  // namespace dlo::energy_model
