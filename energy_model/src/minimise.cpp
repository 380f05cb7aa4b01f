#include "minimise.hpp"

#include <nlopt.h>

#include <memory>

namespace dlo::energy_model {
namespace {

struct Call {
  const Objective* objective;
  nlopt_opt optimiser;
  double gradient_tolerance;
  Eigen::VectorXd gradient;
  Eigen::VectorXd best;  // x where the gradient was small enough
  bool small_gradient = false;
  int evaluations = 0;
};

double evaluate(unsigned n, const double* x, double* gradient, void* data) {
  auto& call = *static_cast<Call*>(data);
  ++call.evaluations;
  const Eigen::Map<const Eigen::VectorXd> point(x, n);
  const double value = (*call.objective)(point, call.gradient);
  if (gradient != nullptr) Eigen::Map<Eigen::VectorXd>(gradient, n) = call.gradient;
  if (call.gradient.norm() <= call.gradient_tolerance) {
    call.small_gradient = true;
    call.best = point;
    nlopt_force_stop(call.optimiser);
  }
  return value;
}

MinimiseResult translate(nlopt_result code) {
  switch (code) {
    case NLOPT_SUCCESS:
    case NLOPT_FTOL_REACHED:
    case NLOPT_XTOL_REACHED:
    case NLOPT_STOPVAL_REACHED:
    case NLOPT_ROUNDOFF_LIMITED:
      return {SolveStatus::roundoff_limited, "NLopt made no further progress"};
    case NLOPT_MAXEVAL_REACHED:
    case NLOPT_MAXTIME_REACHED:
      return {SolveStatus::evaluation_limit, "NLopt reached its evaluation limit"};
    case NLOPT_FORCED_STOP:
      return {SolveStatus::converged, "converged"};
    case NLOPT_OUT_OF_MEMORY:
      return {SolveStatus::failed, "NLopt ran out of memory"};
    case NLOPT_INVALID_ARGS:
      return {SolveStatus::failed, "NLopt refused its arguments"};
    default:
      // Its line search says so when rounding leaves it no descent; the point is kept.
      return {SolveStatus::roundoff_limited, "NLopt's line search failed"};
  }
}

}  // namespace

MinimiseResult minimise_lbfgs(const Objective& objective, Eigen::VectorXd& x,
                              const MinimiseOptions& options) {
  const auto n = static_cast<unsigned>(x.size());
  const std::unique_ptr<nlopt_opt_s, decltype(&nlopt_destroy)> optimiser(
      nlopt_create(NLOPT_LD_LBFGS, n), nlopt_destroy);
  Call call{&objective, optimiser.get(), options.gradient_tolerance, Eigen::VectorXd(x.size()),
            Eigen::VectorXd(x.size())};
  nlopt_set_min_objective(optimiser.get(), evaluate, &call);
  nlopt_set_maxeval(optimiser.get(), options.max_evaluations);
  nlopt_set_vector_storage(optimiser.get(), n);
  double minimum = 0;
  const nlopt_result code = nlopt_optimize(optimiser.get(), x.data(), &minimum);
  MinimiseResult result = translate(code);
  if (call.small_gradient) {
    x = call.best;
    result = {SolveStatus::converged, "converged"};
  }
  result.evaluations = call.evaluations;
  return result;
}

}  // namespace dlo::energy_model
