#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>

#include "base/deadline.hpp"
#include "dlo/energy_model/status.hpp"

namespace dlo::energy_model {

/// Value of an objective; writes the gradient into its second argument.
using Objective =
    std::function<double(const Eigen::Ref<const Eigen::VectorXd>&, Eigen::Ref<Eigen::VectorXd>)>;

struct MinimiseOptions {
  double gradient_tolerance = 0;  ///< stop at a Euclidean gradient norm below this
  int max_evaluations = 0;
  /// Steps that L-BFGS remembers; 0: as many as unknowns, which takes fewer but longer ones.
  int remembered_steps = 0;
  Deadline deadline{};  ///< asked at every evaluation; the result is then `time_limit`
};

struct [[nodiscard]] MinimiseResult {
  SolveStatus status = SolveStatus::not_run;
  std::string message = "never ran";
  int evaluations = 0;

  /// A point that Newton's method may start from, or that a residual may prove to be good enough:
  /// a failed line search may mean that rounding left no descent, or anything else.
  [[nodiscard]] bool is_a_start() const {
    return succeeded(status) || status == SolveStatus::not_verified;
  }
};

/// Every result code of NLopt by name; one that is unknown is a failure. NLOPT_FORCED_STOP is a
/// failure too unless the caller has stopped it: who has, knows. NLOPT_FAILURE is `not_verified`.
[[nodiscard]] MinimiseResult translate_nlopt(int code);

/// NLopt's LD_LBFGS from and into `x`. NLopt itself cannot stop on the gradient, so the objective's
/// wrapper stops it; the point with that gradient is what `x` then holds. What the objective throws
/// stops NLopt and is thrown again from here.
MinimiseResult minimise_lbfgs(const Objective& objective, Eigen::VectorXd& x,
                              const MinimiseOptions& options);

}  // namespace dlo::energy_model
