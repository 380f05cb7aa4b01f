#include "motion/track.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>
#include <utility>

#include "base/timer.hpp"
#include "dlo/compare/discretise.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/solve.hpp"
#include "motion/branch.hpp"
#include "motion/frame_clock.hpp"
#include "scene/scene_problem.hpp"
#include "solve/held_frames.hpp"

namespace dlo::compare {
namespace {

using energy_model::ContactKind;
using energy_model::ContactPart;
using PartList = std::vector<const ContactPart*>;

double middle_of(const ContactPart& part) { return (part.begin + part.end) / 2; }

PartList parts_on(std::size_t obstacle, const std::vector<ContactPart>& contacts) {
  PartList parts;
  for (const ContactPart& contact : contacts) {
    if (contact.obstacle == obstacle) parts.push_back(&contact);
  }
  return parts;
}

/// Pairs each of `fewer` with one of `more` in the same order, with the least sum of distances.
/// Returns for each of `more` whether it has a partner.
std::vector<bool> match_in_order(const PartList& fewer, const PartList& more) {
  const std::size_t n = fewer.size();
  const std::size_t m = more.size();
  // least[i][j]: least sum for the first i of `fewer` among the first j of `more`
  std::vector<std::vector<double>> least(
      n + 1, std::vector<double>(m + 1, std::numeric_limits<double>::infinity()));
  for (std::size_t j = 0; j <= m; ++j) least[0][j] = 0;
  for (std::size_t i = 1; i <= n; ++i) {
    for (std::size_t j = i; j <= m; ++j) {
      const double pair =
          least[i - 1][j - 1] + std::abs(middle_of(*fewer[i - 1]) - middle_of(*more[j - 1]));
      least[i][j] = std::min(least[i][j - 1], pair);
    }
  }
  std::vector<bool> has_pair(m, false);
  std::size_t j = m;
  for (std::size_t i = n; i > 0; --i, --j) {
    while (least[i][j - 1] <= least[i][j]) --j;
    has_pair[j - 1] = true;
  }
  return has_pair;
}

void compare_pair(const ContactPart& before, const ContactPart& after,
                  std::vector<ContactChange>& changes) {
  if (before.kind == after.kind) return;
  const bool ends = before.kind == ContactKind::lying;
  changes.push_back({!ends, ends ? before : after, true});
}

class Tracker {
 public:
  Tracker(const Scene& scene, const TrackOptions& options)
      : scene_(scene),
        options_(options),
        clock_(scene, {options.from, options.to}, options.rates),
        branch_(scene, clock_,
                {.terms = options.solve.terms,
                 .max_evaluations = options.solve.max_evaluations,
                 .time_limit = options.solve.time_limit}) {
    result_.arc_length = equal_arc_lengths(scene.length, options.samples);
  }

  [[nodiscard]] Track run(const Progress& progress) {
    constexpr double most_points = 4e6;  // a document of so many points has some 0.5 GB
    const double points = static_cast<double>(clock_.frames()) * options_.samples;
    if (points > most_points) {
      throw InputError(
          fmt::format("{}: {} frames of {} samples (allowed: {:g} points in all, by a lower frame "
                      "rate or fewer "
                      "samples)",
                      scene_.file, clock_.frames(), options_.samples, most_points));
    }
    const auto total = static_cast<std::int64_t>(clock_.frames());
    for (std::size_t frame = 0; frame < clock_.frames(); ++frame) {
      if (!add(frame)) break;
      if (progress) progress(static_cast<std::int64_t>(frame) + 1, total);
    }
    summarise();
    return std::move(result_);
  }

 private:
  /// Adds a frame. @return false if the track ends before it
  bool add(std::size_t index) {
    const double time = clock_.time(index);
    const Timer timer;
    Passage passage;
    try {
      if (index == 0) {
        branch_.begin();
      } else {
        passage = branch_.next();
      }
    } catch (const std::invalid_argument& error) {
      if (index == 0) throw InputError(fmt::format("{}: {}", scene_.file, error.what()));
      return stop(time, error.what());
    } catch (const InputError& error) {
      if (index == 0) throw;
      return stop(time, error.what());
    }
    const SolvedInstant& now = branch_.now();
    if (!energy_model::succeeded(now.rod.status)) {
      const std::string why = fmt::format("the energy model did not converge: {} ({} evaluations)",
                                          now.rod.message, now.rod.evaluations);
      if (index > 0) return stop(time, why);
      throw ConvergenceError(fmt::format("{}: at {:g} s {}", scene_.file, time, why));
    }
    TrackFrame frame{
        solution_of(now.scene, Model::energy, now.rod, result_.arc_length, branch_.obstacles())};
    if (!has_prescribed_turns(now.scene, frame)) return false;
    frame.energy = energies_of(now);
    frame.time = time;
    frame.followed = passage.stayed_on_branch;
    frame.seconds = timer.seconds();
    if (index > 0 && !passage.is_stationary) seconds_.push_back(frame.seconds);
    if (index > 0 && !add_energy_balance(passage, frame)) return false;
    add_contact_events(frame);
    add_force(now, frame);
    result_.lost_frames += frame.followed ? 0 : 1;
    result_.repeated_frames += passage.stayed_on_branch && passage.has_smaller_steps ? 1 : 0;
    result_.frames.push_back(std::move(frame));
    return true;
  }

  /// Checks the turns. @return whether the shape has the turns that the clamps hold
  /// @throws ConvergenceError if the first frame does not have them
  bool has_prescribed_turns(const Scene& now, const TrackFrame& frame) {
    const double time = clock_.time(result_.frames.size());
    if (result_.frames.empty()) {
      const std::string lost = turns_mismatch_message(frame.linking);
      if (!lost.empty()) {
        throw ConvergenceError(fmt::format("{}: at {:g} s {}", scene_.file, time, lost));
      }
      return true;
    }
    const Scene before = clock_.scene(scene_, result_.frames.size() - 1);
    std::string lost =
        turns_mismatch_message(before, result_.frames.back().linking, now, frame.linking);
    return lost.empty() || stop(time, std::move(lost));
  }

  bool stop(double time, std::string why) {
    result_.stopped = {time, std::move(why)};
    return false;
  }

  /// Adds work and energy, and a snap or a loss of the branch if there is one.
  /// @return false if the work done does not allow the energy of the shape
  bool add_energy_balance(const Passage& passage, TrackFrame& frame) {
    frame.work = result_.frames.back().work + passage.work;
    frame.released = passage.released;
    frame.released_bound = passage.released_bound;
    if (passage.stayed_on_branch) return true;
    if (frame.released < -frame.released_bound) {
      return stop(frame.time,
                  fmt::format("the solver left its branch: the energy is {:.3g} J higher than "
                              "the work allows; a higher frame rate may keep the branch",
                              -frame.released));
    }
    if (branch_.has_energy_balance() && !(frame.released > frame.released_bound)) return true;
    TrackEvent event;
    event.kind = passage.end_was_observed ? TrackEvent::Kind::snap : TrackEvent::Kind::lost;
    event.frame = result_.frames.size();
    event.released = frame.released;
    event.released_bound = frame.released_bound;
    event.smallest_eigenvalue = passage.last_eigenvalue;
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

  void add_force(const SolvedInstant& now, TrackFrame& frame) {
    ForceTrackSummary& summary = result_.force;
    if (options_.force == ForceModelRun::absent) summary.missing_reason = "not requested";
    if (!summary.missing_reason.empty()) return;
    const double steps = options_.rates.step_rate / options_.rates.frame_rate;
    summary.steps_per_frame = std::max(1L, std::lround(steps));
    try {
      if (result_.frames.empty()) {
        for (const std::size_t i : branch_.obstacles()) {
          const Obstacle& obstacle = scene_.obstacles[i];
          if (obstacle.trajectory.empty() || obstacle.body.is_half_space()) continue;
          summary.missing_reason = fmt::format(
              "obstacle {} moves and is not a plane (the force model moves planes only)", i + 1);
          return;
        }
        force_.emplace(now.scene, now.rod, branch_.obstacles(), options_.solve);
      } else if (!force_->step(now.scene, summary.steps_per_frame)) {
        summary.missing_reason = fmt::format("it diverged at {:g} s", frame.time);
        return;
      }
      frame.force = force_->frame(now.rod, result_.arc_length);
      if (!result_.frames.empty()) force_seconds_.push_back(force_->seconds());
    } catch (const ResultError& error) {
      summary.missing_reason = error.what();
    } catch (const std::invalid_argument& error) {
      summary.missing_reason = error.what();
    }
  }

  static double median(std::vector<double> values) {
    if (values.empty()) return 0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
  }

  void summarise() {
    std::vector<Eigen::Matrix3Xd> leader;
    std::vector<Eigen::Matrix3Xd> follower;
    ForceTrackSummary& summary = result_.force;
    for (const TrackFrame& frame : result_.frames) {
      if (!frame.force) continue;
      leader.push_back(frame.shape.points);
      follower.push_back(frame.force->points);
      summary.add(frame.force->error_over_length, frame.time);
    }
    // The first frame is found by a search, so its duration is used only if there is no other.
    if (seconds_.empty()) seconds_.push_back(result_.frames.front().seconds);
    result_.median_seconds = median(std::move(seconds_));
    if (leader.empty()) return;
    summary.rest_error = result_.frames.front().force->error_over_length;
    summary.median_seconds = median(std::move(force_seconds_));
    summary.finish(leader, follower, 1 / options_.rates.frame_rate, scene_.length);
  }

  const Scene& scene_;
  const TrackOptions& options_;
  FrameClock clock_;
  Branch branch_;
  std::optional<ForceTrack> force_;
  std::vector<double> seconds_;  // computing times of frames that follow a branch [s]
  std::vector<double> force_seconds_;
  Track result_;
};

}  // namespace

std::vector<ContactChange> contact_changes(const std::vector<ContactPart>& before,
                                           const std::vector<ContactPart>& after) {
  std::set<std::size_t> obstacles;
  for (const ContactPart& part : before) obstacles.insert(part.obstacle);
  for (const ContactPart& part : after) obstacles.insert(part.obstacle);
  std::vector<ContactChange> changes;
  for (const std::size_t obstacle : obstacles) {
    const PartList old_parts = parts_on(obstacle, before);
    const PartList new_parts = parts_on(obstacle, after);
    const bool begins = new_parts.size() > old_parts.size();
    const PartList& fewer = begins ? old_parts : new_parts;
    const PartList& more = begins ? new_parts : old_parts;
    const std::vector<bool> has_pair = match_in_order(fewer, more);
    std::size_t next = 0;
    for (std::size_t j = 0; j < more.size(); ++j) {
      if (!has_pair[j]) {
        changes.push_back({begins, *more[j], false});
        continue;
      }
      const ContactPart& other = *fewer[next++];
      compare_pair(begins ? other : *more[j], begins ? *more[j] : other, changes);
    }
  }
  return changes;
}

Track track(const Scene& scene, const TrackOptions& options, const Progress& progress) {
  return Tracker(scene, options).run(progress);
}

}  // namespace dlo::compare
