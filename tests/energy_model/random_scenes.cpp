// Random scenes, the minimiser against multiple shooting, each shape against force and torque
// balance. Prints what converged, what was refused and why, the slowest, and how both agree.
//   dlo_random_scenes [--plane N] [--space N] [--twisted N] [--curved N] [--mixed N] [--strip N]
//   [--first K] [--time-limit SECONDS] [--exact search|energy] [--write FOLDER]
// With `--exact energy` multiple shooting confirms the minimiser's shapes without a search.
//   dlo_random_scenes --balance N [--first K] [--time-limit SECONDS]
// Instead solves N scenes of all kinds (random_balance.hpp) with every model and prints the largest
// imbalance of each: 0 if no solver has refused a shape because of its balance; 1 if one has.
// Ends with 0 if no two converged shapes contradict each other, no equilibrium is out of balance
// and no solve took more than 1.5 times the limit; 1 if not; 2 for bad usage.

#include "random_scenes.hpp"

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <stdexcept>

#include "random_balance.hpp"
#include "random_options.hpp"

namespace {

using dlo::energy_model::Equilibrium;
using dlo::test::Agreement;
using dlo::test::ComparedScene;
using dlo::test::RandomSpace;

struct Options {
  std::uint64_t plane = 200;
  std::uint64_t space = 200;
  std::uint64_t twisted = 100;
  std::uint64_t curved = 100;
  std::uint64_t mixed = 100;
  std::uint64_t strip = 100;
  std::uint64_t balance = 0;
  std::uint64_t first = 0;
  double time_limit = 20;
  dlo::test::ExactFrom exact = dlo::test::ExactFrom::search;
  std::string folder;
};

/// Results of one model in all scenes of a kind.
struct Tally {
  int converged = 0;
  std::map<std::string, int> refused;  // messages
  double slowest = 0;
  std::uint64_t slowest_scene = 0;
  double worst_defect = 0;
  std::uint64_t worst_scene = 0;

  void add(std::uint64_t number, const Equilibrium& result, double defect, double seconds) {
    if (succeeded(result.status)) {
      ++converged;
      if (!(defect <= worst_defect)) {
        worst_defect = defect;
        worst_scene = number;
      }
    } else {
      ++refused[result.message];
    }
    if (seconds > slowest) {
      slowest = seconds;
      slowest_scene = number;
    }
  }

  void print(const char* model, std::uint64_t count) const {
    std::printf(
        "  %-6s converged %d of %lu (%.1f %%), slowest %.2f s (scene %lu), largest defect "
        "of balance %.1e (scene %lu)\n",
        model, converged, count, 100.0 * converged / static_cast<double>(count), slowest,
        slowest_scene, worst_defect, worst_scene);
    for (const auto& [message, times] : refused) {
      std::printf("         refused %d: %s\n", times, message.c_str());
    }
  }
};

/// A shape whose forces and torques do not balance to this is no equilibrium.
constexpr double largest_defect = 1e-6;

/// Solves random scenes by both models and prints a summary and each fault.
/// @return number of scenes with a fault: results that contradict each other, forces and torques
/// that do not balance, or a solve that exceeds 1.5 times the time limit
int run(const Options& options, RandomSpace space, std::uint64_t count) {
  const char* kind = dlo::test::name_of(space);
  if (count == 0) return 0;
  Tally energy;
  Tally exact;
  std::map<Agreement, int> agreements;
  int lower = 0;
  int bad = 0;
  for (std::uint64_t number = options.first; number < options.first + count; ++number) {
    const dlo::energy_model::Problem problem = dlo::test::random_problem(number, space);
    const auto report = [&](const std::string& what) {
      std::printf("  %s %lu: %s\n", kind, number, what.c_str());
      // A scene file has one natural curvature, not a series.
      if (options.folder.empty() || has_material_directors(problem)) return;
      const std::string name = std::string(kind) + "_" + std::to_string(number);
      std::ofstream(options.folder + "/" + name + ".toml") << dlo::test::scene_text(problem, name);
    };
    const ComparedScene scene =
        dlo::test::compare_models(number, problem, options.time_limit, options.exact);
    energy.add(number, scene.energy, scene.energy_defects.worst(), scene.energy.seconds);
    exact.add(number, scene.exact, scene.exact_defects.worst(), scene.exact.seconds);
    ++agreements[scene.agreement];
    if (!succeeded(scene.energy.status)) report("energy: " + scene.energy.message);
    if (!succeeded(scene.exact.status)) report("exact: " + scene.exact.message);
    bool wrong = false;
    if (scene.agreement == Agreement::contradict) {
      report("shapes " + std::to_string(scene.distance) + " l apart, energies " +
             std::to_string(scene.energy.energy.total()) + " and " +
             std::to_string(scene.exact.energy.total()) + ", smallest eigenvalue " +
             std::to_string(scene.energy.smallest_eigenvalue) + " and " +
             std::to_string(scene.exact.smallest_eigenvalue));
      wrong = true;
    }
    if (scene.agreement == Agreement::both_stable &&
        scene.exact.energy.total() < scene.energy.energy.total()) {
      ++lower;
    }
    const double defect = std::max(scene.energy_defects.worst(), scene.exact_defects.worst());
    if (!(defect <= largest_defect)) {
      report("out of balance: " + std::to_string(defect));
      wrong = true;
    }
    // A solve may finish the evaluation that it is in.
    const double slowest = std::max(scene.energy.seconds, scene.exact.seconds);
    if (slowest > 1.5 * options.time_limit) {
      report("took " + std::to_string(slowest) + " s");
      wrong = true;
    }
    bad += wrong ? 1 : 0;
  }
  std::printf("%s, %lu scenes\n", kind, count);
  energy.print("energy", count);
  exact.print("exact", count);
  std::printf(
      "  both converged: %d the same to 1e-8 l, %d images, %d other stable ones (exact "
      "lower in %d), %d contradict\n",
      agreements[Agreement::same], agreements[Agreement::image], agreements[Agreement::both_stable],
      lower, agreements[Agreement::contradict]);
  return bad;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  dlo::test::OptionReaders readers = {
      {"--time-limit", dlo::test::number_reader(options.time_limit)},
      {"--write", [&](const std::string& value) { options.folder = value; }},
      {"--exact", [&](const std::string& value) {
         if (value != "search" && value != "energy") {
           throw std::invalid_argument("--exact " + value + " (allowed: search, energy)");
         }
         if (value == "energy") options.exact = dlo::test::ExactFrom::energy;
       }}};
  const std::map<std::string, std::uint64_t*> counts = {
      {"--plane", &options.plane},     {"--space", &options.space}, {"--twisted", &options.twisted},
      {"--curved", &options.curved},   {"--mixed", &options.mixed}, {"--strip", &options.strip},
      {"--balance", &options.balance}, {"--first", &options.first}};
  for (const auto& [name, count] : counts) readers[name] = dlo::test::number_reader(*count);
  dlo::test::read_options(argc, argv, readers);
  if (options.balance > 0) {
    return dlo::test::print_imbalances(options.first, options.balance, options.time_limit) == 0 ? 0
                                                                                                : 1;
  }
  const int bad = run(options, RandomSpace::plane, options.plane) +
                  run(options, RandomSpace::space, options.space) +
                  run(options, RandomSpace::twisted, options.twisted) +
                  run(options, RandomSpace::curved, options.curved) +
                  run(options, RandomSpace::mixed, options.mixed) +
                  run(options, RandomSpace::strip, options.strip);
  std::printf("%d scenes contradict, are out of balance or overran the limit\n", bad);
  return bad == 0 ? 0 : 1;
}
