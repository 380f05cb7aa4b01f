#pragma once

#include <fstream>
#include <string>

#include "command_fixture.hpp"

namespace dlo::test {

/// Fixture for the command calibrate: rods and their observed shapes.
class CalibrateCommand : public Command {
 protected:
  std::string scene_of(const std::string& name, const std::string& modulus, double angle,
                       const std::string& more = "") {
    std::ofstream(path(name)) << "[rod]\nlength = 1\ndiameter = \"4 mm\"\nmaterial = { "
                                 "youngs_modulus = \""
                              << modulus
                              << "\", density = 1200 }\n[[gripper]]\nat = 0\nposition = [0, 0, 0]\n"
                                 "direction = \""
                              << angle << " deg\"\n"
                              << more;
    return path(name);
  }
  /// Writes the exact shape of a scene, without arc lengths, and returns the file's name.
  std::string seen(const std::string& scene, const std::string& name) {
    return write_table(name, "x,y,z", solved_points(scene + " --model exact --samples 9"));
  }
};

}  // namespace dlo::test
