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

/// Whether the motion of a rod is restricted to its plane.
enum class Motion { in_plane, in_space };

/// Part of a rod that is solved separately: between two clamps, between a clamp and a free end, or
/// the whole rod. Lengths are in l, forces in EI/l^2. s is the arc length from the begin of the
/// span, and positions are relative to the problem's first grip.
struct RodSpan {
  struct Hold {
    double at = 0;  ///< s
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    std::size_t grip = 0;  ///< index in Problem::grips
  };
  struct Load {
    double at = 0;  ///< s
    Eigen::Vector3d force = Eigen::Vector3d::Zero();
    Eigen::Vector3d couple = Eigen::Vector3d::Zero();
    /// Whether force and couple are given along d1, d2 and t at the load, and follow them.
    bool follows = false;
  };
  /// An interval with one section.
  struct Part {
    double begin = 0;  ///< s
    double end = 0;    ///< s
    RodSection section;
  };
  /// Frame that a clamp holds if an earlier clamp holds a frame too.
  struct Frame {
    Eigen::Vector3d d1;  ///< unit vector across the direction, without roll
    HeldTurns turns;     ///< turns from the first clamp to this one
  };
  struct Clamp {
    double at = 0;                                         ///< s
    Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< unit
    std::optional<Frame> frame;
  };
  double begin = 0;  ///< arc length of s = 0, in l
  double length = 1;
  std::vector<Part> parts;  ///< parts by growing s, from 0 to the span's length
  std::vector<Hold> holds;  ///< grips by growing s, those of the clamps included
  /// Clamps by growing s; at the ends of a rod that is cut at its clamps.
  std::vector<Clamp> clamps;
  std::vector<Load> loads;  ///< loads by growing s; none on clamps
  NaturalStrain natural;    ///< natural strains; empty: straight
  /// Plane of grips and forces, if they share one and the rod bends in it. Its normal is the second
  /// axis of a rod that is not round().
  std::optional<Plane> plane;
  /// Frame that the first clamp holds. It is arbitrary about the tangent for a rod that is round(),
  /// not twisted() and without has_axes.
  Eigen::Matrix3d first_frame = Eigen::Matrix3d::Identity();
  bool has_potential = true;  ///< whether all loads have one; set by whole_span_with_axes() only
  bool has_axes = false;      ///< whether a load follows d1 or d2 of a rod that is round()
  /// Roll that first_frame contains [rad]; zero for a rod that is cut at its clamps.
  double first_roll = 0;

  /// Returns the clamp at s; null if there is none.
  [[nodiscard]] const Clamp* clamp_at(double s) const;
  /// Whether a clamp after the first one holds the rod's frame, so that a torque twists the rod.
  [[nodiscard]] bool twisted() const;
  [[nodiscard]] bool has_couples() const;
  /// Whether all sections are round and the rod is intrinsically straight: without twist its energy
  /// does not depend on the rotation of sections about their tangents.
  [[nodiscard]] bool round() const;
};

/// Frame that each clamp of a span holds; empty: the frame rotates freely about the clamp's
/// direction.
using ClampFrames = std::vector<std::optional<Eigen::Matrix3d>>;

/// Returns the held frames if those after the first clamp are released.
[[nodiscard]] ClampFrames released_frames(const RodSpan& span);

/// Returns the frames that the clamps prescribe by d1 and roll.
[[nodiscard]] ClampFrames held_frames(const RodSpan& span);

/// Returns the span with all frames of clamps released, except that of the first clamp.
[[nodiscard]] RodSpan without_frames(RodSpan span);

/// Cuts a problem at its clamps, as for a round rod that is intrinsically straight. Grips within
/// 1e-9 l of an end of the rod are moved to that end. Obstacles are ignored.
/// @throws std::invalid_argument if the problem is out of range, or as ordered_grips()
[[nodiscard]] std::vector<RodSpan> cut_at_clamps(const Problem& problem);

/// Returns the whole rod as one span with its clamps. Obstacles are ignored, and loads on clamps
/// are carried by the gripper.
/// @throws std::invalid_argument if the problem is out of range, or the frame of the first clamp of
/// a rod with material directors is undetermined, or as ordered_grips()
[[nodiscard]] RodSpan whole_span(const Problem& problem);

/// Returns the whole of a rod with material directors as one span, with its natural strains and its
/// plane. Its torque passes through clamps that do not hold the frame.
/// @throws std::invalid_argument as whole_span()
[[nodiscard]] RodSpan whole_directed_span(const Problem& problem);

/// Returns the whole rod as whole_directed_span() or whole_span() does, for loads without a
/// potential, with its plane. If loads follow d1 or d2 of a round rod, the frame of the first clamp
/// is that in which they are given.
/// @throws std::invalid_argument as whole_directed_span(), or if a load follows a round rod along
/// d1 or d2 and there is no clamp, d1 is undetermined, or the rod leaves a plane without a
/// torsional_stiffness
[[nodiscard]] RodSpan whole_span_with_axes(const Problem& problem);

/// Returns natural strains at count + 1 equally spaced points and in the middle of each part; empty
/// for a straight rod.
[[nodiscard]] std::vector<Eigen::Vector3d> sample_natural_strains(const RodSpan& span, int count);

/// Returns the section at s; where two meet, the later one.
[[nodiscard]] const RodSection& section_at(const RodSpan& span, double s);

/// Returns the length of intervals that resolves boundary layers under a force over b, and the
/// bends of a span without layers.
[[nodiscard]] double longest_interval(const RodSpan& span, double force);

/// Returns the least bending stiffness of a span, about either axis.
[[nodiscard]] double least_bending_stiffness(const RodSpan& span);

/// Returns the span with its drag, the loads that follow it and all couples multiplied by a factor.
[[nodiscard]] RodSpan scale_nonpotential_loads(RodSpan span, double factor);

/// Returns the sum of the norms of weight and loads. Drag counts with Drag::largest(), a couple
/// divided by the length of the span.
[[nodiscard]] double total_load(const RodSpan& span);

}  // namespace dlo::energy_model
