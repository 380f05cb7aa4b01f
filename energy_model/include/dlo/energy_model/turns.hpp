#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>

#include "dlo/energy_model/problem.hpp"

namespace dlo::energy_model {

/// First director from which the roll of a clamp's frame counts: unit and across the direction.
/// FrameHold::d1, or else that of the first clamp that holds the frame, carried here by the
/// shortest rotation of that clamp's direction into this one's: in a plane its normal stays the
/// normal. The first of all is free to choose on a round straight rod; of a rod with material
/// directors Problem says where it is.
/// @throws std::invalid_argument if the grip is no clamp with a frame, or if the two directions are
/// opposite and the line from clamp to clamp is along them, so that no plane says how to turn
[[nodiscard]] Eigen::Vector3d held_d1(const Problem& problem, const Grip& grip);

/// Turns that the frames of two clamps hold [-], by the grips alone: the angle in (-pi, pi] from
/// the first one's d1, carried as above, to the last one's, and the difference of their rolls. A
/// round straight rod between them has twist and writhe that add up to this (Calugareanu, White,
/// Fuller), unless it has passed through itself, which takes or gives two. None if the directions
/// are opposite and the line from clamp to clamp is along them.
/// @throws std::invalid_argument as held_d1()
[[nodiscard]] std::optional<double> held_turns(const Problem& problem, const Grip& first,
                                               const Grip& last);

/// Writhe of a curve that goes on straight at both ends, to where it closes in the plane of the end
/// tangents.
struct Writhe {
  /// In [-1, 1], by the tangents alone: Fuller's area on the sphere of tangents over 2 pi. It tells
  /// the homotopy class of the frames along the curve, even where the curve meets itself.
  double modulo_two = 0;
  /// Empty where the curve or a line beyond its ends passes through it: a passage changes the
  /// writhe by two.
  std::optional<double> value;
  double error = 0;  ///< estimate of the error of both [-]
};

/// Turns that frames at both ends of a rod hold.
struct HeldTurns {
  double roll = 0;  ///< of the end less the start's, whole turns counted [rad]
  /// held_turns(). Empty for an intrinsically curved rod whose later clamp has no d1: its roll
  /// counts from the rod as it lies without this frame, so that a rod that is coiled stays coiled.
  std::optional<double> turns;
};

/// Returns the turns that two neighbouring clamps hold. @throws std::invalid_argument as held_d1()
[[nodiscard]] HeldTurns turns_between(const Problem& problem, const Grip& first, const Grip& last);

/// Returns the angle by which the frame at the end has to be rotated from a shape that has not met
/// it [rad], so that the shape has the turns that are held; if only its writhe modulo two is known,
/// the smallest angle that leads into their homotopy class.
/// @param ahead   angle of the held d1, not rolled, from the shape's, up to whole turns [rad]
/// @param twist   of the shape [rad]
/// @param writhe  of the shape; empty: not known, `ahead` is taken in (-pi, pi]
[[nodiscard]] double turned_angle(const HeldTurns& held, double ahead, double twist,
                                  const std::optional<Writhe>& writhe);

/// Returns the writhe of a curve. If the curve or a line beyond its ends passes through it, as a
/// flat ring does, its writhe is that of either side, and the one nearer to `wanted` is returned.
[[nodiscard]] double nearest_writhe(const Writhe& writhe, double wanted);

/// Returns how many turns a shape lacks whose ends meet the frames: an even number, by two for each
/// passage through itself. Empty: an odd number, so that the frames along the shape are a path of
/// the other homotopy class. Returns 0 if the turns or the writhe are not known.
/// @param twist  of the shape [rad]
[[nodiscard]] std::optional<int> turns_lost(const HeldTurns& held, double twist,
                                            const std::optional<Writhe>& writhe);

/// Returns the writhe modulo two of a curve with these tangents, joined by great arcs: the rotation
/// of a frame without twist, lifted to unit quaternions, against the shortest rotation of the first
/// tangent into the last. Empty where these are opposite and the chord is along them.
/// @param tangents  3 x M, unit, M >= 2;  @param chord  from end to end, over the length
[[nodiscard]] std::optional<double> writhe_modulo_two(const Eigen::Matrix3Xd& tangents,
                                                      const Eigen::Vector3d& chord);

/// Returns the writhe of a polygon. That modulo two is exact; Gauss's integral (Klenin and
/// Langowski 2000, method 1a) says which of the numbers of this class it is. Empty as
/// writhe_modulo_two().
/// @param points  3 x M, M >= 2;  @param first, last  unit tangents of its ends
[[nodiscard]] std::optional<Writhe> writhe(const Eigen::Matrix3Xd& points,
                                           const Eigen::Vector3d& first,
                                           const Eigen::Vector3d& last);

/// Returns the writhe of a shape between two arc lengths [m], by polygons of more and more points
/// until its error is below 1e-7 or they have 2048.
[[nodiscard]] std::optional<Writhe> writhe(
    const std::function<Samples(std::span<const double> arc_lengths)>& sample, double begin,
    double end);

}  // namespace dlo::energy_model
