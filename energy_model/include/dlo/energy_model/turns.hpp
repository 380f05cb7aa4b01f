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

/// What frames at both ends of a rod ask of its twist.
struct HeldTurns {
  double roll = 0;  ///< of the end less the start's, whole turns counted [rad]
  /// held_turns() of a rod that is intrinsically straight. None: of the turns that the frames leave
  /// open, those nearest to the rod without them; so what is intrinsically coiled stays coiled.
  std::optional<double> turns;
};

/// @throws std::invalid_argument as held_d1()
[[nodiscard]] HeldTurns turns_between(const Problem& problem, const Grip& first, const Grip& last);

/// The angle by which the frame at the end turns the rod from a shape without twist [rad].
/// @param ahead   of the end's d1, not rolled, from where that shape has it, up to whole turns
/// [rad]
/// @param writhe  of that shape; none: not known, `ahead` is taken in (-pi, pi]
[[nodiscard]] double turned_angle(const HeldTurns& held, double ahead,
                                  std::optional<double> writhe);

/// Whether a shape has the turns that are held, as far as that can be told.
/// @param twist  of the shape [rad]
[[nodiscard]] bool holds_turns(const HeldTurns& held, double twist, std::optional<double> writhe);

/// Writhe [-] of a polygon that goes on straight at both ends, to where it closes in the plane of
/// the end tangents. Exact: Fuller's area on the sphere of tangents where these keep to one side of
/// it, Gauss's integral elsewhere (Klenin and Langowski 2000, method 1a). None where an end's line
/// passes through the polygon.
/// @param points  3 x M, M >= 2;  @param first, last  unit tangents of its ends
[[nodiscard]] std::optional<double> writhe(const Eigen::Matrix3Xd& points,
                                           const Eigen::Vector3d& first,
                                           const Eigen::Vector3d& last);

/// The same of a shape between two arc lengths [m], by polygons of more and more points until it is
/// known to 0.01. None where it is for no polygon of at most 1024 points.
[[nodiscard]] std::optional<double> writhe(
    const std::function<Samples(std::span<const double> arc_lengths)>& sample, double begin,
    double end);

}  // namespace dlo::energy_model
