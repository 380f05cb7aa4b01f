#include "dlo/energy_model/energy.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <string>

#include "cantilever.hpp"
#include "legendre.hpp"
#include "minimise.hpp"
#include "require.hpp"

namespace dlo::energy_model {
namespace {

/// Gradient norm at which L-BFGS hands over: two Newton steps square it to below rounding, while
/// its own line search, which compares energies, would stall near the root of the rounding error.
constexpr double handover_gradient = 1e-5;

/// Above this sum of weight and loads (in EI/l^2) a rod is nearer to its soft limit than to
/// straight.
constexpr double soft_load = 12;

struct Found {
  SolveStatus status = SolveStatus::not_run;
  std::string message;
  int evaluations = 0;
  double gradient = -1;
  Eigen::VectorXd coefficients;
};

double total_load(const PlanarCantilever& rod) {
  double total = rod.weight.norm();
  for (const PlanarCantilever::Load& load : rod.loads) total += load.force.norm();
  return total;
}

/// Coefficients of each piece that resolve a rod under this load to about 1e-10 of its length. A
/// softer rod has its clamp's layer in pieces of its own.
int first_terms(double load) {
  const double needed = 8 * std::pow(std::clamp(load, 1.0, 1000.0), 0.24);
  return static_cast<int>(std::ceil(needed));
}

/// Newton steps from a point near a minimum; they also tell a minimum from a saddle.
void polish(CantileverEnergy& energy, Found& found, double load) {
  Eigen::VectorXd gradient(energy.size());
  Eigen::MatrixXd hessian;
  const double tolerance = 1e-13 * (1 + load);
  double previous = HUGE_VAL;
  for (int step = 0; step < 8; ++step) {
    (void)energy.value(found.coefficients, gradient);
    ++found.evaluations;
    found.gradient = gradient.norm();
    energy.hessian(hessian);
    const Eigen::LLT<Eigen::MatrixXd> factor(hessian);
    if (factor.info() != Eigen::Success) {
      found.status = SolveStatus::saddle;
      found.message = to_string(found.status);
      return;
    }
    // A gradient below 1e-8 is squared by the step that follows, so no evaluation has to prove it.
    found.coefficients -= factor.solve(gradient);
    if (found.gradient <= std::max(tolerance, 1e-8)) {
      found.status = SolveStatus::converged;
      found.message = to_string(found.status);
      return;
    }
    if (found.gradient > 0.5 * previous) break;
    previous = found.gradient;
  }
  found.status = SolveStatus::failed;
  found.message = "Newton's method did not reduce the gradient below rounding";
}

Found minimise(CantileverEnergy& energy, Eigen::VectorXd start, const EnergyOptions& options,
               double load) {
  Found found;
  const MinimiseResult result = minimise_lbfgs(
      [&energy](
          const Eigen::Ref<const Eigen::VectorXd>& x,
          Eigen::Ref<Eigen::VectorXd> gradient) {  // NOLINT(performance-unnecessary-value-param)
        return energy.value(x, gradient);
      },
      start, {handover_gradient * (1 + load), options.max_evaluations});
  found.evaluations = result.evaluations;
  found.coefficients = std::move(start);
  found.status = result.status;
  found.message = result.message;
  if (succeeded(result.status)) polish(energy, found, load);
  return found;
}

Found minimise_from_starts(CantileverEnergy& energy, const EnergyOptions& options, double load) {
  Found found;
  if (load < soft_load) {
    found = minimise(energy, Eigen::VectorXd::Zero(energy.size()), options, load);
    if (found.status != SolveStatus::saddle) return found;
  }
  // The soft start breaks the symmetry that kept the straight start on the saddle.
  const int spent = found.evaluations;
  found = minimise(energy, energy.soft_start(), options, load);
  found.evaluations += spent;
  return found;
}

}  // namespace

Equilibrium solve_energy(const Problem& problem, const EnergyOptions& options) {
  const auto begin = std::chrono::steady_clock::now();
  require(options.terms >= 0 && options.terms <= max_terms, "solve_energy", "terms", options.terms,
          "0 to " + std::to_string(max_terms));
  require_positive("solve_energy", "tolerance", options.tolerance);
  require(options.max_evaluations >= 1, "solve_energy", "max_evaluations", options.max_evaluations,
          ">= 1");
  const ReducedCantilever reduced = reduce_cantilever(problem);
  const double load = total_load(reduced.rod);

  int terms = options.terms > 0 ? options.terms : first_terms(load);
  auto energy = std::make_shared<CantileverEnergy>(reduced.rod, terms);
  Found found = minimise_from_starts(*energy, options, load);
  // The angle that the last coefficient a_K adds is a_K / (2K); positions feel it as little again.
  const auto resolved = [&] {
    return energy->tail(found.coefficients) <= options.tolerance * 4 * terms * terms;
  };
  while (options.terms == 0 && succeeded(found.status) && !resolved() && terms < max_terms) {
    const int more = std::min(max_terms, terms + std::max(4, terms / 2));
    const Eigen::VectorXd start = CantileverEnergy::refine(found.coefficients, terms, more);
    const int spent = found.evaluations;
    terms = more;
    energy = std::make_shared<CantileverEnergy>(reduced.rod, terms);
    found = minimise(*energy, start, options, load);
    found.evaluations += spent;
  }
  if (options.terms == 0 && succeeded(found.status) && !resolved()) {
    found.status = SolveStatus::failed;
    found.message = "the curvature is not resolved by " + std::to_string(terms) + " terms";
  }

  Equilibrium result;
  result.status = found.status;
  result.message = found.message;
  result.evaluations = found.evaluations;
  result.terms = terms;
  result.residual = found.gradient;
  result.energy = restore(problem, energy->energies(found.coefficients));
  const double clamp_curvature = energy->sample(found.coefficients, {0.0}).curvature[0];
  result.grips = {clamp_reaction(problem, reduced, clamp_curvature)};
  result.sample = [problem, reduced, energy,
                   coefficients = found.coefficients](std::span<const double> arc_lengths) {
    const std::vector<double> distances =
        distances_from_clamp(problem, reduced.reversed, arc_lengths);
    return restore(problem, reduced, arc_lengths, energy->sample(coefficients, distances));
  };
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return result;
}

}  // namespace dlo::energy_model
