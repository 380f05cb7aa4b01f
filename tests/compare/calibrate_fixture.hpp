#pragma once

#include <fmt/format.h>

#include <string>

#include "../helpers.hpp"
#include "command_fixture.hpp"
#include "scene_text.hpp"

namespace dlo::test {

/// Fixture for the command calibrate: rods and their observed shapes.
class CalibrateCommand : public Command {
 protected:
  std::string scene_of(const std::string& name, const std::string& modulus, double angle,
                       const std::string& more = "") {
    const std::string rod =
        "[rod]\nlength = 1\ndiameter = \"4 mm\"\nmaterial = { youngs_modulus = \"" + modulus +
        "\", density = 1200 }\n";
    return write(name, rod + gripper_text(fmt::format("direction = \"{} deg\"", angle)) + more);
  }
  /// Writes 9 points of the exact shape of a scene file, without arc lengths, and returns the path
  /// of the written file.
  std::string write_exact_shape(const std::string& scene, const std::string& name) {
    return write_table(name, "x,y,z", solved_points(scene + " --model exact --samples 9"));
  }
};

}  // namespace dlo::test
