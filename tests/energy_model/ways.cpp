// One solve of a scene, and nothing else: what tests/ways looks at (energy_model/doc/ways.md).
//
//     dlo_ways clamp|space|floor

#include <cstdio>
#include <optional>
#include <string_view>

#include "dlo/energy_model/energy.hpp"

namespace {

/// A rod of unit length and stiffness, Gamma = 10, clamped at the origin.
std::optional<dlo::energy_model::Problem> scene(std::string_view name) {
  dlo::energy_model::Problem problem;
  problem.length = 1;
  problem.bending_stiffness = 1;
  problem.weight_per_length = {0, -10, 0};
  problem.grips = {{.at = 0, .position = {0, 0, 0}, .direction = {{1, 0, 0}}}};
  if (name == "clamp") return problem;
  if (name == "space") {
    problem.grips[0].direction = {{1, 0, 0.3}};
    problem.grips.push_back({.at = 1, .position = {0.8, 0, 0}, .direction = {{1, 0, -0.3}}});
    return problem;
  }
  if (name == "floor") {
    problem.obstacles = {{dlo::obstacle::Body::half_space({0, -0.3, 0}, {0, 1, 0})}};
    return problem;
  }
  return std::nullopt;
}

}  // namespace

int main(int argc, char** argv) {
  const std::optional<dlo::energy_model::Problem> problem = scene(argc == 2 ? argv[1] : "");
  if (!problem) {
    std::fprintf(stderr, "dlo_ways: clamp, space or floor\n");
    return 2;
  }
  const dlo::energy_model::Equilibrium shape = dlo::energy_model::solve_energy(*problem);
  std::printf("%s, %zu contacts\n", shape.message.c_str(), shape.contacts.size());
  return succeeded(shape.status) ? 0 : 1;
}
