#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>

#include "base/deadline.hpp"
#include "dlo/energy_model/status.hpp"

namespace dlo::energy_model {

/// Returns the value of an objective and writes the gradient into the second argument.
using Objective =
    std::function<double(const Eigen::Ref<const Eigen::VectorXd>&, Eigen::Ref<Eigen::VectorXd>)>;

struct MinimiseOptions {
  double gradient_tolerance = 0;  ///< Euclidean norm of the gradient at which the minimisation ends
  int max_evaluations = 0;        ///< <= 0: unlimited
  /// Steps that L-BFGS stores; 0: as many as unknowns, which needs fewer but slower steps. The
  /// memory limits them to 2^24 / unknowns, but not to fewer than eight.
  int stored_steps = 0;
  /// Checked at every evaluation; a minimisation that reaches it returns `time_limit`.
  Deadline deadline{};
};

struct [[nodiscard]] MinimiseResult {
  SolveStatus status = SolveStatus::not_run;
  std::string message = "never ran";
  int evaluations = 0;

  /// Whether Newton's method may start from the point, or a residual may prove it to be good
  /// enough. A failed line search may mean that rounding left no descent, or anything else.
  [[nodiscard]] bool is_usable_start() const {
    return succeeded(status) || status == SolveStatus::not_verified;
  }
};

/// Translates each result code of NLopt into a status and a message; an unknown code is a failure.
/// NLOPT_FORCED_STOP is a failure too: a caller that stopped NLopt has to replace this status.
/// NLOPT_FAILURE is `not_verified`.
[[nodiscard]] MinimiseResult translate_nlopt(int code);

/// Minimises with NLopt's LD_LBFGS from `x`, which is overwritten by the result. NLopt itself
/// cannot stop on the gradient, so the objective's wrapper stops it; `x` is then the point with
/// that gradient. An exception of the objective stops NLopt and is rethrown.
MinimiseResult minimise_lbfgs(const Objective& objective, Eigen::VectorXd& x,
                              const MinimiseOptions& options);

}  // namespace dlo::energy_model
