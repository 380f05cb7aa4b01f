#include "paper/paper.hpp"

#include <fmt/format.h>

#include <cmath>

#include "dlo/compare/chain.hpp"
#include "dlo/compare/deviation.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/reference.hpp"
#include "dlo/compare/scene_file.hpp"
#include "dlo/compare/solution.hpp"
#include "dlo/force_model/simulation.hpp"
#include "paper/printed_tables.hpp"
#include "polygon/point_layout.hpp"

namespace dlo::compare {
namespace {

constexpr double history_times[] = {1, 2, 5, 10, 20, 28, 30, 32, 40, 60, 100, last_history_time};

/// Computes E*/E of the chain's rest shape, which has no time steps and so neither creep nor
/// stretch.
ModulusVariant variant(const Scene& original, const std::string& what,
                       const std::function<void(ForceModelSettings&)>& change,
                       double load_factor = 1) {
  Scene scene = original;
  scene.gravity *= load_factor;
  change(scene.force_model);
  ModulusVariant result;
  result.varied = what;
  result.settings = scene.force_model;
  result.load_factor = load_factor;
  result.gamma = scene.gamma();
  const Shape shape = solve_chain(scene, scene.force_model).shape;
  const energy_model::Equilibrium energy = solve_reference(scene, Model::energy);
  result.modulus = fit_effective_modulus(scene, distance_from(shape), energy);
  result.rms_over_length = distance(shape, energy.sample) / scene.length;
  return result;
}

std::vector<ModulusVariant> variants(const Scene& scene) {
  std::vector<ModulusVariant> result;
  const auto unchanged = [](ForceModelSettings&) {};
  for (const double load : {0.01, 0.1, 1.0, 10.0, 100.0, 1000.0}) {
    result.push_back(variant(scene, "load", unchanged, load));
  }
  for (const int points : {6, 8, 16, 32, 64}) {
    result.push_back(variant(scene, "points", [&](ForceModelSettings& s) { s.points = points; }));
  }
  result.push_back(variant(scene, "moment matched at k", [](ForceModelSettings& s) {
    s.bending_rule = BendingRule::moment_matched;
  }));
  result.push_back(variant(scene, "moment matched at the clamp", [](ForceModelSettings& s) {
    s.bending_rule = BendingRule::moment_matched;
    s.design_curvature.reset();
  }));
  result.push_back(variant(scene, fmt::format("weight of a point {} N", printed_point_weight()),
                           [](ForceModelSettings& s) { s.point_weight = printed_point_weight(); }));
  result.push_back(variant(scene, "bookkeeping",
                           [](ForceModelSettings& s) { s.bookkeeping = Bookkeeping::consistent; }));
  result.push_back(variant(scene, "law", [](ForceModelSettings& s) { s.law = BendingLaw::hooke; }));
  result.push_back(variant(scene, "law and bookkeeping", [](ForceModelSettings& s) {
    s.law = BendingLaw::hooke;
    s.bookkeeping = Bookkeeping::consistent;
  }));
  return result;
}

/// Steps a scene from its initial shape (straight, for a single gripper) with the stepper `basic`
/// and fits E*/E after 1, 2, 5, ... 200 s of simulated time. c_F is the scene's or Table 1's 0.86
/// L/(2 c_c), so simulated times are comparable only for equal c_c.
/// @param rest  rest shape of the force model with the same c_c
/// @param[out] c_F  of the steps [m/N]
/// @throws InputError, ConvergenceError, also if the steps diverge
std::vector<ModulusAtTime> modulus_history(const Scene& scene, const Shape& rest, double& c_F) {
  ForceModelSettings settings = scene.force_model;
  settings.stepper = Stepper::basic;
  const Discretisation discretisation = discretise(scene, settings);
  const force_model::StepOptions options = step_options(settings, discretisation);
  force_model::Simulation simulation(discretisation.rod, discretisation.starts.front(), options);
  const energy_model::Equilibrium energy = solve_reference(scene, Model::energy);
  std::vector<ModulusAtTime> history;
  c_F = options.c_F;
  for (const double time : history_times) {
    const auto target = static_cast<long>(time * paper_steps_per_second);
    while (simulation.steps() < target) {
      if (simulation.step().status == force_model::StepStatus::diverged) {
        throw ConvergenceError(fmt::format("{}: the force model diverged at step {} (c_F = {:.4g})",
                                           scene.name, simulation.steps(), options.c_F));
      }
    }
    const Shape shape = discretisation.shape(simulation.points());
    ModulusAtTime at;
    at.time_s = time;
    at.steps = simulation.steps();
    at.modulus = fit_effective_modulus(scene, distance_from(shape), energy);
    at.rms_over_length = distance(shape, energy.sample) / scene.length;
    at.rest_distance_over_length = rms(shape.arc_length, shape.points - rest.points) / scene.length;
    history.push_back(at);
  }
  return history;
}

}  // namespace

double PaperCase::time_at_one_third() const {
  for (std::size_t i = 0; i + 1 < creep.size(); ++i) {
    const double before = 3 * creep[i].modulus.ratio;
    const double after = 3 * creep[i + 1].modulus.ratio;
    if (before >= 1 && after < 1) {
      const double share = std::log(before) / std::log(before / after);
      return creep[i].time_s * std::pow(creep[i + 1].time_s / creep[i].time_s, share);
    }
  }
  return NAN;
}

PaperReport paper_report(const Stages& progress) {
  const auto say = [&](const std::string& what) {
    if (progress) progress(what);
  };
  PaperReport report;
  report.c_c = printed_contraction_stiffness();
  report.steps_per_second = paper_steps_per_second;
  report.tables = recompute_tables();
  for (const PaperWeight weight : {PaperWeight::from_rod, PaperWeight::printed}) {
    for (Scene scene : paper_scenes()) {
      scene.force_model.c_c = printed_contraction_stiffness();
      if (weight == PaperWeight::printed) scene.force_model.point_weight = printed_point_weight();
      say(fmt::format("{}: to rest, and {} s of simulated time", scene.name, last_history_time));
      PaperCase entry;
      entry.weight = weight;
      entry.rest = compare(scene, {}, PlanOptions{});
      entry.creep = modulus_history(scene, entry.rest.force.shape, report.c_F);
      report.cases.push_back(std::move(entry));
    }
  }
  say("E*/E against load, points, law");
  report.variants = variants(paper_scenes().front());
  report.assumptions = {
      "Figs. 12 and 13 print no numbers: their shapes are computed here, not read off.",
      "The simulation starts straight along the gripper; the paper does not state the initial "
      "shape.",
      "4000 steps per simulated second: Table 2's 112000 steps in 28 s.",
      fmt::format("No dynamics on the way to rest, {} as in Table 1's proportion; the paper gives "
                  "neither for this experiment.",
                  table_1_step_formula),
      fmt::format("c_c = {} N, the value that the text gives for Fig. 12.",
                  printed_contraction_stiffness()),
      "Formula 4 with the signs that balance (as printed, a joint drives itself).",
      fmt::format(
          "Masses m/N on every point, the two points next to the gripper held, both models clamped "
          "at the rod's end; g = 9.81 m/s^2. Table 5 prints Table 1's weight of a point, {} N, "
          "which is 17 % too much for this rod; both are followed, the energy model keeping rho A "
          "g, so that with the printed weight E*/E also carries this ratio of weights.",
          printed_point_weight()),
      "The energy model is exact here; the paper's own [8] used a few basis functions.",
  };
  return report;
}

}  // namespace dlo::compare
