#pragma once

#include "span/span_options.hpp"
#include "span/span_traits.hpp"
#include "span/span_workspace.hpp"
#include "span/start_ranking.hpp"
#include "strain/span_energy.hpp"
#include "strain/span_solution.hpp"

namespace dlo::energy_model {

/// Gradient norm at which a descent hands over: two Newton steps square it to below rounding, while
/// a line search, which compares energies, would stall near the root of the rounding error.
inline constexpr double handover_gradient = 1e-5;

/// Its step [rad] below which Newton's method goes on alone.
inline constexpr double handover_step = 0.1;

/// Coefficients up to which a coarser start is not worth its set-up.
inline constexpr int few_terms = 10;

/// A step of the trust region works with the cube of the unknowns.
inline constexpr Eigen::Index most_descended = 160;

/// From starts to equilibria of a span, with few terms or all that its load takes.
class LocalSolver {
 public:
  /// All of them have to outlive it.
  LocalSolver(const Span& span, const SpanOptions& options, SpanWorkspace& workspace);

  [[nodiscard]] const Span& span() const { return span_; }
  [[nodiscard]] const SpanOptions& options() const { return options_; }
  [[nodiscard]] SpanWorkspace& workspace() const { return workspace_; }
  [[nodiscard]] const SpanTraits& traits() const { return traits_; }
  [[nodiscard]] bool out_of_time() const { return options_.deadline.passed(); }

  /// That the load takes, or the caller wants.
  [[nodiscard]] int terms() const;
  /// NLopt comes near with few terms; Newton's method adds the others.
  [[nodiscard]] int coarse_terms() const;
  /// With a model but no unknowns yet.
  [[nodiscard]] SpanSolution empty_solution(int terms) const {
    return workspace_.empty_solution(span_, terms);
  }

  /// Newton's method with the span's load, to the search's deadline.
  void newton(SpanSolution& solution, NewtonOptions how = {}) const;
  /// From a field to an equilibrium, with as many terms as it takes to meet the grips.
  [[nodiscard]] SpanSolution from_start(const Start& from);
  /// By Newton's method from next to a field.
  [[nodiscard]] SpanSolution newton_from(const TangentField& field);
  /// Downhill from solution.x, by NLopt or between grips in a trust region, then Newton's method.
  void descend(SpanSolution& solution);
  /// By springs at the grips that become stiffer, then Newton's method.
  void by_augmented_lagrangian(SpanSolution& solution);

 private:
  [[nodiscard]] bool reaches_minimum_by_newton(SpanSolution& solution);
  [[nodiscard]] bool prolong_known(const StartShape& wanted, SpanSolution& solution) const;
  void minimise(SpanSolution& solution) const;

  const Span& span_;
  const SpanOptions& options_;
  SpanWorkspace& workspace_;
  SpanTraits traits_;
};

}  // namespace dlo::energy_model
