#include "motion/track.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "dlo/compare/discretise.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/reference.hpp"
#include "dlo/energy_model/energy.hpp"
#include "motion/frame_clock.hpp"
#include "scene/reach.hpp"

namespace dlo::compare {
namespace {

using energy_model::Equilibrium;

/// Into so many steps, twice as many each time, the way to a frame is cut where Newton's method
/// does not keep the branch, before the branch is said to have ended.
constexpr int fewest_steps = 2;
constexpr int most_steps = 16;

/// Energy that rounding and the solver's tolerance leave open, over EI/l and what gravity and loads
/// could do [-].
constexpr double energy_noise = 1e-8;

/// @throws InputError if a gripper has been moved into an obstacle
void require_clear(const Scene& now) {
  for (std::size_t g = 0; g < now.grippers.size(); ++g) {
    for (std::size_t i = 0; i < now.obstacles.size(); ++i) {
      const double depth = -now.obstacles[i].body.clearance(now.grippers[g].position);
      if (!(depth > 1e-9 * now.length)) continue;
      throw InputError(
          fmt::format("gripper {} is {:.4g} m too near to obstacle {}, which the rod would enter",
                      g + 1, depth, i + 1));
    }
  }
}

/// Gravity and loads are zero at the origin.
SceneEnergies energies_of(const Scene& now, const Equilibrium& rod) {
  const Eigen::Vector3d zero = now.grippers.front().position;
  SceneEnergies energy{.bending = rod.energy.bending,
                       .twisting = rod.energy.twisting,
                       .gravity = rod.energy.gravity,
                       .load = rod.energy.load};
  energy.gravity -= now.weight_between(0, now.length).dot(zero);
  for (const PointLoad& load : now.loads) energy.load -= load.force.dot(zero);
  return energy;
}

/// The turn from one direction to another, about the vector, by its length [rad].
Eigen::Vector3d turn_between(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const Eigen::Vector3d across = from.cross(to);
  const double sine = across.norm();
  if (!(sine > 0)) return Eigen::Vector3d::Zero();
  return std::atan2(sine, from.dot(to)) / sine * across;
}

/// What is done on the rod between two frames: with the mean of the forces, and what other forces
/// could make of it that are between those of both, or beyond by as much as they have changed in
/// the frame before (where a force has its largest value they are the same on either side of it).
class Work {
 public:
  /// @param changes  of the forces along their ways in the frame before, one for each add(); empty:
  ///                 there is none. Becomes those of this one.
  explicit Work(std::vector<Eigen::Vector3d>& changes) : changes_(changes) {}

  void add(const Eigen::Vector3d& before, const Eigen::Vector3d& after,
           const Eigen::Vector3d& moved) {
    if (next_ == changes_.size()) changes_.emplace_back(Eigen::Vector3d::Zero());
    Eigen::Vector3d& last = changes_[next_++];
    done += (before + after).dot(moved) / 2;
    bound += std::max(std::abs((after - before).dot(moved)), last.norm() * moved.norm()) / 2;
    last = after - before;
  }

  double done = 0;   ///< [J]
  double bound = 0;  ///< [J]

 private:
  std::vector<Eigen::Vector3d>& changes_;
  std::size_t next_ = 0;
};

/// One frame's scene and what the energy model says of it.
struct Moment {
  Scene scene;
  Equilibrium rod;
};

Work work_between(const Moment& before, const Moment& after,
                  const std::vector<std::size_t>& obstacles,
                  std::vector<Eigen::Vector3d>& changes) {
  Work work(changes);
  for (std::size_t i = 0; i < after.scene.grippers.size(); ++i) {
    const Gripper& from = before.scene.grippers[i];
    const Gripper& to = after.scene.grippers[i];
    work.add(before.rod.grips[i].force, after.rod.grips[i].force, to.position - from.position);
    if (!to.direction) continue;
    work.add(before.rod.grips[i].torque, after.rod.grips[i].torque,
             turn_between(*from.direction, *to.direction));
  }
  for (std::size_t k = 0; k < obstacles.size(); ++k) {
    const Eigen::Vector3d moved = after.scene.obstacles[obstacles[k]].body.centre() -
                                  before.scene.obstacles[obstacles[k]].body.centre();
    work.add(before.rod.obstacles[k], after.rod.obstacles[k], moved);
  }
  return work;
}

class Tracker {
 public:
  Tracker(const Scene& scene, const TrackOptions& options)
      : scene_(scene),
        options_(options),
        clock_(scene, {options.from, options.to}, options.rates),
        obstacles_(obstacles_ever_in_reach(scene, clock_)),
        energy_options_({.terms = options.solve.terms,
                         .max_evaluations = options.solve.max_evaluations,
                         .time_limit = options.solve.time_limit}),
        solver_(energy_options_) {
    result_.arc_length = equal_arc_lengths(scene.length, options.samples);
    bool yields = false;
    for (const std::size_t i : obstacles_) {
      yields = yields || std::isfinite(scene.obstacles[i].stiffness);
    }
    // What a clamp turns the rod about itself by, and what a yielding obstacle stores, is not told.
    balances_ = !yields && !scene.holds_twist() &&
                !(scene.has_material_directors() && !clock_.scene(scene, 0).planar());
    const double load = scene.weight_between(0, scene.length).norm();
    double loads = load;
    for (const PointLoad& point : scene.loads) loads += point.force.norm();
    noise_ = energy_noise * (scene.bending_stiffness() / scene.length + loads * scene.length);
  }

  [[nodiscard]] Track run(const Progress& progress) {
    const auto total = static_cast<std::int64_t>(clock_.frames());
    for (std::size_t frame = 0; frame < clock_.frames(); ++frame) {
      if (!add(frame)) break;
      if (progress) progress(static_cast<std::int64_t>(frame) + 1, total);
    }
    summarise();
    return std::move(result_);
  }

 private:
  /// @return whether there is such a frame
  bool add(std::size_t index) {
    const double time = clock_.time(index);
    Moment now{clock_.scene(scene_, index), {}};
    const auto begin = std::chrono::steady_clock::now();
    Eigen::Matrix3Xd points;
    try {
      require_clear(now.scene);
      const energy_model::Problem problem = frame_problem(now.scene, obstacles_);
      now.rod = index == 0 ? solver_.solve(problem) : follow(index, problem);
      if (now.rod.sample) points = now.rod.sample(result_.arc_length).points;
    } catch (const std::invalid_argument& error) {
      if (index == 0) throw InputError(fmt::format("{}: {}", scene_.file, error.what()));
      return stop(time, error.what());
    } catch (const InputError& error) {
      if (index == 0) throw;
      return stop(time, error.what());
    }
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    if (!energy_model::succeeded(now.rod.status)) {
      const std::string why = fmt::format("the energy model did not converge: {} ({} evaluations)",
                                          now.rod.message, now.rod.evaluations);
      if (index > 0) return stop(time, why);
      throw ConvergenceError(fmt::format("{}: at {:g} s {}", scene_.file, time, why));
    }
    TrackFrame frame;
    frame.time = time;
    frame.followed = index == 0 || solver_.followed();
    frame.smallest_curvature = now.rod.smallest_curvature;
    frame.seconds = seconds;
    frame.points = std::move(points);
    frame.energy = energies_of(now.scene, now.rod);
    for (const energy_model::Reaction& reaction : now.rod.grips) {
      frame.grippers.push_back({reaction.force, reaction.torque});
    }
    frame.obstacles = forces_of_all(scene_, obstacles_, now.rod.obstacles);
    frame.contacts = now.rod.contacts;
    for (energy_model::ContactPart& contact : frame.contacts) {
      contact.obstacle = obstacles_[contact.obstacle];
    }
    if (index > 0 && !add_balance(now, frame)) return false;
    add_contact_events(frame);
    add_force(now, frame);
    result_.lost += frame.followed ? 0 : 1;
    result_.repeated += frame.followed && in_smaller_steps_ ? 1 : 0;
    result_.frames.push_back(std::move(frame));
    last_ = std::move(now);
    return true;
  }

  /// In one step, and where that does not keep the branch in smaller ones from the frame before.
  Equilibrium follow(std::size_t index, const energy_model::Problem& problem) {
    in_smaller_steps_ = false;
    Equilibrium rod = solver_.follow(problem);
    for (int steps = fewest_steps; steps <= most_steps; steps *= 2) {
      if (solver_.followed() && energy_model::succeeded(rod.status)) break;
      energy_model::EnergyOptions from_last = energy_options_;
      from_last.start = &last_.rod;
      energy_model::EnergySolver solver(from_last);
      Equilibrium smaller = solver.solve(frame_problem(last_.scene, obstacles_));
      bool kept = energy_model::succeeded(smaller.status);
      for (int step = 1; step <= steps && kept; ++step) {
        const Scene scene = clock_.scene_before(scene_, index, static_cast<double>(step) / steps);
        smaller = solver.follow(step < steps ? frame_problem(scene, obstacles_) : problem);
        kept = solver.followed() && energy_model::succeeded(smaller.status);
      }
      if (!kept) continue;
      in_smaller_steps_ = true;
      solver_ = std::move(solver);
      return smaller;
    }
    return rod;
  }

  bool stop(double time, std::string why) {
    result_.stopped = {time, std::move(why)};
    return false;
  }

  /// @return whether the shape is where the work can have brought it
  bool add_balance(const Moment& now, TrackFrame& frame) {
    const TrackFrame& before = result_.frames.back();
    const Work work = work_between(last_, now, obstacles_, changes_);
    frame.work = before.work + work.done;
    frame.released = work.done - (frame.energy.total() - before.energy.total());
    frame.released_bound = work.bound + noise_;
    if (!balances_) frame.released = std::numeric_limits<double>::quiet_NaN();
    if (frame.released < -frame.released_bound) {
      return stop(frame.time,
                  fmt::format("the solver left its branch for a shape that is {:.3g} J higher than "
                              "the work done allows; a higher frame rate may keep it",
                              -frame.released));
    }
    const bool fell = balances_ ? frame.released > frame.released_bound : !frame.followed;
    if (!fell) return true;
    // Newton's method has then come to another branch in a smaller step.
    if (in_smaller_steps_) frame.followed = false;
    TrackEvent event;
    event.kind = TrackEvent::Kind::snap;
    event.frame = result_.frames.size();
    event.released = frame.released;
    event.released_bound = frame.released_bound;
    result_.events.push_back(std::move(event));
    return true;
  }

  void add_contact_events(const TrackFrame& frame) {
    if (result_.frames.empty()) return;
    for (ContactChange& change : contact_changes(result_.frames.back().contacts, frame.contacts)) {
      TrackEvent event;
      event.kind = change.begins ? TrackEvent::Kind::contact : TrackEvent::Kind::release;
      event.frame = result_.frames.size();
      event.contact = std::move(change);
      result_.events.push_back(std::move(event));
    }
  }

  void add_force(const Moment& now, TrackFrame& frame) {
    ForceTrackSummary& summary = result_.force;
    if (options_.force == ForceBeside::left_out) summary.none = "not asked for";
    if (!summary.none.empty()) return;
    const double steps = options_.rates.steps / options_.rates.frames;
    summary.steps_per_frame = std::max(1L, std::lround(steps));
    try {
      if (result_.frames.empty()) {
        for (const std::size_t i : obstacles_) {
          const Obstacle& obstacle = scene_.obstacles[i];
          if (obstacle.trajectory.empty() || obstacle.body.is_half_space()) continue;
          summary.none = fmt::format(
              "obstacle {} moves and is no plane, which the force model cannot move", i + 1);
          return;
        }
        force_ = std::make_unique<ForceTrack>(now.scene, now.rod, obstacles_, options_.solve);
      } else if (!force_->step(now.scene, summary.steps_per_frame)) {
        summary.none = fmt::format("it diverged at {:g} s", frame.time);
        return;
      }
      frame.force = force_->frame(now.rod, result_.arc_length);
      if (!result_.frames.empty()) force_seconds_.push_back(force_->seconds());
    } catch (const InputError& error) {
      summary.none = error.what();
    } catch (const ConvergenceError& error) {
      summary.none = error.what();
    } catch (const std::invalid_argument& error) {
      summary.none = error.what();
    }
  }

  static double median(std::vector<double> values) {
    if (values.empty()) return 0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
  }

  void summarise() {
    std::vector<double> seconds;
    std::vector<Eigen::Matrix3Xd> leader;
    std::vector<Eigen::Matrix3Xd> follower;
    ForceTrackSummary& summary = result_.force;
    double sum = 0;
    for (const TrackFrame& frame : result_.frames) {
      // The first one is searched for.
      const bool first = &frame == &result_.frames.front();
      if (!first || result_.frames.size() == 1) seconds.push_back(frame.seconds);
      if (!frame.force) continue;
      leader.push_back(frame.points);
      follower.push_back(frame.force->points);
      const double error = frame.force->error_over_length;
      sum += error;
      if (!(error > summary.largest)) continue;
      summary.largest = error;
      summary.largest_time = frame.time;
    }
    result_.median_seconds = median(std::move(seconds));
    if (leader.empty()) return;
    summary.rest_error = result_.frames.front().force->error_over_length;
    summary.mean = sum / static_cast<double>(leader.size());
    summary.median_seconds = median(std::move(force_seconds_));
    const Lag lag = lag_of(leader, follower, 1 / options_.rates.frames);
    summary.lag = lag.time;
    summary.error_without_lag = lag.rms / scene_.length;
  }

  const Scene& scene_;
  const TrackOptions& options_;
  FrameClock clock_;
  std::vector<std::size_t> obstacles_;
  energy_model::EnergyOptions energy_options_;
  energy_model::EnergySolver solver_;
  bool in_smaller_steps_ = false;  // the last frame
  bool balances_ = true;
  double noise_ = 0;
  Moment last_;
  std::vector<Eigen::Vector3d> changes_;  // of forces, in the last frame
  std::unique_ptr<ForceTrack> force_;
  std::vector<double> force_seconds_;
  Track result_;
};

}  // namespace

const char* to_string(TrackEvent::Kind kind) {
  switch (kind) {
    case TrackEvent::Kind::contact:
      return "contact";
    case TrackEvent::Kind::release:
      return "release";
    case TrackEvent::Kind::snap:
      break;
  }
  return "snap";
}

Track track(const Scene& scene, const TrackOptions& options, const Progress& progress) {
  return Tracker(scene, options).run(progress);
}

}  // namespace dlo::compare
