#pragma once

#include <Eigen/Core>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "frames/piece.hpp"
#include "problem/span.hpp"

namespace dlo::energy_model {

/// Divides a span into elements: at kink_positions(), at the ends of Span::contacts, at
/// Span::contact_ends and at Span::cuts. Without cuts it is also divided where boundary layers have
/// decayed by exp(-6) and exp(-24), so that no element has to resolve a whole layer: those at the
/// start and a clamped end of a soft rod, at ends and loads of taut segments and beside contacts.
[[nodiscard]] std::vector<Element> elements_of(const Span& span);

/// Smallest distance of two element boundaries; a shorter element could not have a curvature of its
/// own.
inline constexpr double closest_cuts = 1e-9;

/// Adds element boundaries on one side of the origin of a layer where the layer has decayed by
/// exp(-6) and exp(-24), each if the distance to the next feature exceeds 2.5 times its own.
/// @param layer  length (EI / force)^(1/2); 0: there is no layer
void add_cut_beside(double origin, double sense, double layer, double room,
                    std::vector<double>& cuts);

/// Whether a grip holds the span at s.
[[nodiscard]] inline bool is_held(const Span& span, double s) {
  return span.held_within(s, s, closest_cuts) != HeldBy::nothing;
}

/// Returns the arc lengths where strains may have kinks, ascending: ends, grips, loads, ends of
/// line loads and section changes. Of those closer than `closest_cuts` the first one is returned.
[[nodiscard]] std::vector<double> kink_positions(const Span& span);

/// A shape as initial guess, at given arc lengths in ascending order.
struct StartShape {
  Eigen::Matrix3Xd tangents;
  /// Angle of the rod's own frame relative to Bishop's [rad], for rods with material directors;
  /// empty: zero everywhere.
  Eigen::VectorXd roll;
  /// Twist of a rod without material directors whose end frames are clamped [rad].
  double twist = 0;

  StartShape() = default;
  // NOLINTNEXTLINE(google-explicit-constructor): tangents are most of what a start is
  StartShape(Eigen::Matrix3Xd along, Eigen::VectorXd roll_angles = {})
      : tangents(std::move(along)), roll(std::move(roll_angles)) {}
};

/// Function that returns a shape, as initial guess, at M arc lengths of a span.
using TangentField = std::function<StartShape(const Eigen::VectorXd&)>;

/// Returns the angle of d1 relative to a frame that does not rotate about the tangents, from the
/// first point on [rad]. Between two points the tangent must rotate by less than pi, and so must
/// d1.
[[nodiscard]] Eigen::VectorXd roll_of(const Eigen::Matrix3Xd& tangents, const Eigen::Matrix3Xd& d1);

/// Shape of a span: the angle at the start or, in space, the start's frame, and the unknowns of
/// PlanarFrames or RodFrames.
struct SpanShape {
  int terms = 0;
  bool planar = true;
  double anchor = 0;
  std::vector<Element> elements;
  double start_theta = 0;  ///< in the plane, with the rotation of a free start [rad]
  Eigen::Matrix3d start_frame = Eigen::Matrix3d::Identity();  ///< without a free start's rotation
  bool free_start = false;
  Eigen::VectorXd strains;
  NaturalStrains natural;

  /// Returns samples in the span's units and frame, relative to the anchor; `arc_length` is empty.
  /// `d1` are the first directors of the rod's own frames or, without material directors, of
  /// Bishop's frames: Span::first_d1() at a clamped start. In the plane they are z.
  [[nodiscard]] Samples sample(std::span<const double> s) const;
};

}  // namespace dlo::energy_model
