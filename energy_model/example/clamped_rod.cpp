// A steel wire, 50 cm long and 2 mm thick, clamped horizontally: its tip, energy and gripper
// torque.

#include <cstdio>
#include <numbers>

#include "dlo/energy_model/energy.hpp"

int main() {
  constexpr double diameter = 2e-3;                                    // [m]
  constexpr double area = std::numbers::pi * diameter * diameter / 4;  // [m^2]
  constexpr double EI = 210e9 * area * diameter * diameter / 16;       // [N m^2]
  const dlo::energy_model::Problem rod{
      .length = 0.5,
      .bending_stiffness = EI,
      .weight_per_length = {0, -7850 * 9.81 * area, 0},
      .grips = {{.at = 0, .position = {0, 0, 0}, .direction = {{1, 0, 0}}}}};

  const dlo::energy_model::Equilibrium shape = dlo::energy_model::solve_energy(rod);
  if (!succeeded(shape.status)) {
    std::fprintf(stderr, "%s: %s\n", to_string(shape.status), shape.message.c_str());
    return 3;
  }
  const double end[] = {rod.length};
  const Eigen::Vector3d tip = shape.sample(end).points.col(0);
  std::printf("tip      %.4f %.4f m\n", tip.x(), tip.y());
  std::printf("energy   %.6f J\n", shape.energy.total());
  std::printf("torque   %.6f N m on the rod at its clamp\n", shape.grips[0].torque.z());
  return 0;
}
