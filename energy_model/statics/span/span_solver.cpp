#include "span/span_solver.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "base/legendre.hpp"
#include "certify/certify.hpp"
#include "newton/trust_region.hpp"
#include "span/found.hpp"
#include "span/local_solver.hpp"
#include "span/nearby_equilibria.hpp"
#include "span/refinement.hpp"
#include "span/span_starts.hpp"

namespace dlo::energy_model {
namespace {

/// Sum of weight and loads [EI/l^2] above which a rod is closer to its soft limit than to the
/// straight rod.
constexpr double soft_limit_load = 12;

/// Whether all tangents of a plain cantilever that is pulled in one direction lie between the
/// clamp's direction and the load's, on the shorter way. An equilibrium with this property is the
/// lowest one. With the angle chi from the load's opposite and the force n(s) of everything beyond
/// s,
///     chi'' = -n sin(chi),  chi(0) given,  chi'(length) = 0,
/// the energy's minimum has chi in [0, pi], as reflecting values outside does not raise the energy.
/// There is only one such solution, because sin(chi) / chi decreases (Brezis and Oswald, 1986). A
/// second one, chi = 0, exists only if the clamp points against the load; it is unstable unless it
/// is the only one.
bool rotates_towards_load(const Span& span, const Eigen::Matrix3Xd& tangents) {
  constexpr double rounding = 1e-9;  // sine of the angle error by truncation
  Eigen::Vector3d force = span.weight_between(0, span.length);
  for (const Span::Load& load : span.loads) force += load.force;
  const Eigen::Vector3d across(-force.y(), force.x(), 0);
  const double side = std::copysign(1.0, across.dot(*span.start_direction));
  for (Eigen::Index q = 0; q < tangents.cols(); ++q) {
    if (side * across.dot(tangents.col(q)) < -rounding * force.norm()) return false;
  }
  return true;
}

/// Bends the straight rod in proportion to the load's gradient if that lowers its energy; otherwise
/// leaves it straight.
void bend_slightly(SpanSolution& solution, NewtonBuffers& buffers) {
  const SpanEnergy& model = *solution.model;
  const std::shared_ptr<SpanPoint> straight = buffers.new_point(model);
  const std::shared_ptr<SpanPoint> bent = buffers.new_point(model);
  solution.evaluate(Eigen::VectorXd::Zero(model.size()), *straight);
  solution.evaluate(-straight->gradient, *bent);
  solution.point = bent->energy < straight->energy ? bent : straight;
  solution.x = solution.point->x;
}

/// Number of initial guesses, in the order of their energy, that the search for the lowest minimum
/// follows.
constexpr std::size_t followed_starts = 2;
/// Number of followed initial guesses if the lowest shape is harder to predict: that of a rod with
/// material directors, and that of a rod that may pass a soft obstacle on either side.
constexpr std::size_t more_followed_starts = 6;

constexpr const char* saddle_descent_strategy = "unstable equilibria, followed downhill";
constexpr const char* out_of_plane = "the same starts and others, out of the plane";

/// Describes start_fields() and natural_fields() in words.
std::string starts_of(const Span& span) {
  const std::string plain = span.holds.empty() && span.start_direction
                                ? "shapes of a soft rod below its clamp"
                                : "arches, S-shapes and loops between grips";
  return span.has_material_directors() ? "the stress-free shape, " + plain : plain;
}

/// Solves for the lowest shape of a plain cantilever that is pulled in one direction; it is not
/// certified out of the plane. Newton's method is tried first. If it fails or converges to another
/// shape, a descent follows from the soft limit.
SpanSolution plain_cantilever(LocalSolver& on) {
  SpanSolution at_once = on.empty_solution(on.terms());
  if (on.traits().load < soft_limit_load) {
    bend_slightly(at_once, on.workspace().newton());
  } else {
    at_once.x = at_once.model->fit(soft_limit_field(on.span())(at_once.model->nodes()));
  }
  on.newton(at_once);
  at_once = refine(on, std::move(at_once));
  if (succeeded(at_once.status) && at_once.evaluations <= on.options().max_evaluations &&
      rotates_towards_load(on.span(), at_once.at_x()->tangents())) {
    return at_once;
  }
  SpanSolution solution = refine(on, on.from_start(Start{soft_limit_field(on.span())}));
  solution.evaluations += at_once.evaluations;
  return solution;
}

class Search {
 public:
  Search(const Span& span, const SpanOptions& options, SpanWorkspace& workspace)
      : span_(span),
        options_(options),
        workspace_(workspace),
        on_(span, options, workspace),
        traits_(on_.traits()),
        found_(options) {}

  [[nodiscard]] std::vector<SpanSolution> run() {
    if (!options_.wants_all() && span_.is_plain_cantilever() && span_.has_unidirectional_load()) {
      SpanSolution solution = plain_cantilever(on_);
      certify_plain_cantilever(solution, workspace_.newton());
      if (solution.status != SolveStatus::saddle) return as_list(std::move(solution));
      (void)add(std::move(solution));
    }
    if (options_.wants_all()) {
      descend_from_all_starts();
      search_between(options_, workspace_, found_);
      search_adjacent(options_, workspace_, found_);
    } else {
      descend_from_lowest_starts();
    }
    const bool may_leave = span_.planar && !span_.stays_in_plane();
    if (may_leave && span_.has_material_directors()) search_in_space();
    if (options_.wants_all()) log_omitted();
    if (found_.empty()) (void)found_.add(failed_solution());
    return std::move(found_).take();
  }

 private:
  /// Starts from each initial guess, by descent and by Newton's method alone: a descent leaves
  /// unstable equilibria, and Newton's method stays near them.
  void descend_from_all_starts() {
    const std::string kind = starts_of(span_);
    for (const Start& start : starts()) {
      if (on_.out_of_time()) return;
      (void)add(refine(on_, on_.from_start(start)), kind + ", downhill");
      (void)add(refine(on_, on_.newton_from(start.field)), kind + ", by Newton's method");
      leave_saddles();
    }
  }

  /// Descends with few coefficients from the starts of least cost, then refines those that may be
  /// the lowest. Other starts are used only if the first ones lead to no stable lowest shape.
  void descend_from_lowest_starts() {
    const std::vector<Start> starts = ranked_starts();
    const std::size_t first = std::min(followed_start_count(), starts.size());
    std::vector<SpanSolution> coarse;
    for (std::size_t i = 0; i < starts.size() && !on_.out_of_time(); ++i) {
      if (i >= first && found_.has_stable_lowest()) return;
      // A factor is not needed for later refinement and would occupy memory.
      if (!coarse.empty()) coarse.back().factor.reset();
      SpanSolution solution = on_.from_start(starts[i]);
      found_.add_evaluations(std::exchange(solution.evaluations, 0));
      // Points of loosely converged shapes differ more than those of converged ones.
      const bool known = std::ranges::any_of(coarse, [&](const auto& other) {
        return other.is_equilibrium() && is_same_shape(solution, other, 10 * loose_step_tolerance);
      });
      if (!known) coarse.push_back(std::move(solution));
      if (i + 1 < first) continue;
      refine_lowest(std::exchange(coarse, {}));
      leave_saddles();
    }
  }

  /// Refines those of the coarse equilibria that may be the lowest one, lowest first, and adds
  /// them. More coefficients lower the energy of different shapes by about the same amount, and
  /// that of a mirror image by exactly the same.
  void refine_lowest(std::vector<SpanSolution> coarse) {
    std::ranges::stable_sort(coarse, [](const auto& a, const auto& b) {
      return a.is_equilibrium() != b.is_equilibrium() ? a.is_equilibrium() : a.energy < b.energy;
    });
    for (SpanSolution& solution : coarse) {
      const double above = solution.energy - lowest_coarse_;
      const bool higher =
          above >= last_refinement_decrease_ || std::abs(above) <= 1e-8 * (1 + traits_.load);
      if (found_.has_stable_lowest() && (higher || !solution.is_equilibrium())) continue;
      SpanSolution fine = refine(on_, solution);
      lowest_coarse_ = solution.energy;
      last_refinement_decrease_ = std::max(0.0, solution.energy - fine.energy);
      (void)add(std::move(fine));
    }
  }

  void log_omitted() const {
    (void)omits_late_starts(options_);
    std::ptrdiff_t saddles = 0;
    for (std::size_t i = saddles_left_; i < found_.size(); ++i) {
      saddles += found_[i].status == SolveStatus::saddle ? 1 : 0;
    }
    if (saddles_left_ < most_searched_from || saddles == 0) return;
    options_.log->add_omitted(std::to_string(saddles) + " unstable equilibria, beyond the first " +
                              std::to_string(most_searched_from) +
                              " found, which were not followed downhill");
  }

  [[nodiscard]] std::size_t followed_start_count() const {
    const bool is_predictable = !span_.has_material_directors() && span_.soft_obstacles.empty();
    return is_predictable ? followed_starts : more_followed_starts;
  }

  [[nodiscard]] std::vector<Start> starts() const {
    std::vector<Start> starts;
    for (TangentField& field :
         span_.has_material_directors() ? natural_fields(span_) : start_fields(span_)) {
      starts.emplace_back().field = std::move(field);
    }
    return starts;
  }

  [[nodiscard]] std::vector<Start> ranked_starts() {
    std::vector<Start> ranked = starts();
    const int coarse = on_.coarse_terms();
    // If the ranking uses the number of coefficients of the descent, its fits are reused.
    const bool keeps = coarse <= few_terms && span_.holds.empty() && span_.contacts.empty();
    SpanSolution trial = workspace_.empty_solution(
        span_, keeps ? coarse : std::max(8, std::min(traits_.natural_terms, coarse)));
    const bool satisfies_constraints = trial.model->constraints() > 0 && !traits_.taut &&
                                       !trial.model->has_soft_obstacles() &&
                                       !span_.has_material_directors();
    satisfies_constraints ? rank_with_constraints(trial, ranked) : rank_with_springs(trial, ranked);
    found_.add_evaluations(trial.evaluations);
    std::ranges::stable_sort(ranked, {}, &Start::cost);
    return ranked;
  }

  void rank_with_springs(SpanSolution& trial, std::vector<Start>& starts) const {
    SpanPoint point;
    for (Start& start : starts) {
      trial.evaluate(trial.model->fit(start.field(trial.model->nodes())), point);
      if (trial.terms == on_.coarse_terms()) {
        start.model = trial.model;
        start.x = point.x;
      }
      start.cost = point.energy + traits_.stiffness / 2 * point.residual.squaredNorm();
    }
  }

  /// Ranks starts by their energy once the constraints are satisfied, for those starts that may
  /// still be among the ones followed in any case. With a remaining constraint residual a shape
  /// would seem cheaper than any that satisfies the constraints.
  void rank_with_constraints(SpanSolution& trial, std::vector<Start>& starts) const {
    // Springs at the grips, as at the begin of a penalty method: a lower bound of the cost of the
    // residual.
    const double kappa = 100 * (1 + traits_.load);
    SpanEnergy& model = *trial.model;
    for (Start& start : starts) {
      const SpanEnergy::Estimate estimated = model.estimate(start.field(model.nodes()).tangents);
      start.cost = estimated.energy + kappa / 2 * estimated.gap * estimated.gap;
    }
    std::ranges::stable_sort(starts, {}, &Start::cost);
    std::vector<double> energies;  // lowest energies of starts that satisfy the constraints
    SpanPoint point;
    RestoreScratch scratch;
    for (Start& start : starts) {
      if (on_.out_of_time()) return;
      const double most = energies.size() < followed_start_count()
                              ? std::numeric_limits<double>::infinity()
                              : energies.back();
      const StartShape shape = start.field(model.nodes());
      const SpanEnergy::Estimate estimated = model.estimate(shape.tangents);
      // A fit with few coefficients is smoother, and satisfying the constraints may straighten it.
      if (estimated.energy - estimated.bending / 2 > most) continue;
      // The fit is not corrected: satisfying the constraints follows.
      trial.evaluate(model.fit(shape, 0), point);
      if (!restore_constraints(trial, point, largest_constraint_residual, scratch, most)) {
        start.cost = std::max(start.cost, most);
        continue;
      }
      start.model = trial.model;
      start.x = point.x;
      start.cost = point.energy;
      energies.insert(std::upper_bound(energies.begin(), energies.end(), point.energy),
                      point.energy);
      if (energies.size() > followed_start_count()) energies.pop_back();
    }
  }

  /// Searches in space for a curved rod or a strip in a plane, if an equilibrium found is a saddle
  /// or all equilibria are wanted: out of its plane such a rod twists far and has other shapes.
  void search_in_space() {
    const auto is_saddle = [](const auto& solution) {
      return solution.status == SolveStatus::saddle;
    };
    if (!options_.wants_all() && std::ranges::none_of(found_.by_discovery(), is_saddle)) return;
    Span space = span_;
    space.planar = false;
    SearchLog own;
    SpanOptions options = options_;
    if (options_.wants_all()) options.log = &own;
    int first = 0;
    for (SpanSolution& solution : Search(space, options, workspace_).run()) {
      if (add(std::move(solution))) ++first;
    }
    if (!options_.wants_all()) return;
    options_.log->count_tried(out_of_plane, own.starts());
    options_.log->count_found(out_of_plane, first);
    for (const std::string& what : own.omitted()) options_.log->add_omitted(what);
  }

  /// Certifies and adds a refined solution. Of a solution that does not belong to the homotopy
  /// class of the clamps (belongs_to_class()) only the evaluations count.
  /// @param strategy  name in the log; empty: not logged
  bool add(SpanSolution solution, const std::string& strategy = {}) {
    if (span_.twist && !belongs_to_class(solution, span_.twist->turns)) {
      found_.add_evaluations(solution.evaluations);
      return false;
    }
    return found_.add(certified_solution(std::move(solution), options_, workspace_), strategy);
  }

  /// Descends from the unstable equilibria, including those that such a descent finds.
  void leave_saddles() {
    for (;
         saddles_left_ < found_.size() && saddles_left_ < most_searched_from && !on_.out_of_time();
         ++saddles_left_) {
      if (!options_.wants_all() && found_.has_stable_lowest()) return;
      if (found_[saddles_left_].status != SolveStatus::saddle) continue;
      const SpanSolution saddle = found_[saddles_left_];
      std::optional<SpanSolution> lower = leave_saddle(saddle, options_, workspace_);
      if (lower) (void)add(std::move(*lower), saddle_descent_strategy);
    }
  }

  /// Returns the solution to report if nothing was found in time, or nothing of the clamps' class.
  [[nodiscard]] SpanSolution failed_solution() {
    SpanSolution none = on_.empty_solution(on_.terms());
    none.x.setZero(none.model->size());
    none.multipliers.setZero(none.model->constraints());
    none.finish(SolveStatus::time_limit);
    if (!on_.out_of_time()) none.fail(no_equilibrium_of_class);
    return none;
  }

  const Span& span_;
  const SpanOptions& options_;
  SpanWorkspace& workspace_;
  LocalSolver on_;
  const SpanTraits& traits_;
  Found found_;
  // Coarse energy of the last equilibrium that was refined, and its decrease by refinement.
  double lowest_coarse_ = std::numeric_limits<double>::infinity();
  double last_refinement_decrease_ = 0;
  std::size_t saddles_left_ =
      0;  // number of equilibria found from which a descent was tried or not needed
};

}  // namespace

std::vector<SpanSolution> solve_span(const Span& span, const SpanOptions& options,
                                     SpanWorkspace& workspace) {
  if (options.start.field) return as_list(solve_from_given_start(span, options, workspace));
  return Search(span, options, workspace).run();
}

}  // namespace dlo::energy_model
