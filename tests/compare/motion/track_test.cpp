#include "motion/track.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "../../says.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/scene_file.hpp"

namespace dlo::compare {
namespace {

using energy_model::ContactKind;

TrackOptions at_rate(double rate) {
  TrackOptions options;
  options.rates.frame_rate = rate;
  options.force = ForceModelRun::absent;
  options.samples = 21;
  return options;
}

Scene corner() { return load_scene(std::string(DLO_DATA) + "/scenes/corner_routing.toml"); }

const std::string light_wire =
    "[rod]\nlength = 1\nbending_stiffness = 1\nmass_per_length = 0.5\n[[gripper]]\nat = 0\n";

/// Returns a scene whose clamp rises and rotates downwards.
Scene swung() {
  return parse_scene(
      light_wire +
          "[[gripper.pose]]\ntime = 0\nposition = [0, 0, 0]\ndirection = \"60 deg\"\n"
          "[[gripper.pose]]\ntime = 1\nposition = [0.3, 0.5, 0]\n"
          "direction = \"-20 deg\"\n",
      "swung.toml");
}

/// Returns a scene in which a rod touches a peg and its clamp moves away until the tip slides off
/// the peg.
Scene rod_pulled_off_peg() {
  return parse_scene(
      "[rod]\nlength = 1\nbending_stiffness = 1\nmass_per_length = 1\n[[gripper]]\nat = 0\n"
      "direction = \"20 deg\"\n[[gripper.pose]]\ntime = 0\nposition = [0, 0.5, 0]\n"
      "[[gripper.pose]]\ntime = 0.4\nposition = [0, 0, 0]\n"
      "[[gripper.pose]]\ntime = 1\nposition = [-0.8, 0, 0]\n[[obstacle]]\n"
      "shape = \"cylinder\"\npoint = [0.5, 0, 0]\naxis = [0, 0, 1]\nradius = 0.05\n"
      "touches = \"axis\"\n",
      "peg.toml");
}

/// Returns the kinds of the events of a track.
std::vector<std::string> kinds_of(const Track& result) {
  std::vector<std::string> kinds;
  for (const TrackEvent& event : result.events) kinds.emplace_back(to_string(event.kind));
  return kinds;
}

/// Returns the difference of the work and the increase of energy of a track without events [J].
double energy_balance_error(const Scene& scene, double rate) {
  const Track result = track(scene, at_rate(rate));
  const TrackFrame& last = result.frames.back();
  EXPECT_TRUE(result.events.empty());
  return std::abs(last.work - (last.energy.total() - result.frames.front().energy.total()));
}

/// Expects that the error of the energy balance, by the trapezoidal rule, is of second order in the
/// duration of a frame.
/// @param most  largest error at `rate` [J]
/// @param off   allowed difference from 4 of the ratio of the errors at `rate` and at twice the
/// rate
void expect_second_order(const Scene& scene, double rate, double most, double off) {
  const double coarse = energy_balance_error(scene, rate);
  const double fine = energy_balance_error(scene, 2 * rate);
  EXPECT_LT(coarse, most);
  EXPECT_NEAR(coarse / fine, 4, off);
}

TEST(Track, EnergyGrowsByTheWorkOfWhatMoves) { expect_second_order(swung(), 10, 8e-3, 0.4); }

/// Text of a scene with a couple at the tip and one at the clamp, which rotates by more than a
/// turn.
const std::string rotating_clamp =
    light_wire +
    "[[gripper.pose]]\ntime = 0\nposition = [0, 0, 0]\ndirection = \"10 deg\"\n"
    "[[gripper.pose]]\ntime = 1\nposition = [0.2, 0.1, 0]\ndirection = \"150 deg\"\n"
    "[[gripper.pose]]\ntime = 2\nposition = [0, 0.2, 0]\ndirection = \"280 deg\"\n"
    "[[gripper.pose]]\ntime = 3\nposition = [0, 0, 0]\ndirection = \"40 deg\"\n"
    "[[load]]\nat = 1\nforce = [0, 0, 0]\ntorque = [0, 0, 0.8]\n"
    "[[load]]\nat = 0\nforce = [0, 0, 0]\ntorque = [0, 0, -0.5]\n";

/// Text of a scene with two pins, whose chord rotates by more than a turn, and a couple between
/// them.
const std::string rotating_chord =
    "gravity = [0, 0, 0]\n" + light_wire +
    "position = [0, 0, 0]\nhold = \"pin\"\n[[gripper]]\nat = 1\nhold = \"pin\"\n"
    "[[gripper.pose]]\ntime = 0\nposition = [0.7, 0, 0]\n"
    "[[gripper.pose]]\ntime = 1\nposition = [0, 0.7, 0]\n"
    "[[gripper.pose]]\ntime = 2\nposition = [-0.7, 0, 0]\n"
    "[[gripper.pose]]\ntime = 3\nposition = [0, -0.7, 0]\n"
    "[[gripper.pose]]\ntime = 4\nposition = [0.7, 0, 0]\n"
    "[[gripper.pose]]\ntime = 5\nposition = [0, 0.7, 0]\n"
    "[[load]]\nat = 0.4\nforce = [0, 0, 0]\ntorque = [0, 0, -1.5]\n";

// A couple T does the work T dphi while clamp or chord rotate by dphi.
TEST(Track, EnergyGrowsByTheWorkBesideCouples) {
  for (const std::string& text : {rotating_clamp, rotating_chord}) {
    const Scene scene = parse_scene(text, "couple.toml");
    expect_second_order(scene, 20, 0.03, 0.5);
    const Track result = track(scene, at_rate(40));
    EXPECT_FALSE(result.stopped) << result.stopped->why;
    EXPECT_EQ(result.lost_frames, 0);
  }
}

/// Text of a scene with two clamps that hold the frame. One of them moves, rotates and rolls out of
/// the plane.
const std::string rolling_clamp =
    "gravity = [0, 0, 0]\n[rod]\nlength = 1\nbending_stiffness = 1\n"
    "torsional_stiffness = 0.7\nmass_per_length = 0.1\n[[gripper]]\nat = 0\n"
    "position = [0, 0, 0]\nframe = [[0, 1.0, 0], [0, 0, 1.0], [1.0, 0, 0]]\n[[gripper]]\nat = 1\n"
    "[[gripper.pose]]\ntime = 0\nposition = [0.85, 0.1, 0.12]\ndirection = [1, 0.2, -0.3]\n"
    "roll = \"0 deg\"\n[[gripper.pose]]\ntime = 1\nposition = [0.8, 0.2, 0.1]\n"
    "direction = [1, -0.3, -0.4]\nroll = \"40 deg\"\n";

// About the tangent the frame rotates by its roll and by how much the shortest rotation from the
// first clamp's direction, which carries it, differs from that of a step.
TEST(Track, EnergyGrowsByTheWorkOfAClampThatHoldsTheFrame) {
  const Scene scene = parse_scene(rolling_clamp, "rolling.toml");
  expect_second_order(scene, 20, 0.01, 0.5);
  const Track result = track(scene, at_rate(40));
  EXPECT_GT(std::abs(result.frames.back().work), 0.1);
}

// Three turns on a rod whose clamps are half its length apart: a loop forms and passes through the
// rod, which loses two of them.
TEST(Track, StopsWhereTheRodPassesThroughItself) {
  const Scene scene = parse_scene(
      "gravity = [0, 0, 0]\n[rod]\nlength = 1\nbending_stiffness = 1\n"
      "torsional_stiffness = 0.8\nmass_per_length = 0.1\n[[gripper]]\nat = 0\n"
      "position = [0, 0, 0]\nframe = [[0, 1.0, 0], [0, 0, 1.0], [1.0, 0, 0]]\n[[gripper]]\n"
      "at = 1\ndirection = [1, 0, 0]\n[[gripper.pose]]\ntime = 0\nposition = [0.5, 0, 0.12]\n"
      "roll = \"360 deg\"\n[[gripper.pose]]\ntime = 1\nposition = [0.5, 0, 0.12]\n"
      "roll = \"1080 deg\"\n",
      "turns.toml");
  const Track result = track(scene, at_rate(20));
  ASSERT_TRUE(result.stopped);
  EXPECT_TRUE(
      has_all(result.stopped->why, {"not verified: the grips hold", "passed through itself"}));
  EXPECT_GT(result.stopped->time, 0.3);
  for (const TrackFrame& frame : result.frames) {
    const Linking& part = frame.linking.at(0);
    EXPECT_NEAR(part.twist + part.writhe, part.held, 0.1) << frame.time;
  }
}

// A floor that rises under a rod: the work is the floor's.
TEST(Track, CountsTheWorkOfAnObstacleThatMoves) {
  const Scene scene = parse_scene(
      light_wire +
          "position = [0, 0, 0]\ndirection = \"0 deg\"\n[[obstacle]]\nnormal = [0, 1, 0]\n" +
          "touches = \"axis\"\n[[obstacle.pose]]\ntime = 0\npoint = [0, -0.7, 0]\n" +
          "[[obstacle.pose]]\ntime = 1\npoint = [0, -0.2, 0]\n",
      "floor.toml");
  const Track result = track(scene, at_rate(40));
  const TrackFrame& last = result.frames.back();
  EXPECT_FALSE(last.contacts.empty());
  EXPECT_GT(last.work, 0.1);
  EXPECT_NEAR(last.work, last.energy.total() - result.frames.front().energy.total(), 2e-3);
}

// At 1000 frames per second half a step comes to within 1e-5 of a frame of the time at which a
// point contact becomes an interval; at the other rates it does not. In all cases the rod touches,
// lies and comes back on one branch.
TEST(Track, KeepsItsBranchWhereAPointBeginsToLie) {
  constexpr double slowest = 100;
  std::vector<double> times;
  for (const double rate : {slowest, 400.0, 1000.0}) {
    TrackOptions options = at_rate(rate);
    options.from = 0.55;
    options.to = 1.45;
    const Track result = track(corner(), options);
    EXPECT_FALSE(result.stopped) << rate;
    EXPECT_EQ(result.lost_frames, 0) << rate;
    EXPECT_EQ(kinds_of(result),
              (std::vector<std::string>{"contact", "contact", "release", "release"}))
        << rate;
    for (std::size_t i = 0; i < 2; ++i) {
      const TrackEvent& event = result.events.at(i);
      EXPECT_EQ(event.contact->part.kind, i == 0 ? ContactKind::touching : ContactKind::lying);
      times.push_back(result.frames[event.frame].time);
      EXPECT_NEAR(times.back(), times[i], 1 / slowest + 1e-12) << rate;
    }
  }
}

// The rod snaps once. The released energy is the work of the grippers minus the change of energy,
// and agrees at twice the frame rate within the bounds of both.
TEST(Track, TellsASnapByTheEnergyThatIsMissing) {
  const auto snap_of = [](double rate) {
    const Track result = track(rod_pulled_off_peg(), at_rate(rate));
    EXPECT_FALSE(result.stopped) << result.stopped->why;
    std::vector<TrackEvent> snaps;
    for (const TrackEvent& event : result.events) {
      if (event.kind == TrackEvent::Kind::snap) snaps.push_back(event);
    }
    EXPECT_EQ(snaps.size(), 1U);
    const TrackFrame& after = result.frames[snaps.at(0).frame];
    EXPECT_FALSE(after.followed);
    EXPECT_LT(after.shape.points.row(1).minCoeff(), -0.4);
    EXPECT_TRUE(after.contacts.empty());
    return std::pair(snaps.at(0), after.time);
  };
  const auto [slow, slow_time] = snap_of(30);
  const auto [fast, fast_time] = snap_of(60);
  EXPECT_LE(std::abs(slow_time - fast_time), 1.0 / 30 + 1e-12);
  EXPECT_GT(slow.released, 0.9);
  EXPECT_LE(std::abs(slow.released - fast.released), slow.released_bound + fast.released_bound);
  EXPECT_LT(fast.released_bound, slow.released_bound);
  // The released energy is measured from the fold, whose time is known to 1/1024 of a frame.
  EXPECT_LT(slow.released_bound, 1e-3 * slow.released);
  for (const TrackEvent& snap : {slow, fast}) {
    EXPECT_GT(snap.smallest_eigenvalue, 0);
    EXPECT_LT(snap.smallest_eigenvalue, 0.01);
  }
}

/// Returns an S-shaped rod between two clamps. One clamp rotates until the rod has changed to its
/// mirror image, through shapes out of its plane.
Scene rod_with_reversed_clamp() {
  return parse_scene(
      "[rod]\nlength = 1\nbending_stiffness = 1\nmass_per_length = 0\n[[gripper]]\nat = 0\n"
      "position = [0, 0, 0]\ndirection = \"0 deg\"\n[[gripper]]\nat = 1\n[[gripper.pose]]\n"
      "time = 0\nposition = [0.97, 0, 0]\ndirection = \"-40 deg\"\n[[gripper.pose]]\ntime = 2\n"
      "position = [0.97, 0, 0]\ndirection = \"120 deg\"\n",
      "turned_over.toml");
}

// The branch ends where its mirror image begins: forces jump, and no energy is released.
TEST(Track, TurningOverIsNoSnap) {
  for (const double rate : {5.0, 20.0, 80.0}) {
    const Track result = track(rod_with_reversed_clamp(), at_rate(rate));
    EXPECT_FALSE(result.stopped);
    EXPECT_TRUE(result.events.empty());
    EXPECT_EQ(result.lost_frames, 1);
  }
}

// In a seventh of a second the rod comes from above the peg to below it.
TEST(Track, GoesThroughNoObstacleInOneStep) {
  for (const double rate : {7.0, 60.0}) {
    EXPECT_EQ(kinds_of(track(rod_pulled_off_peg(), at_rate(rate))),
              (std::vector<std::string>{"contact", "snap", "release"}))
        << rate;
  }
}

// At five frames per second the rod moves too far for one step of Newton's method, so steps are
// repeated with smaller ones. At the times of the frames the result agrees with that of a high
// rate.
TEST(Track, RepeatsAFrameThatItHasLostInSmallerSteps) {
  const Scene scene = load_scene(std::string(DLO_DATA) + "/scenes/swung_rod.toml");
  const Track coarse = track(scene, at_rate(5));
  const Track fine = track(scene, at_rate(100));
  EXPECT_EQ(fine.repeated_frames, 0);
  EXPECT_GT(coarse.repeated_frames, 0);
  EXPECT_EQ(coarse.lost_frames, 0);
  for (std::size_t i = 0; i < coarse.frames.size(); ++i) {
    const TrackFrame& same = fine.frames[std::min(20 * i, fine.frames.size() - 1)];
    ASSERT_NEAR(same.time, coarse.frames[i].time, 1e-12);
    EXPECT_LT((same.shape.points - coarse.frames[i].shape.points).norm(), 1e-8) << same.time;
    EXPECT_TRUE(coarse.frames[i].followed);
  }
}

// After the last pose the rod does not move and no work is done, and the force model continues.
TEST(Track, GoesOnAtRestBeyondTheLastPose) {
  TrackOptions options = at_rate(20);
  options.to = 1.5;
  options.force = ForceModelRun::runs;
  Scene scene = swung();
  scene.track.step_rate = 3000;
  const Track result = track(scene, options);
  ASSERT_EQ(result.frames.size(), 31U);
  EXPECT_FALSE(result.stopped);
  EXPECT_NEAR(result.frames.back().time, 1.5, 1e-12);
  const TrackFrame& last_pose = result.frames[20];
  for (std::size_t i = 21; i < result.frames.size(); ++i) {
    EXPECT_LT((result.frames[i].shape.points - last_pose.shape.points).norm(), 1e-9) << i;
    EXPECT_NEAR(result.frames[i].work, last_pose.work, 1e-12) << i;
    ASSERT_TRUE(result.frames[i].force) << result.force.missing_reason;
  }
  EXPECT_TRUE(result.events.empty());
}

TEST(Track, RefusesWhatDoesNotMove) {
  const Scene scene =
      parse_scene(light_wire + "position = [0, 0, 0]\ndirection = \"0 deg\"\n", "standing.toml");
  EXPECT_THROW((void)track(scene, {}), InputError);
  TrackOptions options = at_rate(10);
  options.from = 1;
  options.to = 1;
  EXPECT_THROW((void)track(swung(), options), InputError);
}

// If the motion is slow enough for the force model, its mean error is less than twice that at rest
// plus 1e-3.
TEST(Track, RunsTheForceModelBesideIt) {
  Scene scene = swung();
  scene.force_model.points = 16;
  scene.force_model.c_c = 200;
  TrackOptions options = at_rate(20);
  options.force = ForceModelRun::runs;
  options.rates.step_rate = 4000;
  const ForceTrackSummary hasty = track(scene, options).force;
  options.rates.step_rate = 40000;
  const ForceTrackSummary patient = track(scene, options).force;
  EXPECT_EQ(hasty.missing_reason, "");
  EXPECT_EQ(hasty.steps_per_frame, 200);
  EXPECT_LT(patient.largest, hasty.largest);
  EXPECT_LT(patient.mean, 2 * patient.rest_error + 1e-3);
}

// A rod of 40 cm; the errors are distances of points at equal arc lengths.
TEST(Track, ErrorsOfTheForceModelAreSharesOfTheLength) {
  const Scene scene = load_scene(std::string(DLO_DATA) + "/scenes/swung_rod.toml");
  TrackOptions options = at_rate(50);
  options.force = ForceModelRun::runs;
  options.rates.step_rate = 6000;
  options.samples = 101;
  const Track result = track(scene, options);
  ASSERT_EQ(result.force.missing_reason, "");
  double sum = 0;
  for (const TrackFrame& frame : result.frames) {
    const Eigen::Matrix3Xd apart = frame.force->points - frame.shape.points;
    const double share = std::sqrt(apart.colwise().squaredNorm().mean()) / scene.length;
    // The error is computed at the points of the rod and of the polygon's segments, here at other
    // arc lengths.
    EXPECT_NEAR(frame.force->error_over_length, share, 0.1 * share + 1e-4) << frame.time;
    sum += share;
  }
  const double mean = sum / static_cast<double>(result.frames.size());
  EXPECT_GT(mean, 1e-2);
  EXPECT_NEAR(result.force.mean, mean, 0.1 * mean);
  EXPECT_LT(result.force.error_without_lag, mean);
}

/// Returns the delay of the leader at which it is nearest to the follower: the minimum of the
/// squares over shifts of a hundredth of a frame, with linear interpolation between the leader's
/// frames.
double best_delay(const std::vector<Eigen::Matrix3Xd>& leader,
                  const std::vector<Eigen::Matrix3Xd>& follower, double frame_time) {
  double least = std::numeric_limits<double>::infinity();
  double delay = 0;
  const double longest = 0.5 * static_cast<double>(leader.size());  // largest shift [frames]
  for (double shift = 0; shift < longest; shift += 0.01) {
    double sum = 0;
    for (std::size_t i = 0; i < leader.size(); ++i) {
      const double at = std::max(0.0, static_cast<double>(i) - shift);
      const auto before = static_cast<std::size_t>(at);
      const double share = at - std::floor(at);
      const std::size_t after = std::min(before + 1, leader.size() - 1);
      sum += (follower[i] - (1 - share) * leader[before] - share * leader[after]).squaredNorm();
    }
    if (!(sum < least)) continue;
    least = sum;
    delay = shift * frame_time;
  }
  return delay;
}

// The lag in the summary is in seconds, for any frame rate.
TEST(Track, TheForceModelsLagIsTheDelayAtWhichItIsNearest) {
  Scene scene = load_scene(std::string(DLO_DATA) + "/scenes/swung_rod.toml");
  scene.track.step_rate = 6000;
  for (const double rate : {100.0, 200.0}) {
    TrackOptions options = at_rate(rate);
    options.force = ForceModelRun::runs;
    const Track result = track(scene, options);
    std::vector<Eigen::Matrix3Xd> leader;
    std::vector<Eigen::Matrix3Xd> follower;
    for (const TrackFrame& frame : result.frames) {
      ASSERT_TRUE(frame.force) << result.force.missing_reason;
      leader.push_back(frame.shape.points);
      follower.push_back(frame.force->points);
    }
    const double delay = best_delay(leader, follower, 1 / rate);
    EXPECT_GT(delay, 1 / rate);
    // A parabola through the squares at whole frames is off by less than a quarter of one.
    EXPECT_NEAR(result.force.lag, delay, 0.25 / rate);
  }
}

}  // namespace
}  // namespace dlo::compare
