#pragma once

#include <optional>
#include <vector>

#include "dlo/compare/scene.hpp"
#include "dlo/energy_model/dynamics.hpp"
#include "motion/moving_scene.hpp"
#include "motion/track.hpp"

namespace dlo::compare {

/// The moving rod at the time of a frame of a Track.
struct DynamicFrame {
  double time = 0;  ///< [s]
  /// The energies of gravity and loads are equal to the track's in the first frame.
  energy_model::EnergyBalance energy;
  std::vector<GripperLoad> grippers;       ///< in the scene's order
  std::vector<Eigen::Vector3d> obstacles;  ///< force of each obstacle on the rod, in the scene's
                                           ///< order [N]
  Eigen::Matrix3Xd points;                 ///< at Track::arc_length [m]
  double quasi_static_error = 0;      ///< RMS distance of the track's shape over the length [-]
  std::optional<double> force_error;  ///< RMS distance of the force model's shape at its own
                                      ///< points, over the length [-]
};

/// Motion of a Track's rod with inertia.
struct DynamicTrack {
  RodDamping damping;
  bool in_motion = false;            ///< whether the rod has a velocity at the first frame
  std::vector<DynamicFrame> frames;  ///< for the track's frames, up to the one at which it stopped
  std::optional<TrackStop> stopped;  ///< also set if the track itself ended early
  int terms = 0;                     ///< number of terms per interval and field
  std::optional<TooFewTerms> too_few_terms;
  long steps = 0;      ///< number of integration steps
  double seconds = 0;  ///< duration of the computation [s], without the run with fewer terms
  /// Largest residual of the energy balance, divided by `largest_energy`, as in
  /// energy_model::Dynamics.
  double energy_error = 0;
  double largest_energy = 0;  ///< as in energy_model::Dynamics [J]
  double step_error = 0;      ///< Dynamics::error_estimate, over the length [-]
  /// Largest depth of the rod in a rigid obstacle in reach, over the length [-]; empty if there is
  /// no such obstacle.
  std::optional<double> deepest_contact;
  int fewer_terms = 0;  ///< terms of a second run, which estimates the truncation error
  /// Largest RMS distance between both runs, over the length; infinite if the second one ends
  /// earlier [-].
  double term_difference = 0;
  TrackErrors quasi_static;          ///< errors of the track's shapes
  std::optional<ForceErrors> force;  ///< errors of the force model's shapes
};

/// Simulates the rod of a track with inertia, along the same trajectories, whose velocities its
/// grips have (energy_model::simulate). The rod starts as Scene::start defines (given_start()),
/// else with the equilibrium shape of the first frame; if grips or obstacles move then, it has the
/// velocities with which equilibrium shapes follow them. The errors of the equilibrium shapes and
/// of the force model's are measured against it.
/// @param track  of the same scene and options
/// @throws InputError as require_dynamic() and given_start(), and if the damping is out of range;
/// ConvergenceError if there is no initial shape, or if the first frame is not reached
[[nodiscard]] DynamicTrack dynamic_track(const Scene& scene, const Track& track,
                                         const TrackOptions& options, const RodDamping& damping);

/// Request to follow the motion of a scene.
struct TrackRequest {
  TrackOptions options;                 ///< without the rates, which are the scene's
  std::optional<double> frame_rate;     ///< replaces the scene's [Hz], > 0, up to 1e9
  std::optional<double> obstacle_rate;  ///< replaces the scene's [Hz]
  std::optional<double> step_rate;      ///< replaces the scene's [Hz]
  std::optional<RodDamping> damping;  ///< damping of the rod with inertia; empty: quasi-static only
};

/// Motion of a scene: the result of `dlo track` and of its Python function.
struct TrackResult {
  TrackOptions options;
  Track track;                          ///< quasi-static
  std::optional<DynamicTrack> dynamic;  ///< the rod with inertia

  /// Returns the rod with inertia, null without one.
  [[nodiscard]] const DynamicTrack* moving() const { return dynamic ? &*dynamic : nullptr; }
};

/// Follows the motion of a scene.
/// @throws InputError, ConvergenceError as track() and dynamic_track(); InputError if a rate is out
/// of range, or fewer than two samples are requested
[[nodiscard]] TrackResult follow(const Scene& scene, const TrackRequest& request,
                                 const Progress& progress = {});

}  // namespace dlo::compare
