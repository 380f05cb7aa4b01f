#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "dlo/compare/choice.hpp"
#include "dlo/compare/progress.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/solution.hpp"
#include "motion/contact_events.hpp"
#include "motion/force_track.hpp"

namespace dlo::compare {

/// Which part of a scene's motion, and how it is looked at.
struct TrackOptions {
  std::optional<double> from;  ///< [s]; none: the first pose's time
  std::optional<double> to;    ///< [s], > from; none: the last pose's
  TrackRates rates;
  ForceBeside force = ForceBeside::runs;
  int samples = 41;  ///< points of a frame's shape, >= 2
  SolveOptions solve;
};

/// The rod at one time, at rest: its solution by `energy`, at Track::arc_length. Gravity and loads
/// are zero at the origin, which does not move; `seconds` is what the frame took.
struct TrackFrame : Solution {
  double time = 0;        ///< [s]
  bool followed = false;  ///< on the branch of the frame before
  double work = 0;        ///< of grippers and obstacles on the rod, since the first frame [J]
  /// That work since the frame before less what the energy has grown by, and what it may be with
  /// forces between those of the two frames [J]. NaN where Branch::balances() is false.
  double released = 0, released_bound = 0;
  std::optional<ForceFrame> force;
};

/// A change of what touches, or a snap-through to another shape.
struct TrackEvent {
  /// What has happened.
  enum class Kind {
    contact,  ///< something begins to touch, or to lie
    release,  ///< something ends to
    snap,     ///< the branch has ended, and the shape has snapped to another one
    lost,     ///< so has the shape, but the branch has not been seen to end
  };
  Kind kind = Kind::contact;
  std::size_t frame = 0;                                       ///< the first with it
  std::optional<ContactChange> contact;                        ///< of a contact or a release
  double released = std::numeric_limits<double>::quiet_NaN();  ///< by a snap-through [J]
  double released_bound = 0;                                   ///< by which that may be off [J]
  /// Of the last shape on the branch, before that [-].
  double smallest_eigenvalue = std::numeric_limits<double>::quiet_NaN();
};

/// In words, for files.
template <>
struct Choices<TrackEvent::Kind> {
  /// In the enumeration's order.
  static constexpr Choice<TrackEvent::Kind> all[] = {{TrackEvent::Kind::contact, "contact", ""},
                                                     {TrackEvent::Kind::release, "release", ""},
                                                     {TrackEvent::Kind::snap, "snap", ""},
                                                     {TrackEvent::Kind::lost, "lost", ""}};
};

/// Why frames are missing.
struct TrackStop {
  double time = 0;  ///< of the frame that has no shape [s]
  std::string why;
};

/// A scene's motion so slow that the rod is at rest all the time.
struct Track {
  std::vector<double> arc_length;  ///< of the frames' points [m]
  std::vector<TrackFrame> frames;  ///< up to where it had to stop; one or more
  std::vector<TrackEvent> events;  ///< by time
  std::optional<TrackStop> stopped;
  double median_seconds = 0;  ///< of a frame of the energy model in which something moves
  int lost = 0;      ///< frames whose shape was searched for, on another branch or on the same
  int repeated = 0;  ///< frames to which the branch was kept in smaller steps only
  std::vector<std::string> neglected;  ///< as Solution::neglected
  ForceTrackSummary force;
};

/// Follows the energy model's shape through a scene's motion: the first frame has the lowest shape
/// that is found, all others its branch (Branch), as long as there is one. Where the shape has
/// snapped to a lower one, more energy is missing than any forces between those before and after
/// could do; that is a snap only if the branch has shown its end, else the solver may have lost it.
/// The force model makes its steps of each frame beside it, from rest.
///
/// What is impossible, such as grippers farther apart than the rod between them, ends it (stopped),
/// and so does a solver that does not converge, or that comes out on a shape which is higher than
/// the work allows, or a rod that passes through itself (Linking).
/// @throws InputError if nothing moves, the time is no part of the motion, or the first frame is
/// impossible; ConvergenceError if the first frame has no shape or one that has lost turns
[[nodiscard]] Track track(const Scene& scene, const TrackOptions& options,
                          const Progress& progress = {});

}  // namespace dlo::compare
