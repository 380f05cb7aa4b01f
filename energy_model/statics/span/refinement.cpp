#include "span/refinement.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <utility>

#include "base/legendre.hpp"
#include "certify/certify.hpp"
#include "certify/piece_cuts.hpp"
#include "span/local_solver.hpp"
#include "strain/second_derivatives.hpp"

namespace dlo::energy_model {
namespace {

/// Largest number of unknowns of a shape on an adapted mesh.
constexpr int most_adapted_unknowns = 2 * most_unknowns;

/// Error, divided by the length, above which a shape is certified again with more coefficients than
/// seem necessary.
constexpr double largest_unrefined_error = 1e-5;

/// Largest gradient, divided by 1 + load, that a shape may have in a model with more coefficients.
constexpr double largest_residual = 1e-5;

/// Largest constraint residual there, divided by the tolerance.
constexpr double largest_gap = 10;

/// Truncation indicator of a shape and its number of coefficients.
struct TruncationIndicator {
  int terms = 0;
  double size = 0;
};

class Refinement {
 public:
  explicit Refinement(LocalSolver& on)
      : on_(on), span_(on.span()), options_(on.options()), traits_(on.traits()) {}

  [[nodiscard]] SpanSolution run(SpanSolution solution) {
    const int unknowns = traits_.adapted ? most_adapted_unknowns : most_unknowns;
    const bool touches = !span_.contacts.empty();
    // Contacts divide the rod into short elements; it may still need the coefficients of its load.
    const int least = touches ? std::max(32, on_.terms()) : 32;
    const int affordable = std::min(
        std::max(least, unknowns / (SpanTraits::fields_of(span_) * solution.model->elements())),
        std::max(solution.terms, affordable_terms(solution.model->span())));
    // A shape that is not smooth between the ends of contact has passed through a body's middle.
    constexpr int most_between_contact_ends = 40;
    const int most_terms =
        std::min(affordable, span_.contact_ends.empty() ? max_terms : most_between_contact_ends);
    TruncationIndicator before;
    bool solved_again = false;
    while (solution.is_equilibrium()) {
      solution.resolved = options_.terms > 0 || resolved(solution);
      if (solution.resolved && solution.next_step > largest_stagnation_step && !solved_again) {
        on_.newton(solution);
        solved_again = true;
        continue;
      }
      if (solution.resolved) break;
      if (on_.out_of_time()) {
        solution.finish(SolveStatus::time_limit);
        break;
      }
      if (solution.terms >= most_terms) {
        if (std::optional<SpanSolution> adapted = on_adapted_mesh(solution))
          return std::move(*adapted);
        solution.fail("the curvature is not resolved by " + std::to_string(solution.terms) +
                      " terms");
        break;
      }
      const bool too_few = solution.terms < on_.terms() && !touches;
      int more = too_few ? on_.terms() : terms_by_decay(solution, before);
      // Grips may pull harder than weight and loads.
      if (solution.multipliers.size() > 0 && !traits_.taut && !traits_.adapted) {
        more = std::max(
            more, first_terms(solution.multipliers.cwiseAbs().maxCoeff(), traits_.longest_element));
      }
      if (before.terms == 0) more = std::max(more, terms_by_own_decay(solution));
      before = {solution.terms, solution.model->truncation(solution.x)};
      solution = with_terms(solution, std::min(most_terms, more));
    }
    return solution;
  }

 private:
  /// Continues on an adapted mesh if the affordable coefficients do not resolve a shape: its
  /// elements may end at the wrong places. Returns std::nullopt if the mesh cannot be adapted
  /// (adapted_mesh()) or if no equilibrium is found on the adapted one.
  [[nodiscard]] std::optional<SpanSolution> on_adapted_mesh(const SpanSolution& solution) {
    const std::optional<Span> span = adapted_mesh(on_, solution);
    if (!span) return std::nullopt;
    LocalSolver adapted(*span, options_, on_.workspace());
    SpanSolution finer = fit_to_elements(adapted, solution, adapted.terms());
    on_.newton(finer);
    finer = refine(adapted, std::move(finer));
    if (!finer.is_equilibrium()) return std::nullopt;
    return finer;
  }

  /// Predicts the number of coefficients with which the last ones of a first shape will be small
  /// enough, if they continue to decrease exponentially as in its second half, which slightly
  /// underestimates it. Returns the present number if they do not decrease.
  [[nodiscard]] int terms_by_own_decay(const SpanSolution& solution) const {
    constexpr double term_reserve_factor = 1.15;
    constexpr double required_decrease_ratio = 0.5;
    const int K = solution.terms;
    const int half = K / 2;
    const double before = solution.model->truncation(solution.x, half);
    const double now = solution.model->truncation(solution.x);
    if (options_.terms > 0 || half < 2 || !(now > 0 && now < required_decrease_ratio * before))
      return K;
    const double rate = std::log(before / now) / (K - half);
    double all = K;
    // The size that counts as small enough grows with the number of coefficients.
    for (int i = 0; i < 2; ++i) {
      all = K + std::log(now / allowed_truncation(options_.tolerance, all)) / rate;
      if (!(all > K)) return K;
    }
    return static_cast<int>(std::ceil(std::min(term_reserve_factor * all, 1.0 * max_terms)));
  }

  /// Predicts the number of coefficients with which the last ones will be small enough, if they
  /// continue to decrease exponentially as since `before`; a quarter more if that is unknown.
  [[nodiscard]] int terms_by_decay(const SpanSolution& solution,
                                   const TruncationIndicator& before) const {
    const int K = solution.terms;
    const double now = solution.model->truncation(solution.x);
    const double wanted = allowed_truncation(options_.tolerance, K);
    int more = std::max(2, K / 4);
    if (before.terms > 0 && now < before.size && now > wanted) {
      const double rate = std::log(before.size / now) / (K - before.terms);
      more = std::clamp(static_cast<int>(std::ceil(std::log(now / wanted) / rate)), 2, 2 * more);
    }
    return K + more;
  }

  [[nodiscard]] SpanSolution with_terms(const SpanSolution& solution, int terms) {
    SpanSolution finer = on_.workspace().with_terms(solution, terms);
    const Eigen::VectorXd x = finer.x;
    const Eigen::VectorXd multipliers = finer.multipliers;
    on_.newton(finer);
    const bool descends = finer.model->size() <= largest_descent_size;
    if (descends && (!finer.is_equilibrium() || finer.model->has_soft_obstacles()))
      on_.descend(finer);
    if (!finer.is_equilibrium() && !finer.model->has_soft_obstacles()) {
      finer.x = x;
      finer.multipliers = multipliers;
      on_.descend_to_constraints(finer);
    }
    finer.evaluations += solution.evaluations;
    return finer;
  }

  [[nodiscard]] bool resolved(const SpanSolution& solution) {
    if (span_.is_plain_cantilever() && solution.terms < on_.terms()) return false;
    if (span_.twist && solution.terms < terms_for_buckling_modes(solution)) return false;
    if (solution.model->truncation(solution.x) >
        allowed_truncation(options_.tolerance, solution.terms))
      return false;
    if (span_.is_plain_cantilever()) return true;
    return holds_with_more_terms(solution);
  }

  /// Whether gradient and constraint residuals of the shape remain small in a model with half as
  /// many coefficients more, with its quadrature: frames in space are integrated more accurately
  /// with more coefficients, and the residual is an estimate of the displacement.
  [[nodiscard]] bool holds_with_more_terms(const SpanSolution& solution) {
    const std::shared_ptr<SpanEnergy> model =
        on_.workspace().model(span_, std::min(max_terms, 3 * solution.terms / 2));
    SpanPoint point = model->evaluated(model->prolong(*solution.model, solution.x));
    point.gradient -= point.jacobian.transpose() *
                      model->prolong_multipliers(*solution.model, solution.multipliers);
    return point.gradient.norm() < largest_residual * (1 + traits_.load) &&
           point.residual.norm() < largest_gap * options_.tolerance;
  }

  LocalSolver& on_;
  const Span& span_;
  const SpanOptions& options_;
  const SpanTraits& traits_;
};

/// Largest number of coefficients in rounds before the ends are nearly accurate; each element is
/// short.
constexpr int first_round_terms = 16;

/// Movement of the ends, divided by the rod length, below which coefficients are added, and below
/// which the iteration ends.
constexpr double ends_nearly_converged = 1e-4;
constexpr double ends_converged = 1e-9;

/// Returns the largest movement of an end; infinity if the number of ends has changed.
double largest_movement(const std::vector<double>& before, const std::vector<double>& now) {
  if (before.size() != now.size()) return std::numeric_limits<double>::infinity();
  double moved = 0;
  for (std::size_t i = 0; i < now.size(); ++i) {
    moved = std::max(moved, std::abs(now[i] - before[i]));
  }
  return moved;
}

/// Solves for an equilibrium on soft obstacles with elements that end where contact begins or ends
/// (Span::contact_ends). The force per length has a kink there, which no series represents. The
/// ends of each round are those of the previous shape. Their error changes the shape by about its
/// square, so that a few rounds determine both.
SpanSolution refine_contact_ends(LocalSolver& on, SpanSolution solution) {
  Span span = on.span();
  std::vector<double> ends = contact_ends(solution);
  bool refined = false;
  for (int round = 0; round < most_contact_rounds && solution.is_equilibrium(); ++round) {
    if (on.out_of_time()) {
      solution.finish(SolveStatus::time_limit);
      return solution;
    }
    const bool same_pieces = ends == span.contact_ends;
    span.contact_ends = ends;
    LocalSolver own(span, on.options(), on.workspace());
    if (!same_pieces) {
      const int terms = refined ? solution.terms : std::min(solution.terms, first_round_terms);
      solution = fit_to_elements(own, solution, on.options().terms > 0 ? solution.terms : terms);
      own.newton(solution);
      if (!solution.is_equilibrium()) own.descend(solution);
    }
    if (refined || same_pieces) solution = Refinement(own).run(std::move(solution));
    if (!solution.is_equilibrium()) return solution;
    std::vector<double> now = contact_ends(solution);
    const double moved = largest_movement(ends, now);
    if ((refined || same_pieces) && moved <= ends_converged) return solution;
    refined = refined || moved <= ends_nearly_converged;
    ends = std::move(now);
  }
  if (solution.is_equilibrium()) {
    solution.resolved = false;
    solution.fail("the ends of contact with soft obstacles were not found");
  }
  return solution;
}

}  // namespace

SpanSolution refine(LocalSolver& on, SpanSolution solution) {
  return on.span().soft_obstacles.empty() ? Refinement(on).run(std::move(solution))
                                          : refine_contact_ends(on, std::move(solution));
}

std::optional<Span> adapted_mesh(const LocalSolver& on, const SpanSolution& shape) {
  const Span& span = on.span();
  const bool touches =
      !span.rigid_obstacles.empty() || !span.contacts.empty() || shape.model->has_soft_obstacles();
  if (on.traits().adapted || touches || span.has_material_directors() || on.options().terms > 0) {
    return std::nullopt;
  }
  Span result = shape.model->span();
  result.cuts = element_cuts(shape);
  if (result.cuts.empty()) return std::nullopt;
  return result;
}

SpanSolution certified_solution(SpanSolution solution, const SpanOptions& options,
                                SpanWorkspace& workspace) {
  const int spent = solution.evaluations;
  certify(solution, workspace.newton());
  solution.evaluations = spent;
  const bool asks = solution.status == SolveStatus::near_singular ||
                    (is_result(solution, options) && solution.error > largest_unrefined_error);
  const int more = std::min(max_terms, 3 * solution.terms / 2);
  if (!asks || options.terms > 0 || options.deadline.passed() ||
      more * SpanTraits::fields_of(solution.model->span()) * solution.model->elements() >
          most_unknowns) {
    return solution;
  }
  // The shape may have left the plane, or have elements of its own.
  const Span own = solution.model->span();
  LocalSolver on(own, options, workspace);
  SpanSolution finer = workspace.with_terms(solution, more);
  on.newton(finer);
  // For a singular point that Newton's method has reported, it was not checked whether the
  // coefficients resolve it.
  if (!solution.resolved) finer = refine(on, std::move(finer));
  finer.resolved = finer.resolved || solution.resolved;
  certify(finer, workspace.newton());
  const int evaluations = solution.evaluations + finer.evaluations;
  // More coefficients may determine a shape that has a zero mode, along which rounding moves it.
  const bool determined = finer.is_equilibrium() && !solution.is_equilibrium();
  if (determined || finer.error < solution.error) solution = std::move(finer);
  solution.evaluations = evaluations;
  return solution;
}

SpanSolution finish(SpanSolution solution, const SpanOptions& options, SpanWorkspace& workspace) {
  const Span own = solution.model->span();
  LocalSolver on(own, options, workspace);
  return certified_solution(refine(on, std::move(solution)), options, workspace);
}

SpanSolution fit_to_elements(LocalSolver& on, const SpanSolution& solution, int terms) {
  SpanSolution other = on.empty_solution(terms);
  const TangentField field = solution.model->field(solution.x);
  other.x = other.model->fit(field(other.model->nodes()));
  if (other.model->constraints() == solution.multipliers.size()) {
    other.multipliers = solution.multipliers;
  }
  other.evaluations = solution.evaluations;
  return other;
}

}  // namespace dlo::energy_model
