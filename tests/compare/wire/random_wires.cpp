// Writes six shapes of a random wire, mounted six times between the two clamps of a fixture. The
// clamps are not known accurately. data/mountings was written with SEED = 11.
//
//     dlo_random_wires --write FOLDER SEED

#include <fmt/format.h>

#include <cstdlib>
#include <fstream>
#include <iostream>
#include <string>

#include "random_wire.hpp"

int main(int argc, char** argv) {
  if (argc != 4 || std::string(argv[1]) != "--write") {
    std::cerr << "usage: dlo_random_wires --write FOLDER SEED\n";
    return 2;
  }
  constexpr int pictures = 6;
  const dlo::test::Wire wire =
      dlo::test::random_wire(static_cast<unsigned>(std::atoi(argv[3])), pictures);
  for (std::size_t i = 0; i < wire.shapes.size(); ++i) {
    std::ofstream file(fmt::format("{}/mounting_{}.csv", argv[2], i + 1));
    file << "x,y,z\n";
    for (const auto& point : wire.shapes[i].points.colwise()) {
      file << fmt::format("{:.4f},{:.4f},{:.4f}\n", point.x(), point.y(), point.z());
    }
  }
  fmt::print("EI = {:.6g} N m^2\n", wire.EI);
  return 0;
}
