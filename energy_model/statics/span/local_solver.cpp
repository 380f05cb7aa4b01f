#include "span/local_solver.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "base/legendre.hpp"
#include "base/minimise.hpp"
#include "certify/piece_cuts.hpp"
#include "frames/piece.hpp"
#include "newton/trust_region.hpp"
#include "problem/segments.hpp"
#include "span/span_options.hpp"

namespace dlo::energy_model {
namespace {

/// Returns the longest interval between the ends and the loads of a span.
double longest_without_load(const Span& span) {
  double longest = 0;
  double begin = 0;
  for (const Span::Load& load : span.loads) {
    longest = std::max(longest, load.at - begin);
    begin = load.at;
  }
  return std::max(longest, span.length - begin);
}

/// Returns an upper bound of the curvature by couples.
double curvature_bound_of_couples(const Span& span) {
  double couples = 0;
  for (const Span::Load& load : span.loads) couples += std::abs(load.couple);
  double softest = span.stiffness.head<2>().minCoeff();
  for (const Span::Part& part : span.parts) {
    softest = std::min(softest, part.stiffness.head<2>().minCoeff());
  }
  return couples / softest;
}

int unknowns_per_term(const Span& span) {
  return SpanTraits::fields_of(span) * static_cast<int>(elements_of(span).size());
}

/// Smallest number of coefficients of a coarse solution.
constexpr int least_terms = 7;

/// Number of unknowns with which a minimum between grips is searched for.
constexpr int coarse_unknowns = 100;

/// Number of coefficients that resolve a boundary layer over six of its lengths.
constexpr int layer_terms = 20;

}  // namespace

SpanTraits::SpanTraits(const Span& span) : load(span.total_load()), adapted(!span.cuts.empty()) {
  for (const Segment& segment : segments_of(span)) {
    if (!segment.taut()) continue;
    taut = true;
    stiffness = std::max(stiffness, segment.tension / std::max(1e-12, segment.slack()));
  }
  // If contact begins inside an element, it needs more coefficients than its length suggests.
  if (!span.soft_obstacles.empty() && span.contact_ends.empty()) {
    longest_element = span.length;
    return;
  }
  if (span.is_plain_cantilever()) {
    longest_element = longest_without_load(span);
    return;
  }
  longest_element = energy_model::longest_element(elements_of(span));
  if (!span.has_material_directors() && !span.has_couples()) return;
  // The rotation of the stress-free shape, and the one by couples, have to be resolved as well.
  const double curvature = span.natural.largest() + curvature_bound_of_couples(span);
  natural_terms = first_terms(curvature * curvature, longest_element);
}

int affordable_terms(const Span& span) {
  return std::max(1, most_model_unknowns / unknowns_per_term(span));
}

void require_affordable(const Span& span, int terms, std::string_view function) {
  const int least = terms > 0 ? terms : least_model_terms;
  if (least <= affordable_terms(span)) return;
  const std::size_t elements = elements_of(span).size();
  std::ostringstream message;
  message << function << ": " << span.loads.size() << " loads, " << span.holds.size()
          << " grips and " << span.parts.size() << " sections of a span divide it into " << elements
          << " elements, must be at most "
          << most_model_unknowns / (least * SpanTraits::fields_of(span)) << " of " << least
          << (terms > 0 ? "" : " or more") << " terms";
  throw std::invalid_argument(message.str());
}

LocalSolver::LocalSolver(const Span& span, const SpanOptions& options, SpanWorkspace& workspace)
    : span_(span), options_(options), workspace_(workspace), traits_(span) {}

int LocalSolver::terms() const {
  if (options_.terms > 0) return options_.terms;
  const int layers = traits_.taut || traits_.adapted ? layer_terms : 0;
  const int first = traits_.adapted ? 0 : first_terms(traits_.load, traits_.longest_element);
  const int wanted = std::max({first, options_.start.known.terms(), layers, traits_.natural_terms});
  return std::min(wanted, std::max(least_terms, affordable_terms(span_)));
}

int LocalSolver::coarse_terms() const {
  if (options_.terms > 0 || terms() <= few_terms) return terms();
  int coarse = terms() / 2;
  if (!span_.holds.empty()) coarse = std::min(coarse, coarse_unknowns / unknowns_per_term(span_));
  return std::max(least_terms, coarse);
}

void LocalSolver::newton(SpanSolution& solution, NewtonOptions how) const {
  how.deadline = options_.deadline;
  newton_solve(solution, how, workspace_.newton());
}

SpanSolution LocalSolver::from_start(const Start& from) {
  SpanSolution solution;
  int spent = 0;
  for (int count = coarse_terms();; count *= 2) {
    solution = empty_solution(std::min(count, max_terms));
    solution.x = from.model ? solution.model->prolong(*from.model, from.x)
                            : solution.model->fit(from.field(solution.model->nodes()));
    const Eigen::VectorXd start = solution.x;
    // For a taut rod such a start is already close to the shape.
    const bool is_near = traits_.taut && !solution.model->has_soft_obstacles();
    if (is_near) newton(solution);
    if (!is_near || (!solution.is_equilibrium() && !out_of_time())) {
      solution.x = start;
      solution.multipliers.resize(0);
      descend(solution);
    }
    if (solution.model->constraints() > 0 && !solution.is_equilibrium() &&
        !solution.model->has_soft_obstacles()) {
      solution.x = start;
      solution.multipliers.resize(0);
      descend_to_constraints(solution);
    }
    spent += solution.evaluations;
    solution.evaluations = spent;
    const bool plain = solution.model->constraints() == 0 && !solution.model->has_soft_obstacles();
    if (solution.is_equilibrium() || plain) return solution;
    const bool more = 2 * solution.model->size() <= largest_descent_size && options_.terms == 0;
    if (!more || out_of_time()) return solution;
  }
}

void LocalSolver::descend_to_constraints(SpanSolution& solution) const {
  descend_by_augmented_lagrangian(solution,
                                  {.deadline = options_.deadline, .stiffness = traits_.stiffness});
  if (succeeded(solution.status)) newton(solution);
}

SpanSolution LocalSolver::newton_from(const TangentField& field) {
  SpanSolution solution = empty_solution(terms());
  const StartShape wanted = field(solution.model->nodes());
  const KnownShape& known = options_.start.known;
  if (!prolong_known(wanted, solution)) {
    solution.x = solution.model->fit(wanted);
    newton(solution);
    return solution;
  }
  if (known.factor) {
    solution.multipliers = solution.model->prolong_multipliers(*known.model, known.multipliers);
  }
  newton(solution, {.first_factor = known.factor});
  return solution;
}

/// Prolongs the known shape's unknowns to this model: for an intrinsically straight rod in space
/// these are nearly the same if its grips have hardly moved, unless its start frame has rotated
/// about the tangent. @return whether the result has nearly the wanted tangents; false if the known
/// shape's model does not correspond to this one
bool LocalSolver::prolong_known(const StartShape& wanted, SpanSolution& solution) const {
  constexpr double near_tangent_tolerance = 0.2;  // largest difference of tangents
  const KnownShape& known = options_.start.known;
  SpanEnergy& model = *solution.model;
  if (!known.model || span_.planar || span_.has_material_directors()) return false;
  if (known.model->span().planar || known.model->elements() != model.elements()) return false;
  if (known.model->span().cuts != span_.cuts) return false;
  solution.x = model.prolong(*known.model, known.x);
  solution.point = workspace_.newton().new_point(model);
  solution.evaluate(solution.x, *solution.point);
  return (solution.point->tangents() - wanted.tangents).cwiseAbs().maxCoeff() <
         near_tangent_tolerance;
}

void LocalSolver::descend(SpanSolution& solution) {
  minimise(solution);
  if (!succeeded(solution.status)) return;
  const bool gets_more = solution.terms < terms();
  // For a cantilever, Newton's method follows once it has all its coefficients.
  if (gets_more && span_.is_plain_cantilever()) return;
  const bool is_rough = gets_more && !options_.wants_all() && options_.terms == 0 &&
                        solution.model->constraints() > 0;
  newton(solution, {.step_tolerance = is_rough ? loose_step_tolerance : default_step_tolerance});
}

void LocalSolver::minimise(SpanSolution& solution) const {
  SpanEnergy& model = *solution.model;
  if (model.constraints() > 0) {
    descend_in_trust_region(solution, {.nearest = handover_step, .deadline = options_.deadline});
    return;
  }
  SpanPoint point;
  const Objective objective = [&](const Eigen::Ref<const Eigen::VectorXd>& x,
                                  Eigen::Ref<Eigen::VectorXd> gradient) {
    model.evaluate(x, point);
    gradient = point.gradient;
    return point.energy;
  };
  const MinimiseResult result =
      minimise_lbfgs(objective, solution.x,
                     {.gradient_tolerance = handover_gradient * (1 + traits_.load),
                      .max_evaluations = options_.max_evaluations,
                      .deadline = options_.deadline});
  solution.evaluations += result.evaluations;
  // Newton's method has to verify the shape anyway.
  solution.status = result.is_usable_start() ? SolveStatus::roundoff_limited : result.status;
  solution.message = result.message;
}

std::shared_ptr<SpanEnergy> SpanWorkspace::model(const Span& span, int terms) {
  std::shared_ptr<SpanEnergy> model =
      models_.take([terms](const SpanEnergy& kept) { return kept.terms() == terms; });
  model->reset(span, terms);
  return model;
}

SpanSolution SpanWorkspace::empty_solution(const Span& span, int terms) {
  SpanSolution solution;
  solution.model = model(span, terms);
  solution.terms = terms;
  return solution;
}

SpanSolution SpanWorkspace::with_terms(const SpanSolution& solution, int terms) {
  SpanSolution other = empty_solution(solution.model->span(), terms);
  other.x = other.model->prolong(*solution.model, solution.x);
  other.multipliers = other.model->prolong_multipliers(*solution.model, solution.multipliers);
  return other;
}

}  // namespace dlo::energy_model
