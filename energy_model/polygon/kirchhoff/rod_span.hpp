#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "dlo/energy_model/plane.hpp"
#include "dlo/energy_model/problem.hpp"
#include "dlo/energy_model/turns.hpp"
#include "kirchhoff/rod_state.hpp"

namespace dlo::energy_model {

/// Whether a rod keeps to its plane.
enum class Motion { in_plane, in_space };

/// A piece of rod between two clamps, or between a clamp and a free end, or all of it. Lengths in
/// l, forces in EI/l^2; s runs along the arc length from the piece's beginning, positions are
/// relative to the problem's first grip.
struct RodSpan {
  struct Hold {
    double at = 0;  ///< s
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    std::size_t grip = 0;  ///< in Problem::grips
  };
  struct Load {
    double at = 0;  ///< s
    Eigen::Vector3d force = Eigen::Vector3d::Zero();
    Eigen::Vector3d couple = Eigen::Vector3d::Zero();
    bool follows = false;  ///< both are along d1, d2 and t there
  };
  /// Of one section.
  struct Part {
    double begin = 0;  ///< s
    double end = 0;    ///< s
    RodSection section;
  };
  /// Of a clamp that holds the rod's frame, after one that does so too.
  struct Frame {
    Eigen::Vector3d d1;  ///< across the direction, unit, not rolled
    HeldTurns turns;     ///< from the first clamp on
  };
  struct Clamp {
    double at = 0;                                         ///< s
    Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< unit
    std::optional<Frame> frame;
  };
  double begin = 0;  ///< arc length of s = 0
  double length = 1;
  std::vector<Part> parts;    ///< by growing s, from 0 to its length
  std::vector<Hold> holds;    ///< by growing s, those of the clamps included
  std::vector<Clamp> clamps;  ///< by growing s; of a rod that is cut, at its ends
  std::vector<Load> loads;    ///< by growing s; none on clamps
  NaturalStrain natural;      ///< none: straight
  /// If grips and forces lie in one, and the rod bends in it: its normal is the second axis of a
  /// rod that is not round().
  std::optional<Plane> plane;
  /// That the first clamp holds; of a rod that is round() and not twisted() any one will do.
  Eigen::Matrix3d first_frame = Eigen::Matrix3d::Identity();
  bool has_potential = true;  ///< of its loads
  bool has_axes = false;      ///< a load follows d1 or d2, round or not
  double first_roll = 0;      ///< of that frame, which contains it; zero of a rod that is cut [rad]

  /// Null: no clamp there.
  [[nodiscard]] const Clamp* clamp_at(double s) const;
  /// Whether a clamp after the first one holds the rod's frame, so that torque twists it.
  [[nodiscard]] bool twisted() const;
  [[nodiscard]] bool has_couples() const;
  /// Whether all sections are round and the rod is intrinsically straight: without twist a turn of
  /// its sections about their tangents changes nothing.
  [[nodiscard]] bool round() const;
};

/// Rotations at the clamps of a span, one each; none: the frame rotates freely around the
/// direction.
using ClampFrames = std::vector<std::optional<Eigen::Matrix3d>>;

/// The frames that are held if those after the first clamp are released.
[[nodiscard]] ClampFrames released_frames(const RodSpan& span);

/// The frames that the directors of its clamps say, with all of their roll.
[[nodiscard]] ClampFrames held_frames(const RodSpan& span);

/// The span whose clamps after the first one hold no frame.
[[nodiscard]] RodSpan without_frames(RodSpan span);

/// Cuts a problem at its clamps, as one of a round rod that is intrinsically straight. Grips within
/// 1e-9 l of an end of the rod are at that end.
/// @throws std::invalid_argument if the problem is out of range, has obstacles, or grips are
/// further apart than the rod between them
[[nodiscard]] std::vector<RodSpan> cut_at_clamps(const Problem& problem);

/// All of the rod as one span with its clamps, of any obstacles; loads on them are the gripper's.
/// @throws std::invalid_argument if the problem is out of range, or the frame of the first clamp of
/// a rod with material directors is not known
[[nodiscard]] RodSpan whole(const Problem& problem);

/// The same of a rod with material directors, whose torque passes through clamps that do not hold
/// the frame, with its natural strains and its plane.
/// @throws std::invalid_argument as whole(), or if there are obstacles
[[nodiscard]] RodSpan uncut(const Problem& problem);

/// All of a rod, as uncut() or whole() says, for loads without a potential: the frame of the first
/// clamp is that which such loads count from, round or not.
/// @throws std::invalid_argument as uncut(), or if a load follows a rod along a d1 that nobody
/// knows
[[nodiscard]] RodSpan with_own_axes(const Problem& problem);

/// Natural strains at places that are `count` equal lengths apart, and in the middle of each part:
/// none of a straight rod.
[[nodiscard]] std::vector<Eigen::Vector3d> natural_probes(const RodSpan& span, int count);

/// The section at s; of two that meet there the one after it.
[[nodiscard]] const RodSection& section_at(const RodSpan& span, double s);

/// Intervals that resolve boundary layers under a force over b, and the bends of a span without
/// any.
[[nodiscard]] double longest_interval(const RodSpan& span, double force);

/// Least bending stiffness of a span, about either axis.
[[nodiscard]] double least_bending_stiffness(const RodSpan& span);

/// The span with its drag and what follows it, and all couples, times a factor.
[[nodiscard]] RodSpan loaded_by(RodSpan span, double factor);

/// Sum of the norms of weight and loads.
[[nodiscard]] double total_load(const RodSpan& span);

}  // namespace dlo::energy_model
