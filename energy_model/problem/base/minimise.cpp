#include "base/minimise.hpp"

#include <nlopt.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <memory>
#include <string>

namespace dlo::energy_model {
namespace {

struct NloptCall {
  const Objective* objective;
  nlopt_opt optimiser;
  const MinimiseOptions* options;
  Eigen::VectorXd gradient;
  Eigen::VectorXd best;  // x at which the gradient was small enough
  bool small_gradient = false;
  bool late = false;
  int evaluations = 0;
  std::exception_ptr thrown;  // exception thrown by the objective
};

/// Evaluates the objective for NLopt. Exceptions must not cross NLopt, which is C: an exception of
/// the objective is stored and stops NLopt.
double evaluate(unsigned n, const double* x, double* gradient, void* data) {
  auto& call = *static_cast<NloptCall*>(data);
  if (call.thrown) return NAN;
  try {
    ++call.evaluations;
    const Eigen::Map<const Eigen::VectorXd> point(x, n);
    const double value = (*call.objective)(point, call.gradient);
    if (gradient != nullptr) Eigen::Map<Eigen::VectorXd>(gradient, n) = call.gradient;
    if (call.gradient.norm() <= call.options->gradient_tolerance) {
      call.small_gradient = true;
      call.best = point;
      nlopt_force_stop(call.optimiser);
    } else if (call.options->deadline.passed()) {
      call.late = true;
      nlopt_force_stop(call.optimiser);
    }
    return value;
  } catch (...) {
    call.thrown = std::current_exception();
    nlopt_force_stop(call.optimiser);
    return NAN;
  }
}

/// Returns the number of steps that L-BFGS stores. NLopt stores two vectors of n numbers for each
/// step, in one block whose size is counted in an int.
unsigned stored_steps(const MinimiseOptions& options, unsigned n) {
  constexpr unsigned most_numbers = 1U << 24U;  // 128 MB in each of the two halves
  constexpr unsigned fewest_steps = 8;
  const unsigned wanted =
      options.stored_steps > 0 ? static_cast<unsigned>(options.stored_steps) : n;
  return std::min(wanted, std::max(fewest_steps, most_numbers / std::max(n, 1U)));
}

}  // namespace

MinimiseResult translate_nlopt(int code) {
  switch (code) {
    case NLOPT_SUCCESS:
    case NLOPT_FTOL_REACHED:
    case NLOPT_XTOL_REACHED:
    case NLOPT_STOPVAL_REACHED:
    case NLOPT_ROUNDOFF_LIMITED:
      return {SolveStatus::roundoff_limited, "NLopt made no further progress"};
    case NLOPT_MAXEVAL_REACHED:
      return {SolveStatus::evaluation_limit, "NLopt reached its evaluation limit"};
    case NLOPT_MAXTIME_REACHED:
      return {SolveStatus::time_limit, "NLopt reached its time limit"};
    case NLOPT_FORCED_STOP:
      return {SolveStatus::failed, "NLopt was stopped"};
    case NLOPT_FAILURE:
      // NLopt also returns this code if rounding leaves its line search no descent. A residual has
      // to prove that the point is good then.
      return {SolveStatus::not_verified, "NLopt's line search failed"};
    case NLOPT_INVALID_ARGS:
      return {SolveStatus::failed, "NLopt refused its arguments"};
    case NLOPT_OUT_OF_MEMORY:
      return {SolveStatus::failed, "NLopt ran out of memory"};
    default:
      return {SolveStatus::failed, "NLopt returned an unknown code, " + std::to_string(code)};
  }
}

MinimiseResult minimise_lbfgs(const Objective& objective, Eigen::VectorXd& x,
                              const MinimiseOptions& options) {
  const auto n = static_cast<unsigned>(x.size());
  const std::unique_ptr<nlopt_opt_s, decltype(&nlopt_destroy)> optimiser(
      nlopt_create(NLOPT_LD_LBFGS, n), nlopt_destroy);
  NloptCall call{.objective = &objective,
                 .optimiser = optimiser.get(),
                 .options = &options,
                 .gradient = Eigen::VectorXd(x.size()),
                 .best = Eigen::VectorXd(x.size()),
                 .thrown = nullptr};
  nlopt_set_min_objective(optimiser.get(), evaluate, &call);
  nlopt_set_maxeval(optimiser.get(), options.max_evaluations);
  nlopt_set_vector_storage(optimiser.get(), stored_steps(options, n));
  double minimum = 0;
  const nlopt_result code = nlopt_optimize(optimiser.get(), x.data(), &minimum);
  if (call.thrown) std::rethrow_exception(call.thrown);
  MinimiseResult result = translate_nlopt(code);
  if (call.small_gradient) {
    x = call.best;
    result = {SolveStatus::converged, "converged"};
  } else if (call.late) {
    result = {SolveStatus::time_limit, to_string(SolveStatus::time_limit)};
  }
  result.evaluations = call.evaluations;
  return result;
}

}  // namespace dlo::energy_model
