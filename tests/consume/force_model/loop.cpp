// A wire in a 1 kHz loop: every millisecond a hand moves the gripper, the wire follows, and the
// hand gets back the force that it has to bear.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <dlo/force_model/simulation.hpp>
#include <numbers>

using namespace dlo::force_model;

int main() {
  // Steel, 0.5 mm thick, 30 cm from the gripper to the free end. The gripper holds the middle of
  // the first segment.
  constexpr int points = 16;
  constexpr double length = 0.3;                       // [m]
  constexpr double segment = length / (points - 1.5);  // [m]
  constexpr double weight = 0.01522;                   // [N/m]
  const auto hold_at = [&](double height) {
    return grip_targets({0, height, 0}, Eigen::Vector3d::UnitX(), segment, segment / 2);
  };

  Rod rod;
  rod.rest_lengths.setConstant(points - 1, segment);
  rod.c_c = 41e3;                              // A E [N]
  rod.bending = {BendingLaw::hooke, 6.44e-4};  // EI [N m^2]
  rod.loads.setZero(3, points);
  rod.loads.row(1).tail(points - 1).setConstant(-weight * segment);
  rod.loads(1, points - 1) /= 2;
  // A hand's gripper yields: with this spring the tip hangs 0.89 mm too low. With
  // GripHold::rigid, as for a robot, it is 0.06 mm off.
  rod.grips = {{.first_point = 0,
                .targets = hold_at(0),
                .hold = GripHold::spring,
                .stiffness = 1000}};  // [N/m]

  Eigen::Matrix3Xd shape(3, points);  // straight, as the gripper holds it [m]
  for (int i = 0; i < points; ++i) shape.col(i) << (i - 0.5) * segment, 0, 0;
  Simulation simulation(rod, shape, {.policy = policy(Stepper::implicit)});

  // From here on the model allocates nothing.
  Eigen::Matrix3Xd targets = hold_at(0);
  Eigen::Matrix3Xd forces(3, points);
  std::array<GripReaction, 1> reaction;
  for (int millisecond = 1; millisecond <= 2000; ++millisecond) {
    // The gripper rises by 10 cm within a second.
    const double time = std::min(1e-3 * millisecond, 1.0);
    targets.row(1).setConstant(0.05 * (1 - std::cos(std::numbers::pi * time)));
    simulation.move_grip(0, targets, {0, targets(1, 0), 0});
    if (simulation.step().status == StepStatus::diverged) return 3;
    simulation.copy_points(shape);
    grip_reactions(simulation.rod(), shape, forces, reaction);
    if (millisecond % 250 == 0) {
      std::printf("%4d ms  tip at %6.2f cm, force %7.3f mN, torque %7.4f mN m\n", millisecond,
                  100 * shape(1, points - 1), 1e3 * reaction[0].force.y(),
                  1e3 * reaction[0].torque.z());
    }
  }
}
