#pragma once

#include <Eigen/Core>
#include <memory>
#include <string_view>

#include "problem/span.hpp"
#include "span/span_options.hpp"
#include "strain/span_energy.hpp"
#include "strain/span_solution.hpp"

namespace dlo::energy_model {

/// Properties of a span that determine how its equilibria are searched for.
struct SpanTraits {
  explicit SpanTraits(const Span& span);

  /// Number of strains that are unknowns.
  [[nodiscard]] static int fields_of(const Span& span) {
    return span.planar ? 1 : span.has_material_directors() ? 3 : 2;
  }

  double load;   ///< weight and loads [EI/l^2]
  bool adapted;  ///< whether the mesh is adapted to a known shape
  double longest_element = 0;
  int natural_terms = 0;  ///< number of coefficients needed for natural strains and couples
  bool taut = false;      ///< whether a segment between grips is taut
  double stiffness = 0;   ///< largest stiffness of a taut segment along its chord [EI/l^3]
};

/// Largest number of unknowns of a span's model before its shape is refined: its dense matrices
/// then occupy about half a gigabyte, and a step of Newton's method takes about a second.
inline constexpr int most_model_unknowns = 2400;

/// Number of coefficients of an element, per strain, that has to be affordable if the caller
/// chooses none.
inline constexpr int least_model_terms = 9;

/// Returns the largest affordable number of coefficients per strain and element, at least one.
[[nodiscard]] int affordable_terms(const Span& span);

/// Checks the size of a span's model. Elements end at loads, grips and section changes, and each
/// has unknowns of its own.
/// @param terms  number of coefficients that each element is to have; 0: the fewest
/// @throws std::invalid_argument if the model would have more unknowns than affordable
void require_affordable(const Span& span, int terms, std::string_view function);

/// Length of Newton's step [rad] below which Newton's method takes over.
inline constexpr double handover_step = 0.1;

/// Number of coefficients up to which a coarser initial solution does not save time.
inline constexpr int few_terms = 10;

/// Largest number of unknowns of a trust-region descent; a step costs its cube.
inline constexpr Eigen::Index largest_descent_size = 160;

/// An initial guess and, if starts were ranked, its unknowns in the model of the ranking.
struct Start {
  TangentField field;
  std::shared_ptr<const SpanEnergy> model;
  Eigen::VectorXd x;
  /// Cost: energy plus that of springs at the grips, or energy alone once the constraints are
  /// satisfied.
  double cost = 0;
};

/// Converges from initial guesses to equilibria of a span, with few coefficients or all that its
/// load needs.
class LocalSolver {
 public:
  /// All arguments have to outlive the object.
  LocalSolver(const Span& span, const SpanOptions& options, SpanWorkspace& workspace);

  [[nodiscard]] const Span& span() const { return span_; }
  [[nodiscard]] const SpanOptions& options() const { return options_; }
  [[nodiscard]] SpanWorkspace& workspace() const { return workspace_; }
  [[nodiscard]] const SpanTraits& traits() const { return traits_; }
  [[nodiscard]] bool out_of_time() const { return options_.deadline.passed(); }

  /// Returns the number of coefficients that the load needs, as far as it is affordable, or that
  /// the caller has chosen.
  [[nodiscard]] int terms() const;
  /// Returns the number of coefficients for a descent; Newton's method follows with all of them.
  [[nodiscard]] int coarse_terms() const;
  [[nodiscard]] SpanSolution empty_solution(int terms) const {
    return workspace_.empty_solution(span_, terms);
  }

  /// Runs Newton's method with the search's deadline instead of `how.deadline`.
  void newton(SpanSolution& solution, NewtonOptions how = {}) const;
  /// Solves from an initial guess, with as many coefficients as are needed to satisfy the
  /// constraints.
  [[nodiscard]] SpanSolution from_start(const Start& from);
  /// Solves by Newton's method from an initial guess near an equilibrium.
  [[nodiscard]] SpanSolution newton_from(const TangentField& field);
  /// Descends from solution.x by NLopt or, between grips, in a trust region. If the descent
  /// succeeds, Newton's method follows, for a plain cantilever only if solution already has all of
  /// its coefficients.
  void descend(SpanSolution& solution);
  /// Descends from solution.x by the method of multipliers, also from a shape from which the
  /// constraints cannot be restored; if that succeeds, Newton's method follows.
  void descend_to_constraints(SpanSolution& solution) const;

 private:
  [[nodiscard]] bool prolong_known(const StartShape& wanted, SpanSolution& solution) const;
  void minimise(SpanSolution& solution) const;

  const Span& span_;
  const SpanOptions& options_;
  SpanWorkspace& workspace_;
  SpanTraits traits_;
};

}  // namespace dlo::energy_model
