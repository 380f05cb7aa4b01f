#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "dlo/compare/scene.hpp"
#include "dlo/energy_model/dynamics.hpp"
#include "motion/moving_scene.hpp"
#include "motion/track.hpp"

namespace dlo::compare {

/// The moving rod at the time of a frame of a Track.
struct DynamicFrame {
  double time = 0;  ///< [s]
  /// Gravity and loads are zero where the track's are.
  energy_model::EnergyBalance energy;
  std::vector<GripperLoad> grippers;       ///< in the scene's order
  std::vector<Eigen::Vector3d> obstacles;  ///< force of each on the rod, in the scene's order [N]
  Eigen::Matrix3Xd points;                 ///< at Track::arc_length [m]
  double quasi_static_error = 0;      ///< RMS distance of the track's shape over the length [-]
  std::optional<double> force_error;  ///< the same of the force model's, at its own points [-]
};

/// What the errors of all frames come to.
struct TrackErrors {
  double mean = 0;          ///< over the length [-]
  double largest = 0;       ///< over the length [-]
  double largest_time = 0;  ///< [s]
};

/// A Track's rod with inertia.
struct DynamicTrack {
  RodDamping damping;
  bool in_motion = false;            ///< at the first frame, where something has a velocity
  std::vector<DynamicFrame> frames;  ///< of the track's frames, up to where it had to stop
  std::optional<TrackStop> stopped;  ///< also where the track itself has no more frames
  int terms = 0;                     ///< of each piece and field
  std::optional<TooFewTerms> too_few_terms;
  long steps = 0;      ///< of the integrator
  double seconds = 0;  ///< what it took, without the run with fewer terms
  /// Largest residual of the energy balance, over `largest_energy`, as energy_model::Dynamics has
  /// it.
  double energy_error = 0;
  double largest_energy = 0;  ///< [J]
  double step_error = 0;      ///< Dynamics::error_estimate, over the length [-]
  /// Largest depth of the rod in a rigid obstacle in reach, over the length [-]; none: there is
  /// none.
  std::optional<double> deepest_contact;
  int fewer_terms = 0;               ///< of a second run, which tells what terms left out change
  double term_difference = 0;        ///< largest RMS distance of its frames, over the length [-]
  TrackErrors quasi_static;          ///< of the track's shapes
  std::optional<TrackErrors> force;  ///< of the force model's
  double force_lag = std::numeric_limits<double>::quiet_NaN();  ///< as ForceTrackSummary's [s]
  double force_error_without_lag = std::numeric_limits<double>::quiet_NaN();
};

/// The rod of a track with inertia: along the same trajectories, whose velocities its grips have
/// (energy_model::simulate). It begins with the shape at rest of the first frame. Where grips or
/// obstacles move then, it is in motion as shapes at rest follow them. What the shapes at rest and
/// the force model's are off is measured against it.
/// @param track  of the same scene and options
/// @throws InputError as require_dynamic(), and if the damping is out of range; ConvergenceError if
/// there is no shape to begin with
[[nodiscard]] DynamicTrack dynamic_track(const Scene& scene, const Track& track,
                                         const TrackOptions& options, const RodDamping& damping);

/// What is asked of a scene that moves.
struct TrackRequest {
  TrackOptions options;                 ///< but for the rates, which are the scene's
  std::optional<double> frame_rate;     ///< instead of the scene's [Hz], > 0, up to 1e9
  std::optional<double> obstacle_rate;  ///< the same [Hz]
  std::optional<double> step_rate;      ///< the same [Hz]
  std::optional<RodDamping> damping;    ///< of the rod with inertia; none: it is only at rest
};

/// A scene's motion: what `dlo track` says, and Python with it.
struct TrackResult {
  TrackOptions options;
  Track track;                          ///< at rest
  std::optional<DynamicTrack> dynamic;  ///< the rod with inertia

  /// The rod with inertia, null without one.
  [[nodiscard]] const DynamicTrack* moving() const { return dynamic ? &*dynamic : nullptr; }
};

/// @throws InputError, ConvergenceError as track() and dynamic_track(), and if a rate is out of
/// range
[[nodiscard]] TrackResult follow(const Scene& scene, const TrackRequest& request,
                                 const Progress& progress = {});

}  // namespace dlo::compare
