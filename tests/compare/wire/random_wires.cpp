// Whether calibrate predicts wires as they are, by itself: random wires between two clamps, hung
// five times each in one fixture that nobody knows well.
//
//     dlo_random_wires WIRES SEED
//     dlo_random_wires --write FOLDER SEED
//
// Prints for each wire the choice, the prediction error divided by the repeatability of the
// mountings, and whether the interval of E contains the true value; the fractions follow at the
// end. With --write the mountings of one wire are written, one more than are fitted (data/mountings
// has seed 11).

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <string>
#include <vector>

#include "dlo/compare/error.hpp"
#include "dlo/compare/material_fit.hpp"
#include "random_wire.hpp"

namespace {

using namespace dlo::compare;
using dlo::test::Wire;
using dlo::test::wire_of;

constexpr int mountings = 5;

struct Outcome {
  bool predicted = false;
  bool held = false;
  bool chosen_as_made = false;
};

Outcome outcome_of(unsigned seed) {
  const Wire wire = wire_of(seed, mountings);
  const double EI = wire.EI;
  const MaterialFit fit =
      calibrate(wire.scenes, wire.shapes, {.choose_options = true, .solve = {.time_limit = 100}})
          .fit;
  const FitAlternative& chosen = fit.tried.front();
  const double ratio =
      fit.prediction ? fit.prediction->rms_m / *fit.prediction->repeatability_m : 1;
  const double low = fit.youngs_modulus.low.value_or(0);
  const double high = fit.youngs_modulus.high.value_or(INFINITY);
  const Outcome result{
      .predicted = ratio <= 1.1,
      .held = low <= EI && EI <= high,
      .chosen_as_made = chosen.shared_clamps && chosen.natural_curvature_terms > 1};
  fmt::print(
      "{:5} {} terms, clamps {}: prediction / repeatability {:.3f}, residual {:.3g} mm, EI / truth "
      "{:.3f} to {:.3f}\n",
      seed, chosen.natural_curvature_terms,
      chosen.shared_clamps             ? "alike"
      : chosen.direction_tolerance > 0 ? "own"
                                       : "as said",
      ratio, fit.rms_m * 1e3, low / EI, high / EI);
  std::fflush(stdout);
  return result;
}

/// Writes the mountings of a wire, and next to them the scene, which is the same for all.
void write(const std::string& folder, unsigned seed) {
  const Wire wire = wire_of(seed, mountings + 1);
  for (std::size_t i = 0; i < wire.shapes.size(); ++i) {
    std::ofstream file(fmt::format("{}/mounting_{}.csv", folder, i + 1));
    file << "x,y,z\n";
    for (const auto& point : wire.shapes[i].points.colwise()) {
      file << fmt::format("{:.4f},{:.4f},{:.4f}\n", point.x(), point.y(), point.z());
    }
  }
  fmt::print("EI = {:.6g} N m^2\n", wire.EI);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 3 && std::string(argv[1]) == "--write") {
    write(argv[2], static_cast<unsigned>(std::atoi(argv[3])));
    return 0;
  }
  const int wires = argc > 1 ? std::atoi(argv[1]) : 20;
  const unsigned first = argc > 2 ? static_cast<unsigned>(std::atoi(argv[2])) : 1;
  int predicted = 0;
  int held = 0;
  int as_made = 0;
  int failed = 0;
  for (int i = 0; i < wires; ++i) {
    try {
      const Outcome outcome = outcome_of(first + static_cast<unsigned>(i));
      predicted += outcome.predicted ? 1 : 0;
      held += outcome.held ? 1 : 0;
      as_made += outcome.chosen_as_made ? 1 : 0;
    } catch (const std::exception& error) {
      ++failed;
      fmt::print("{:5} {}\n", first + static_cast<unsigned>(i), error.what());
    }
  }
  fmt::print(
      "of {} wires: predicted within 1.1 times the repeatability {}, interval of EI holds {}, "
      "options as made {}, no fit {}\n",
      wires, predicted, held, as_made, failed);
  return 0;
}
