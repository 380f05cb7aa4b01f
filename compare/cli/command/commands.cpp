#include "command/commands.hpp"

namespace dlo::cli {

const std::vector<Task>& tasks() {
  static const std::vector<Task> list = {
      {"Begin", {add_init, add_materials}},
      {"See a shape", {add_solve, add_scene}},
      {"Is my simulator's shape right?", {add_check, add_suite}},
      {"Get parameters", {add_calibrate}},
      {"How far is the force model from physics, and why?", {add_compare, add_paper}},
      {"What does accuracy cost?", {add_bench, add_stability}},
      {"How does it move?", {add_track, add_modes}},
      {"Many scenes", {add_sweep}},
      {"Keep it from getting worse", {add_regress}},
  };
  return list;
}

}  // namespace dlo::cli
