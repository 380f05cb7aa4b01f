// Solves random rods over floors, beside walls, and on cylinders, balls and capsules. Prints a
// table of the certified results and of the processor time.
//   dlo_random_contacts [--scenes N] [--frames N] [--first K] [--time-limit SECONDS]
// --scenes is the number of scenes of each kind, --frames that of rods between clamps that hold
// frames. From each certified shape of the latter a polygon is relaxed; it must not find another
// shape with less energy. Exit status: 0 if none did and no solve exceeded 1.5 times the limit, 1
// if not, 2 for bad usage.

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "dlo/energy_model/energy.hpp"
#include "polygon_of_rod.hpp"
#include "random_contact.hpp"
#include "random_options.hpp"

namespace {

using dlo::energy_model::Equilibrium;
using dlo::energy_model::Problem;

constexpr double largest_gamma = 1e5;

struct Options {
  unsigned scenes = 50;
  unsigned frames = 50;
  unsigned first = 0;
  double time_limit = 20;
};

/// Whether a polygon that is relaxed from a shape comes to rest in another shape with less energy.
/// The given shape is then no minimum.
bool polygon_finds_lower_minimum(const Problem& problem, const Equilibrium& shape) {
  constexpr Eigen::Index segments = 96;
  constexpr double least_movement = 0.05;  // in l; polygons of 96 segments are off by less
  constexpr double least_decrease = 0.02;  // decrease of energy divided by 1 + energy
  const dlo::test::PolygonOfRod polygon(problem, shape, segments);
  Eigen::Matrix3Xd forces(3, polygon.points.cols());
  const double energy = polygon_energy(polygon.problem, polygon.points, forces);
  const dlo::energy_model::PolygonResult rest = polygon.at_rest();
  if (!succeeded(rest.status)) return false;
  const double moved = (rest.points - polygon.points).colwise().norm().maxCoeff();
  return moved > least_movement * problem.length &&
         energy - rest.energy > least_decrease * (1 + std::abs(energy));
}

/// Solves scenes of one kind and prints a line of results and each fault.
/// @return how many took more than 1.5 times the limit, or are left by a polygon
template <class Scenes>
int run(const Options& options, const char* kind, bool space, unsigned scenes,
        const Scenes& scene) {
  unsigned count = 0;
  std::vector<double> seconds;
  std::map<std::string, int> refused;
  int touching = 0;
  int slow = 0;
  int left = 0;
  unsigned slowest = 0;
  for (unsigned i = 0; count < scenes && i < 20 * scenes; ++i) {
    const unsigned seed = options.first + i;
    const std::optional<Problem> problem = scene(seed, space);
    if (!problem) continue;
    ++count;
    const std::clock_t begin = std::clock();
    const Equilibrium rod = solve_energy(*problem, {.time_limit = options.time_limit});
    const double spent = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
    if (seconds.empty() || spent > *std::max_element(seconds.begin(), seconds.end())) {
      slowest = seed;
    }
    seconds.push_back(spent);
    touching += rod.contacts.empty() ? 0 : 1;
    slow += spent > 1.5 * options.time_limit ? 1 : 0;
    if (succeeded(rod.status)) {
      if (rod.twists.empty() || !polygon_finds_lower_minimum(*problem, rod)) continue;
      ++left;
      std::printf("  %s, seed %u: a polygon leaves it for less energy\n", kind, seed);
      continue;
    }
    ++refused[rod.message];
    std::printf("  %s, seed %u: %s\n", kind, seed, rod.message.c_str());
  }
  int failures = 0;
  for (const auto& [message, times] : refused) failures += times;
  if (seconds.empty()) return 0;
  std::sort(seconds.begin(), seconds.end());
  std::printf(
      "%s in %s: certified %u of %u, %d touch, %d left by polygons; median %.1f ms, 9 of 10 within "
      "%.0f ms, slowest %.2f s (seed %u)\n",
      kind, space ? "space" : "the plane", count - static_cast<unsigned>(failures), count, touching,
      left, 1e3 * seconds[seconds.size() / 2], 1e3 * seconds[seconds.size() * 9 / 10],
      seconds.back(), slowest);
  return slow + left;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  dlo::test::read_options(argc, argv,
                          {{"--scenes", dlo::test::number_reader(options.scenes)},
                           {"--frames", dlo::test::number_reader(options.frames)},
                           {"--first", dlo::test::number_reader(options.first)},
                           {"--time-limit", dlo::test::number_reader(options.time_limit)}});
  int slow = 0;
  const auto planes = [](unsigned seed, bool space) -> std::optional<Problem> {
    return dlo::test::random_touching_problem(seed, space, largest_gamma);
  };
  for (const bool space : {false, true}) {
    slow += run(options, "floors and walls", space, options.scenes, planes);
    slow += run(options, "bodies", space, options.scenes, dlo::test::random_problem_with_body);
    slow += run(options, "between frames", space, options.frames, dlo::test::random_framed_problem);
  }
  return slow == 0 ? 0 : 1;
}
