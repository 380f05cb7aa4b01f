#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "dlo/compare/choice.hpp"
#include "dlo/compare/progress.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/solution.hpp"
#include "dlo/energy_model/equilibrium.hpp"
#include "motion/force_track.hpp"

namespace dlo::compare {

/// A contact that begins, ends or changes its kind from one frame to the next.
struct ContactChange {
  bool begins = true;  ///< whether contact begins, or a point contact becomes a line contact
  energy_model::ContactPart part;  ///< the contact after the change; if it ends, before the change
  bool contact_persists = false;   ///< whether the contact existed before, or continues to exist
};

/// Returns the changes from the contacts of one frame to those of the next. Contacts on one
/// obstacle are paired in the order of their arc lengths, the nearest ones if their numbers differ.
/// If a point contact becomes a line contact, the change begins and goes on; in the opposite case
/// it ends and goes on. A change between the rod's tip and its inside begins and goes on.
/// @param before, after  in the order of arc lengths
[[nodiscard]] std::vector<ContactChange> contact_changes(
    const std::vector<energy_model::ContactPart>& before,
    const std::vector<energy_model::ContactPart>& after);

/// Interval of a scene's motion, and how it is sampled.
struct TrackOptions {
  std::optional<double> from;  ///< [s]; empty: as MotionPart::from
  std::optional<double> to;    ///< [s], > from; empty: time of the last pose
  TrackRates rates;
  ForceModelRun force = ForceModelRun::runs;
  int samples = 41;  ///< points of a frame's shape, >= 2
  SolveOptions solve;
};

/// The rod in equilibrium at one time: the solution by `energy`, at Track::arc_length. The zeros of
/// gravity and loads are at the origin, which does not move; `seconds` is the duration of the
/// computation.
struct TrackFrame : Solution {
  double time = 0;        ///< [s]
  bool followed = false;  ///< whether the rod stayed on its branch; true in the first frame
  double work = 0;        ///< work of grippers and obstacles on the rod, since the first frame [J]
  /// Work since the frame before minus the increase of the energy, in a frame in which the rod left
  /// its branch only of the jumps, and the bound of its error by forces between those before and
  /// after each step [J]. `released` is NaN if Branch::has_energy_balance() is false.
  double released = 0, released_bound = 0;
  std::optional<ForceFrame> force;
};

/// A change of the contacts, or a jump to another branch.
struct TrackEvent {
  /// Kinds of events.
  enum class Kind {
    contact,  ///< contact begins, or a point contact becomes a line contact
    release,  ///< contact ends, or a line contact becomes a point contact
    snap,     ///< the branch ended, and the rod snapped through to another shape
    lost,     ///< the shape jumped, but no end of the branch was observed
  };
  Kind kind = Kind::contact;
  std::size_t frame = 0;                 ///< first frame after the event
  std::optional<ContactChange> contact;  ///< for a contact or a release
  /// Energy released by a snap-through or a loss [J].
  double released = std::numeric_limits<double>::quiet_NaN();
  double released_bound = 0;  ///< bound of the error of `released` [J]
  /// Smallest eigenvalue of the last shape on the branch, before the event [-].
  double smallest_eigenvalue = std::numeric_limits<double>::quiet_NaN();
};

/// Names of the kinds of events in files.
template <>
struct Choices<TrackEvent::Kind> {
  /// All values, in the order of the enumeration.
  static constexpr Choice<TrackEvent::Kind> all[] = {{TrackEvent::Kind::contact, "contact", ""},
                                                     {TrackEvent::Kind::release, "release", ""},
                                                     {TrackEvent::Kind::snap, "snap", ""},
                                                     {TrackEvent::Kind::lost, "lost", ""}};
};

/// Reason for missing frames.
struct TrackStop {
  double time = 0;  ///< time of the first frame without a shape [s]
  std::string why;
};

/// Quasi-static motion of a scene's rod.
struct Track {
  std::vector<double> arc_length;  ///< arc lengths of the frames' points [m]
  std::vector<TrackFrame> frames;  ///< up to the one at which it stopped; one or more
  std::vector<TrackEvent> events;  ///< by time
  std::optional<TrackStop> stopped;
  /// Median duration of a frame of the energy model in which something moves, without the first
  /// frame unless there is no other [s].
  double median_seconds = 0;
  /// Number of frames in which the branch was not kept; their shape is on another branch or on the
  /// same one.
  int lost_frames = 0;
  int repeated_frames = 0;  ///< number of frames that needed smaller steps on the branch
  ForceTrackSummary force;
};

/// Follows the energy model's shape through a scene's motion: the first frame has the lowest shape
/// that is found, all others follow its branch (Branch) as long as it exists. After a jump to a
/// lower shape, more energy is missing than any forces between those before and after could do. It
/// is a snap only if the end of the branch was observed; otherwise the solver may have lost the
/// branch. The force model makes its steps of each frame as well, starting at rest.
///
/// The track ends early (stopped) at an invalid frame, such as one with grippers farther apart than
/// the rod between them. It also ends if a solver does not converge, if it finds a shape with more
/// energy than the work allows, or if the rod passes through itself (Linking).
/// @throws InputError if nothing moves, no time passes, there are too many frames or points, or the
/// first frame is invalid; ConvergenceError if the first frame has no shape or one that has lost
/// turns
[[nodiscard]] Track track(const Scene& scene, const TrackOptions& options,
                          const Progress& progress = {});

}  // namespace dlo::compare
