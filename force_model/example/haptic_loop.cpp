// A haptic loop around the force model, on one core: every millisecond a hand moves the gripper and
// feels its force and torque, every 40 ms a sensor moves the walls, and in between the model steps.
// Frames run one after the other, as fast as they can; what is measured is the time that each one
// would have taken of its millisecond.

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <numbers>
#include <string_view>
#include <vector>

#include "dlo/force_model/simulation.hpp"

namespace {

using namespace dlo::force_model;

constexpr int frames_per_second = 1000;
constexpr int frames_per_wall_update = 40;  // 25 Hz
constexpr double frame_budget = 1e-3;       // [s]

struct Settings {
  double seconds = 60;  // simulated
  int steps_per_frame =
      30;  // 30 kHz, the highest rate in the paper; one step suffices for `implicit`
  Stepper stepper = Stepper::automatic;
};

/// Steel wire of 0.5 mm, 30 cm long, which is soft enough for a hand. The stretch stiffness of
/// steel, 41 kN, has no effect at these forces and would only require smaller steps.
struct Wire {
  static constexpr double length = 0.3;           // [m]
  static constexpr double EI = 6.44e-4;           // [N m^2]
  static constexpr double c_c = 100;              // [N]
  static constexpr double weight = 0.01522;       // per length [N/m]
  static constexpr double grip_stiffness = 1000;  // [N/m]
  static constexpr double wall_stiffness = 100;   // [N/m]
};

/// Computes the targets of the gripper in the hand: a smooth path, up to 0.35 m/s and 134 deg/s.
void follow_hand(double time, double segment, Eigen::Matrix3Xd& targets) {
  const double turn = 2 * std::numbers::pi * time;
  const Eigen::Vector3d position(0.1 * std::sin(0.5 * turn), 0.05 * std::sin(0.37 * turn),
                                 0.05 * std::sin(0.23 * turn));
  const double pitch = 0.8 * std::sin(0.4 * turn);
  const double yaw = 0.6 * std::sin(0.31 * turn);
  targets.col(0) = position;
  targets.col(1) =
      position + segment * Eigen::Vector3d(std::cos(pitch) * std::cos(yaw), std::sin(pitch),
                                           std::cos(pitch) * std::sin(yaw));
}

/// Returns a table below the hand that moves and tilts, and a wall in front of it.
std::array<Wall, 2> walls_at(double time) {
  const double turn = 2 * std::numbers::pi * time;
  const double tilt = 0.2 * std::sin(0.1 * turn);
  return {Wall{.point = {0, -0.1 + 0.02 * std::sin(0.2 * turn), 0},
               .normal = {std::sin(tilt), std::cos(tilt), 0},
               .stiffness = Wire::wall_stiffness},
          Wall{.point = {0.38, 0, 0}, .normal = {-1, 0, 0}, .stiffness = Wire::wall_stiffness}};
}

Simulation make_simulation(int points, double segment, const Eigen::Matrix3Xd& targets,
                           Stepper stepper) {
  Rod rod;
  rod.rest_lengths = Eigen::VectorXd::Constant(points - 1, segment);
  rod.c_c = Wire::c_c;
  rod.bending = {BendingLaw::hooke, Wire::EI};
  rod.loads.setZero(3, points);
  rod.loads.row(1).setConstant(-Wire::weight * segment);
  for (const Wall& wall : walls_at(0)) rod.walls.push_back(wall);
  rod.grips = {Grip{.first_point = 0,
                    .targets = targets,
                    .reference = targets.col(0),
                    .hold = GripHold::spring,
                    .stiffness = Wire::grip_stiffness}};
  Eigen::Matrix3Xd straight(3, points);
  for (int i = 0; i < points; ++i) {
    straight.col(i) = targets.col(0) + i * (targets.col(1) - targets.col(0));
  }
  StepOptions options;
  options.policy = policy(stepper);
  return {rod, straight, options};
}

/// Returns the computing time of this thread [s], without the time of other processes.
double computing_time() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double elapsed_time() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Prints one line on the times of all frames [us]. @param times  [s]; sorted by this call
void print_times(const char* what, std::vector<double>& times) {
  std::sort(times.begin(), times.end());
  const auto percentile = [&](double percent) {
    const auto rank = static_cast<std::size_t>(percent / 100 * static_cast<double>(times.size()));
    return 1e6 * times[std::min(rank, times.size() - 1)];
  };
  const auto misses = times.end() - std::upper_bound(times.begin(), times.end(), frame_budget);
  std::printf("  %-10s %9.1f %9.1f %9.1f %9.1f %8ld\n", what, percentile(50), percentile(99),
              percentile(99.9), 1e6 * times.back(), static_cast<long>(misses));
}

/// Runs the loop. @return false if the simulation diverged
bool run(int points, const Settings& settings) {
  const double segment = Wire::length / (points - 1);
  Eigen::Matrix3Xd targets(3, 2);
  follow_hand(0, segment, targets);
  Simulation simulation = make_simulation(points, segment, targets, settings.stepper);
  const auto frames = static_cast<std::size_t>(settings.seconds * frames_per_second);
  std::vector<double> computing(frames);
  std::vector<double> elapsed(frames);
  Eigen::Matrix3Xd positions(3, points);
  Eigen::Matrix3Xd forces(3, points);
  std::array<GripReaction, 1> felt;
  double largest_force = 0;
  double largest_torque = 0;
  for (std::size_t frame = 0; frame < frames; ++frame) {
    const double start = elapsed_time();
    const double start_computing = computing_time();
    const double time = static_cast<double>(frame) / frames_per_second;
    follow_hand(time, segment, targets);
    simulation.move_grip(0, targets, targets.col(0));
    if (frame % frames_per_wall_update == 0) {
      const std::array<Wall, 2> walls = walls_at(time);
      for (std::size_t i = 0; i < walls.size(); ++i) simulation.move_wall(i, walls[i]);
    }
    for (int i = 0; i < settings.steps_per_frame; ++i) {
      if (simulation.step().status == StepStatus::diverged) return false;
    }
    simulation.copy_points(positions);
    grip_reactions(simulation.rod(), positions, forces, felt);
    computing[frame] = computing_time() - start_computing;
    elapsed[frame] = elapsed_time() - start;
    largest_force = std::max(largest_force, felt[0].force.norm());
    largest_torque = std::max(largest_torque, felt[0].torque.norm());
  }
  std::printf("N = %d, %g s at 1 kHz, %d step%s a frame: largest force %.3g N, torque %.3g N m\n",
              points, settings.seconds, settings.steps_per_frame,
              settings.steps_per_frame == 1 ? "" : "s", largest_force, largest_torque);
  std::printf("  %-10s %9s %9s %9s %9s %8s\n", "[us/frame]", "50 %", "99 %", "99.9 %", "max",
              "> 1 ms");
  print_times("computing", computing);
  print_times("elapsed", elapsed);
  return true;
}

int usage() {
  std::fputs("usage: dlo_haptic_loop [--seconds S] [--steps 1..1000 | --stepper implicit]\n",
             stderr);
  return 2;
}

}  // namespace

int main(int argc, char** argv) {
  Settings settings;
  for (int i = 1; i < argc; i += 2) {
    const std::string_view option = argv[i];
    if (i + 1 == argc) return usage();
    if (option == "--stepper" && std::string_view(argv[i + 1]) == "implicit") {
      settings.stepper = Stepper::implicit;
      settings.steps_per_frame = 1;
      continue;
    }
    const double value = std::atof(argv[i + 1]);
    if (option == "--seconds" && value >= 0.001 && value <= 3600) {
      settings.seconds = value;
    } else if (option == "--steps" && value >= 1 && value <= 1000) {
      settings.steps_per_frame = static_cast<int>(value);
    } else {
      return usage();
    }
  }
  try {
    for (const int points : {10, 64}) {
      if (!run(points, settings)) {
        std::fprintf(stderr, "N = %d: diverged\n", points);
        return 3;
      }
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
  return 0;
}
