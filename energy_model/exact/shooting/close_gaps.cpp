#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <Eigen/SparseQR>
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "dlo/energy_model/status.hpp"
#include "shooting/shooting_system.hpp"

namespace dlo::energy_model {
namespace {

constexpr double smallest_newton_share = 1e-3;  // smallest accepted share of a Newton step
// Size of a step after which the next Newton step is of the size of rounding.
constexpr double last_newton_step = 1e-9;
// Size of the gaps of a twisted rod below which steps along nearly zero modes are suppressed.
constexpr double near_convergence_gap = 0.1;
// Smallest weight of Levenberg's method; its square root is far above rounding.
constexpr double least_weight = 1e-12;

/// Largest number of unknowns for a Levenberg step. Each of its rows for the weight stays in all
/// later columns of the factors, which take 6 bytes times the square of this number, and one second
/// to compute.
constexpr Eigen::Index largest_levenberg_size = 4000;

using Solver = Eigen::SparseQR<Eigen::SparseMatrix<double>, Eigen::NaturalOrdering<int>>;

Eigen::SparseMatrix<double> matrix_of(const Triplets& triplets, Eigen::Index rows,
                                      Eigen::Index columns) {
  Eigen::SparseMatrix<double> matrix(rows, columns);
  matrix.setFromTriplets(triplets.begin(), triplets.end());
  return matrix;
}

/// Takes the largest share of Newton's step, halved repeatedly from the allowed one, for which the
/// next simplified step is shorter.
/// @return largest component of the step; std::nullopt if no share suffices or it does not close
/// the gaps
std::optional<double> newton_step(const ShootingSystem& system, const Triplets& derivatives,
                                  const Eigen::VectorXd& equations, ShootingPoint& point,
                                  int& integrations) {
  Solver solver(matrix_of(derivatives, system.equations(), system.unknowns()));
  if (solver.info() != Eigen::Success) return std::nullopt;
  const Eigen::VectorXd step = -solver.solve(equations);
  const double largest = step.lpNorm<Eigen::Infinity>();
  Eigen::VectorXd trial_equations;
  if (largest < last_newton_step) {
    point = system.moved(point, step);
    ++integrations;
    const bool closed = system.evaluate(point, trial_equations, nullptr) &&
                        trial_equations.norm() < system.closed_gap_tolerance();
    return closed ? std::optional(largest) : std::nullopt;
  }
  for (double part = system.allowed_step_share(point, step);
       part > smallest_newton_share && !system.out_of_time(); part /= 2) {
    const ShootingPoint trial = system.moved(point, part * step);
    ++integrations;
    if (!system.evaluate(trial, trial_equations, nullptr)) continue;
    const Eigen::VectorXd next = solver.solve(trial_equations);
    if (next.norm() > (1 - part / 4) * step.norm()) continue;
    point = trial;
    return part * largest;
  }
  return std::nullopt;
}

/// Returns the step that minimises |derivatives step + equations|^2 + weight |step|^2; std::nullopt
/// if there are too many unknowns or the factorisation fails.
std::optional<Eigen::VectorXd> regular_step(Triplets derivatives, Eigen::Index unknowns,
                                            const Eigen::VectorXd& equations, double weight) {
  if (unknowns > largest_levenberg_size) return std::nullopt;
  const Eigen::Index rows = equations.size();
  for (Eigen::Index i = 0; i < unknowns; ++i) {
    derivatives.emplace_back(static_cast<int>(rows + i), static_cast<int>(i), std::sqrt(weight));
  }
  const Solver solver(matrix_of(derivatives, rows + unknowns, unknowns));
  if (solver.info() != Eigen::Success) return std::nullopt;
  Eigen::VectorXd right = Eigen::VectorXd::Zero(rows + unknowns);
  right.head(rows) = -equations;
  return Eigen::VectorXd(solver.solve(right));
}

/// Weights of the Levenberg steps that are tried, and the share of the gaps that a step may leave.
struct LevenbergWeights {
  double first, last, growth;
  double left;
};

/// Takes the first Levenberg step that reduces the gaps. It does not move along zero modes, for
/// which Newton's step is undefined.
/// @return largest component of the step; std::nullopt if no weight suffices
std::optional<double> levenberg_step(const ShootingSystem& system, const Triplets& derivatives,
                                     const Eigen::VectorXd& equations,
                                     const LevenbergWeights& tried, ShootingPoint& point,
                                     int& integrations) {
  Eigen::VectorXd trial_equations;
  for (double weight = tried.first; weight <= tried.last && !system.out_of_time();
       weight *= tried.growth) {
    const std::optional<Eigen::VectorXd> step =
        regular_step(derivatives, system.unknowns(), equations, weight);
    if (!step) return std::nullopt;
    const ShootingPoint trial = system.moved(point, *step);
    const double largest = step->lpNorm<Eigen::Infinity>();
    const double allowed =
        largest < last_newton_step ? system.closed_gap_tolerance() : tried.left * equations.norm();
    ++integrations;
    if (system.allowed_step_share(point, *step) < 1 ||
        !system.evaluate(trial, trial_equations, nullptr) || trial_equations.norm() > allowed) {
      continue;
    }
    point = trial;
    return largest;
  }
  return std::nullopt;
}

}  // namespace

ShootingResult solve_shooting(const ShootingSystem& system, ShootingPoint& point,
                              int max_iterations, Modes modes) {
  ShootingResult result;
  Eigen::VectorXd equations;
  for (int iteration = 0; iteration < max_iterations && !result.converged; ++iteration) {
    if (system.out_of_time()) {
      result.message = to_string(SolveStatus::time_limit);
      break;
    }
    Triplets derivatives;
    ++result.integrations;
    if (!system.evaluate(point, equations, &derivatives)) {
      result.message = "the integrator failed";
      break;
    }
    std::optional<double> step;
    const double gaps = equations.norm();
    if (modes == Modes::nearly_zero && gaps < near_convergence_gap) {
      // Newton's steps would drift: a buckle far from both clamps slides along the rod and rotates
      // about its line, both with nearly zero modes. Levenberg steps with such weights converge as
      // fast as Newton's in all other directions (Yamashita and Fukushima 2001).
      const double first = std::max(gaps * gaps, least_weight);
      step = levenberg_step(system, derivatives, equations,
                            {first, std::max(gaps, least_weight), 30, 0.5}, point,
                            result.integrations);
    }
    if (!step) step = newton_step(system, derivatives, equations, point, result.integrations);
    if (!step) {
      step = levenberg_step(system, derivatives, equations, {gaps, 1e6, 8, 1}, point,
                            result.integrations);
    }
    if (!step) {
      result.message = "Newton's method found no step that reduces the gaps";
      if (system.unknowns() > largest_levenberg_size) {
        result.message +=
            "; " + std::to_string(system.unknowns()) +
            " unknowns are too many for the Levenberg-Marquardt method (allowed: at most " +
            std::to_string(largest_levenberg_size) + ")";
      }
      break;
    }
    result.converged = *step < last_newton_step;
  }
  return result;
}

}  // namespace dlo::energy_model
