#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>

#include "dlo/energy_model/problem.hpp"

namespace dlo::energy_model {

/// Returns the first director from which the roll of a clamp's frame is measured: unit and across
/// the direction. It is FrameHold::d1, or else d1 of the first clamp that holds the frame (of the
/// first clamp of a rod with material directors), transported by the shortest rotation of that
/// clamp's direction into this one's, which in a plane maps the normal to itself. If the first
/// clamp has no d1, it is arbitrary for a round straight rod; Problem defines it for a rod with
/// material directors.
/// @throws std::invalid_argument if the grip is no clamp with a frame, or if the two directions are
/// opposite and along the line from clamp to clamp, so that no plane determines the rotation; also
/// as first_frame(), if d1 of a rod with material directors is needed
[[nodiscard]] Eigen::Vector3d held_d1(const Problem& problem, const Grip& grip);

/// Returns the turns that the frames of two clamps prescribe [-], computed from the grips alone.
/// They are the angle in (-pi, pi] from d1 of the first, transported as in held_d1(), to d1 of the
/// last, plus the difference of their rolls, divided by 2 pi. Twist and writhe of a round straight
/// rod between the clamps add up to these turns (Calugareanu, White, Fuller), unless it has passed
/// through itself, which changes the sum by two. Returns std::nullopt if the directions are
/// opposite and along the line from clamp to clamp.
/// @throws std::invalid_argument as held_d1()
[[nodiscard]] std::optional<double> held_turns(const Problem& problem, const Grip& first,
                                               const Grip& last);

/// Writhe of a curve that is continued by straight lines at both ends, to where it closes in the
/// plane of the end tangents.
struct Writhe {
  /// Writhe modulo two, in [-1, 1], computed from the tangents alone: Fuller's area on the sphere
  /// of tangents divided by 2 pi. It determines the homotopy class of the frames along the curve,
  /// even if the curve intersects itself.
  double modulo_two = 0;
  /// Writhe. Empty if the curve or a line beyond its ends passes through the curve or too close to
  /// it: a passage changes the writhe by two.
  std::optional<double> value;
  double error = 0;  ///< estimated error of both values [-]
};

/// Rotation of the frames that clamps at both ends of a rod hold.
struct HeldTurns {
  double roll = 0;  ///< roll of the end minus roll of the start, whole turns counted [rad]
  /// Result of held_turns() [-]. Empty for a rod with Problem::natural_strains whose later clamp
  /// has no d1: its roll is measured from the rod's shape without this frame, so that a coiled rod
  /// stays coiled. Also empty if held_turns() is.
  std::optional<double> turns;
};

/// Returns the turns that two neighbouring clamps prescribe.
/// @throws std::invalid_argument as held_d1()
[[nodiscard]] HeldTurns prescribed_turns(const Problem& problem, const Grip& first,
                                         const Grip& last);

/// Returns the angle by which the frame at the end of a shape that ignores the end frame has to be
/// rotated [rad], so that the shape has the prescribed turns. If only its writhe modulo two is
/// known, this is the smaller of the angles for the two writhes in [-2, 2].
/// @param frame_angle  angle from the shape's d1 to the prescribed d1 without roll, up to whole
///                     turns [rad]
/// @param twist   twist of the shape [rad]
/// @param writhe  writhe of the shape. If it or HeldTurns::turns is empty, the result is
///                `frame_angle` reduced to (-pi, pi] plus HeldTurns::roll
[[nodiscard]] double end_rotation(const HeldTurns& held, double frame_angle, double twist,
                                  const std::optional<Writhe>& writhe);

/// Returns the writhe of a curve. If the curve or a line beyond its ends passes through it, as for
/// a flat ring, the writhe has one value on either side of the passage, and the one nearer to
/// `wanted` is returned.
[[nodiscard]] double nearest_writhe(const Writhe& writhe, double wanted);

/// Returns the number of turns that are missing in a shape whose ends have the prescribed frames:
/// an even number, two for each passage through itself. Empty if the number is odd, so that the
/// frames along the shape belong to the other homotopy class. Returns 0 if the turns or the writhe
/// are unknown.
/// @param twist  twist of the shape [rad]
[[nodiscard]] std::optional<int> missing_turns(const HeldTurns& held, double twist,
                                               const std::optional<Writhe>& writhe);

/// Returns the writhe modulo two of a curve with these tangents, joined by great arcs. It compares
/// the rotation of a frame without twist, lifted to unit quaternions, with the shortest rotation of
/// the first tangent into the last. Empty if these two are opposite and along the chord.
/// @param tangents  unit vectors, 3 x M, M >= 2
/// @param chord     vector from end to end, divided by the length
[[nodiscard]] std::optional<double> writhe_modulo_two(const Eigen::Matrix3Xd& tangents,
                                                      const Eigen::Vector3d& chord);

/// Returns the writhe of a polygon. Its value modulo two is exact. The number of this class is
/// selected by Fuller's area if all tangents are within 90 deg of the middle of the end tangents,
/// else by Gauss's integral (Klenin and Langowski 2000, method 1a). Empty as writhe_modulo_two().
/// @param points  3 x M, M >= 2
/// @param first, last  unit tangents at the ends
[[nodiscard]] std::optional<Writhe> writhe(const Eigen::Matrix3Xd& points,
                                           const Eigen::Vector3d& first,
                                           const Eigen::Vector3d& last);

/// Returns the writhe of a shape between two arc lengths [m], from polygons with 64, 128, ...
/// segments until its error is below 1e-7 and its crossings are known, or until 2048 segments are
/// reached. Empty as writhe_modulo_two().
[[nodiscard]] std::optional<Writhe> writhe(
    const std::function<Samples(std::span<const double> arc_lengths)>& sample, double begin,
    double end);

}  // namespace dlo::energy_model
