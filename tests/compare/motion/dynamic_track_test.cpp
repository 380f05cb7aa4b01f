#include "motion/dynamic_track.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "../../says.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/scene_file.hpp"
#include "motion/moving_scene.hpp"

namespace dlo::compare {
namespace {

TrackOptions options_at_rate(double rate) {
  TrackOptions options;
  options.rates.frame_rate = rate;
  options.force = ForceModelRun::absent;
  options.samples = 21;
  options.solve.terms = 8;
  return options;
}

/// Returns data/scenes/swung_rod.toml up to its second pose, with all times multiplied by `slower`.
Scene swung(double slower) {
  Scene scene = load_scene(std::string(DLO_DATA) + "/scenes/swung_rod.toml");
  std::vector<Pose> poses = scene.grippers.front().trajectory.poses();
  poses.pop_back();
  for (Pose& pose : poses) pose.time *= slower;
  scene.grippers.front().trajectory = Trajectory(poses);
  return scene;
}

DynamicTrack follow_with_inertia(const Scene& scene, const TrackOptions& options,
                                 const RodDamping& damping) {
  const Track at_rest = track(scene, options);
  EXPECT_FALSE(at_rest.stopped);
  return dynamic_track(scene, at_rest, options, damping);
}

Trajectory corners() {
  return Trajectory({{2, {0, 0, 0}, Eigen::Vector3d(1, 0, 0)},
                     {3, {0.3, 0.1, 0}, Eigen::Vector3d(1, 1, 0)},
                     {3.5, {0.4, 0.4, 0.1}, Eigen::Vector3d(0, 1, 0)},
                     {5, {0.1, 0.5, 0.2}, Eigen::Vector3d(0, 1, 1)}});
}

// The accelerations just before and just after a pose are those that the end and the beginning of a
// step need.
TEST(TrajectoryMotion, AccelerationsJumpJustAfterAPose) {
  const energy_model::GripMotion motion = trajectory_motion(corners(), 2);
  for (const double time : trajectory_breaks(corners(), 2)) {
    const Eigen::Vector3d before = motion(time - 1e-9).acceleration;
    const Eigen::Vector3d after = motion(time + 1e-9).acceleration;
    EXPECT_GT((after - before).norm(), 0.1) << time;
    EXPECT_LT((motion(time * (1 + 2e-16)).acceleration - before).norm(), 1e-6) << time;
    EXPECT_LT((motion(time + 1e-12).acceleration - after).norm(), 1e-6) << time;
  }
}

// Checks the energy balance of the frames. Their gravity potential is zero at the same point as
// that of the quasi-static track.
TEST(DynamicTrack, KeepsTheBalanceOfEnergyAndWork) {
  const Scene scene = swung(1);
  const TrackOptions options = options_at_rate(50);
  const Track at_rest = track(scene, options);
  for (const RodDamping damping : {RodDamping{}, RodDamping{.material = 0.01, .air = 0.02}}) {
    const DynamicTrack result = dynamic_track(scene, at_rest, options, damping);
    ASSERT_EQ(result.frames.size(), at_rest.frames.size());
    EXPECT_FALSE(result.stopped);
    const double begin = at_rest.frames.front().energy.total();
    EXPECT_GT(result.largest_energy, 1e-3);
    for (const DynamicFrame& frame : result.frames) {
      const energy_model::EnergyBalance& energy = frame.energy;
      EXPECT_NEAR(energy.total() - begin, energy.work - energy.dissipated,
                  1e-6 * result.largest_energy);
    }
    EXPECT_LT(result.energy_error, 1e-6);
    EXPECT_LT(result.step_error, 1e-4);
    EXPECT_LT(result.term_difference, 1e-3);
    EXPECT_EQ(result.frames.back().energy.dissipated > 0, damping.material > 0);
    EXPECT_LT(result.frames.front().quasi_static_error, 1e-9);
    EXPECT_GT(result.quasi_static.largest, 0.05);
  }
}

// The gripper's force is m (a - g), where a is the acceleration of the cubic path from rest to
// rest. The rod is so stiff that it bends by less than 1e-4.
TEST(DynamicTrack, AGripperCarriesTheMassOfAStiffRod) {
  const Scene scene = parse_scene(
      "[rod]\nlength = 0.5\nbending_stiffness = 1000\nmass_per_length = 0.4\n"
      "[[load]]\nat = 0.5\nmass = 0.1\n[[gripper]]\nat = 0\ndirection = \"0 deg\"\n"
      "[[gripper.pose]]\ntime = 1\nposition = [0, 0, 0]\n"
      "[[gripper.pose]]\ntime = 2\nposition = [0.5, 2, 0]\n",
      "stiff.toml");
  const DynamicTrack result = follow_with_inertia(scene, options_at_rate(8), {.material = 0.01});
  ASSERT_EQ(result.frames.size(), 9U);
  const Eigen::Vector3d way(0.5, 2, 0);
  for (const std::size_t i : {3U, 5U, 6U}) {
    const double u = static_cast<double>(i) / 8;
    const Eigen::Vector3d expected = 0.3 * (6 * (1 - 2 * u) * way - scene.gravity);
    EXPECT_LT((result.frames[i].grippers.front().force - expected).norm(), 2e-3) << u;
    const Eigen::Vector3d velocity = 6 * u * (1 - u) * way;
    EXPECT_NEAR(result.frames[i].energy.kinetic, 0.15 * velocity.squaredNorm(), 1e-3) << u;
  }
}

TEST(DynamicTrack, MeasuresTheForceModelAgainstTheMovingRod) {
  TrackOptions options = options_at_rate(50);
  options.force = ForceModelRun::runs;
  options.to = 0.1;
  Scene scene = swung(1);
  scene.track.step_rate = 3000;
  const Track at_rest = track(scene, options);
  const DynamicTrack result = dynamic_track(scene, at_rest, options, {});
  ASSERT_TRUE(result.force);
  const DynamicFrame& first = result.frames.front();
  const DynamicFrame& last = result.frames.back();
  EXPECT_NEAR(*first.force_error, at_rest.frames.front().force->error_over_length, 1e-9);
  EXPECT_GT(std::abs(*last.force_error - at_rest.frames.back().force->error_over_length), 1e-3);
  EXPECT_EQ(result.force->largest_time, last.time);
}

TEST(DynamicTrack, RefusesARodWithoutMass) {
  const Scene scene = parse_scene(
      "[rod]\nlength = 1\nbending_stiffness = 1\nmass_per_length = 0\n[[gripper]]\nat = 0\n"
      "direction = \"60 deg\"\n[[gripper.pose]]\ntime = 0\nposition = [0, 0, 0]\n"
      "[[gripper.pose]]\ntime = 1\nposition = [0.1, 0, 0]\n",
      "refused.toml");
  EXPECT_TRUE(has_all(error_of<InputError>([&] { return require_dynamic(scene); }),
                      {"refused.toml: --dynamic: ", "no mass", "allowed"}));
}

/// Returns a round rod that its clamp moves in a medium at rest.
Scene moved_in_water(const std::string& drags) {
  return parse_scene(
      "[rod]\nlength = \"40 cm\"\ndiameter = \"4 mm\"\nbending_stiffness = 0.01\n"
      "mass_per_length = 0.03\n[medium]\ndensity = 1000\n" +
          drags +
          "[[gripper]]\nat = 0\ndirection = \"-60 deg\"\n[[gripper.pose]]\ntime = 0\n"
          "position = [0, 0, 0]\n[[gripper.pose]]\ntime = 0.3\nposition = [0.1, 0, 0]\n",
      "water.toml");
}

// The medium's drag across the rod is 1/2 rho C d per squared velocity, as that of the option
// --quadratic-drag.
TEST(DynamicTrack, AMediumAtRestDragsTheMovingRod) {
  const std::string still = "velocity = [0, 0, 0]\nnormal_drag = 1.5\n";
  const auto last_points = [](const std::string& drags, double quadratic) {
    return follow_with_inertia(moved_in_water(drags), options_at_rate(20),
                               {.material = 0.01, .quadratic = quadratic})
        .frames.back()
        .points;
  };
  const Eigen::Matrix3Xd dragged = last_points(still, 0);
  EXPECT_EQ(dragged, last_points("", 500 * 1.5 * 4e-3));
  EXPECT_GT((dragged - last_points("", 0)).norm(), 1e-2);
  const Scene along = moved_in_water(still + "tangential_drag = 0.1\n");
  EXPECT_TRUE(has_all(error_of<InputError>([&] { return require_dynamic(along); }),
                      {"medium.tangential_drag", "allowed"}));
}

// Two clamps move a wire at constant velocity. If it starts with this velocity it does not vibrate.
// Its last row is a stop, which does not affect the motion before.
TEST(DynamicTrack, ARodThatIsCarriedEvenlyStaysAsAtRest) {
  std::string text =
      "gravity = [0, 0, -9.81]\n[rod]\nlength = 0.5\nbending_stiffness = 0.005\n"
      "mass_per_length = 0.03\n";
  for (const double end : {0.0, 0.4}) {
    text += fmt::format("[[gripper]]\nat = {}\ndirection = [1, 0, 0]\n", end / 0.4 * 0.5);
    for (const int time : {0, 1, 2, 3}) {
      text += fmt::format("[[gripper.pose]]\ntime = {}\nposition = [{}, {}, {}]\n", time,
                          end + 0.3 * time, 0.1 * time, 0.05 * time);
    }
  }
  TrackOptions options = options_at_rate(20);
  options.from = 1;
  options.to = 2;
  options.solve.terms = 20;
  const DynamicTrack carried = follow_with_inertia(parse_scene(text, "carried.toml"), options, {});
  ASSERT_FALSE(carried.stopped);
  EXPECT_TRUE(carried.in_motion);
  EXPECT_LT(carried.quasi_static.largest, 1e-7);
  options.from = 0;
  const DynamicTrack started = follow_with_inertia(parse_scene(text, "carried.toml"), options, {});
  EXPECT_FALSE(started.in_motion);
  EXPECT_GT(started.quasi_static.largest, 1e-3);
}

// A clamp rotates a damped rod slowly. A simulation that begins in the middle of the motion agrees
// with one that began earlier.
TEST(DynamicTrack, BeginsInTheMiddleAsIfItHadBegunBefore) {
  const Scene scene = swung(20);
  const RodDamping damping{.material = 0.02, .air = 0.1};
  TrackOptions options = options_at_rate(5);
  const DynamicTrack all = follow_with_inertia(scene, options, damping);
  options.from = 4;
  const DynamicTrack late = follow_with_inertia(scene, options, damping);
  ASSERT_GT(late.frames.size(), 10U);
  const std::size_t before = all.frames.size() - late.frames.size();
  const auto apart = [&](std::size_t i) {
    EXPECT_NEAR(all.frames[before + i].time, late.frames[i].time, 1e-9);
    return (all.frames[before + i].points - late.frames[i].points).colwise().norm().maxCoeff();
  };
  // At first the deflection by the air is missing.
  EXPECT_LT(apart(0), 3 * scene.length * all.quasi_static.largest);
  EXPECT_LT(apart(late.frames.size() - 1), 1e-4 * scene.length);
}

// A wrist rotates one end of a curved wire, or of a straight one between two clamps. Some time
// after the rotation the wire is in equilibrium.
TEST(DynamicTrack, AWristTurnsTheWire) {
  const std::string wrist =
      "[[gripper]]\nat = 0\ndirection = [1, 0, 0]\n"
      "[[gripper.pose]]\ntime = 0\nposition = [0, 0, 0]\nroll = 0\n"
      "[[gripper.pose]]\ntime = 2\nposition = [0, 0, 0]\nroll = \"100 deg\"\n"
      "[[gripper.pose]]\ntime = 12\nposition = [0, 0, 0]\nroll = \"100 deg\"\n";
  const std::string other =
      "[[gripper]]\nat = 0.5\nposition = [0.4, 0.05, 0]\ndirection = [1, 0, 0]\nroll = 0\n";
  const std::string curved = "natural_curvature = [0, 3]\n";
  for (const auto& [rod, rest] : {std::pair(curved, std::string()), {std::string(), other}}) {
    const Scene scene = parse_scene(
        "gravity = [0, 0, -9.81]\n[rod]\nlength = 0.5\nbending_stiffness = 0.005\n"
        "torsional_stiffness = 0.004\nmass_per_length = 0.03\n" +
            rod + wrist + rest,
        "wrist.toml");
    TrackOptions options = options_at_rate(2);
    options.solve.terms = 16;  // frames that roll and those that do not take other series
    const DynamicTrack result = follow_with_inertia(scene, options, {.air = 0.3});
    ASSERT_FALSE(result.stopped);
    EXPECT_LT(result.energy_error, 1e-5);
    EXPECT_GT(result.quasi_static.largest, 2 * result.frames.back().quasi_static_error);
    EXPECT_LT(result.frames.back().quasi_static_error, 1e-5);
    EXPECT_GT((result.frames.back().points - result.frames.front().points).norm(), 0.04);
    EXPECT_GT(result.frames.back().energy.twisting, 1e-6);
  }
}

TEST(DynamicTrack, RefusesADampingThatIsNegativeOrNoNumber) {
  EXPECT_THROW((void)follow_with_inertia(swung(1), options_at_rate(10), {.material = -1}),
               InputError);
  EXPECT_THROW((void)follow_with_inertia(swung(1), options_at_rate(10), {.air = std::nan("")}),
               InputError);
}

// A clamp lays a rod on a rigid floor, or the floor comes up to it; either way they meet halfway,
// and come to rest with the forces of the track.
TEST(DynamicTrack, RigidFloorsThatStandOrMoveCarryTheRodAsAtRest) {
  const auto scene = [](const std::string& clamp, const std::string& floor) {
    return parse_scene(
        "[rod]\nlength = 1\nbending_stiffness = 1\nmass_per_length = 0.5\n[[gripper]]\nat = 0\n"
        "direction = \"0 deg\"\n" +
            clamp + "[[obstacle]]\nnormal = [0, 1, 0]\ntouches = \"axis\"\n" + floor,
        "floor.toml");
  };
  const Scene lowered = scene(
      "[[gripper.pose]]\ntime = 0\nposition = [0, 0, 0]\n"
      "[[gripper.pose]]\ntime = 0.5\nposition = [0, -0.3, 0]\n",
      "point = [0, -0.6, 0]\n");
  const Scene raised = scene("position = [0, 0, 0]\n",
                             "[[obstacle.pose]]\ntime = 0\npoint = [0, -0.6, 0]\n"
                             "[[obstacle.pose]]\ntime = 0.5\npoint = [0, -0.3, 0]\n");
  TrackOptions options = options_at_rate(20);
  options.to = 4;
  options.solve.terms = 16;
  std::vector<Eigen::Vector3d> forces;
  for (const Scene& floor : {lowered, raised}) {
    const Track at_rest = track(floor, options);
    ASSERT_FALSE(at_rest.stopped) << at_rest.stopped->why;
    const DynamicTrack result = dynamic_track(floor, at_rest, options, {.material = 0.05});
    ASSERT_FALSE(result.stopped) << result.stopped->why;
    EXPECT_LT(result.energy_error, 1e-5);
    ASSERT_TRUE(result.deepest_contact);
    EXPECT_GT(*result.deepest_contact, 0);
    EXPECT_LE(*result.deepest_contact, 1e-3);
    const DynamicFrame& last = result.frames.back();
    const TrackFrame& rest = at_rest.frames.back();
    EXPECT_GT(rest.obstacles.front().y(), 0.3);
    EXPECT_LT((last.obstacles.front() - rest.obstacles.front()).norm(),
              5e-3 * rest.obstacles.front().norm());
    EXPECT_LT(last.quasi_static_error, 1e-3);
    EXPECT_EQ(result.frames.front().obstacles.front().norm(), 0);
    forces.push_back(last.obstacles.front());
  }
  EXPECT_LT((forces[0] - forces[1]).norm(), 1e-3 * forces[0].norm());
}

/// Returns a horizontal cantilever of 1 m, 1 N m^2 and 1 kg/m that starts straight.
/// @param weight  weight per length that bends it [N/m]
Scene released_rod(double weight) {
  Scene scene =
      parse_scene(fmt::format("gravity = [0, {}, 0]\n[rod]\nlength = 1\nbending_stiffness = 1\n"
                              "mass_per_length = 1\n[[gripper]]\nat = 0\nposition = [0, 0, 0]\n"
                              "direction = [1, 0, 0]\n",
                              -weight),
                  "released.toml");
  MarkerMotion straight{.file = "straight.csv", .positions = {}};
  for (int i = 0; i <= 10; ++i) straight.positions.push_back({0, 0.1 * i, {0.1 * i, 0, 0}});
  scene.start = std::make_shared<const MarkerMotion>(straight);
  return scene;
}

TEST(DynamicTrack, ReleasesTheRodFromAGivenShape) {
  TrackOptions options = options_at_rate(40);
  options.to = 3;
  const DynamicTrack released = follow_with_inertia(released_rod(0.01), options, {});
  ASSERT_EQ(released.frames.size(), 121U);
  EXPECT_LT(released.frames.front().points.row(1).cwiseAbs().maxCoeff(), 1e-9);
  // The first mode has a period of 2 pi / 3.516 s. The other modes add less than 5 % at these
  // times.
  const auto tip_at = [&](std::size_t frame) {
    return released.frames[frame].points.rightCols<1>().y();
  };
  EXPECT_NEAR(tip_at(36) / (-2 * 0.01 / 8), 1, 0.05);
  EXPECT_NEAR(tip_at(71) / (-2 * 0.01 / 8), 0, 0.05);
}

TEST(DynamicTrack, RefusesAStartWithTooFewPointsOrWithoutAnEnd) {
  Scene scene = released_rod(1);
  TrackOptions options = options_at_rate(40);
  EXPECT_TRUE(has_all(error_of<InputError>([&] { (void)track(scene, options); }),
                      {"nothing moves", "--to"}));
  options.to = 1;
  MarkerMotion few = *scene.start;
  few.positions.resize(3);
  scene.start = std::make_shared<const MarkerMotion>(few);
  EXPECT_TRUE(has_all(error_of<InputError>([&] { (void)follow_with_inertia(scene, options, {}); }),
                      {"track.start = straight.csv", "too few points", "allowed"}));
}

}  // namespace
}  // namespace dlo::compare
