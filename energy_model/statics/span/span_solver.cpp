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
#include "span/found.hpp"
#include "span/given_start.hpp"
#include "span/local_solver.hpp"
#include "span/nearby_equilibria.hpp"
#include "span/plain_cantilever.hpp"
#include "span/refinement.hpp"
#include "span/span_starts.hpp"
#include "span/start_ranking.hpp"

namespace dlo::energy_model {
namespace {

/// Number of initial guesses, in the order of their energy, that the search for the lowest minimum
/// follows.
constexpr std::size_t followed_starts = 2;
/// Number of such guesses for a rod with material directors, whose lowest shape is harder to
/// predict.
constexpr std::size_t followed_natural_starts = 6;
/// Number of such guesses if there are soft obstacles, which a rod may pass on either side.
constexpr std::size_t followed_starts_beside_obstacles = 6;

/// Largest difference of points, divided by the length, up to which loosely converged shapes count
/// as one.
constexpr double same_coarse_points = 10 * rough_step;

/// Maximum number of unstable equilibria from which a descent is started.
constexpr std::size_t most_saddles = 8;

constexpr const char* left_downhill = "unstable equilibria, followed downhill";
constexpr const char* out_of_plane = "the same starts and others, out of the plane";

/// Describes start_fields() and natural_fields() in words.
std::string starts_of(const Span& span) {
  const std::string plain = span.holds.empty() && span.start_direction
                                ? "shapes of a soft rod below its clamp"
                                : "arches, S-shapes and loops between grips";
  return span.has_material_directors() ? "the stress-free shape, " + plain : plain;
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
      if (!span_.confined) certify_out_of_plane(solution, traits_.load, workspace_.factors());
      if (solution.status != SolveStatus::saddle) return list_of(std::move(solution));
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
    if (found_.empty()) (void)found_.add(none());
    return std::move(found_).take();
  }

 private:
  /// Starts from each initial guess, by descent and by Newton's method alone: a descent leaves
  /// unstable equilibria, and Newton's method stays near them.
  void descend_from_all_starts() {
    const std::string kind = starts_of(span_);
    for (const Start& start : starts()) {
      if (on_.out_of_time()) return;
      (void)add(refined(on_, on_.from_start(start)), kind + ", downhill");
      (void)add(refined(on_, on_.newton_from(start.field)), kind + ", by Newton's method");
      leave_saddles();
    }
  }

  /// Descends with few coefficients from the starts of least cost, then refines those that may be
  /// the lowest. Other starts are used only if the first ones lead to no stable lowest shape.
  void descend_from_lowest_starts() {
    const std::vector<Start> starts = ranked_starts();
    const std::size_t first = std::min(followed(), starts.size());
    std::vector<SpanSolution> coarse;
    for (std::size_t i = 0; i < starts.size() && !on_.out_of_time(); ++i) {
      if (i >= first && found_.has_stable_lowest()) return;
      // A factor is not needed for later refinement and would occupy memory.
      if (!coarse.empty()) coarse.back().factor.reset();
      SpanSolution solution = on_.from_start(starts[i]);
      found_.spend(std::exchange(solution.evaluations, 0));
      const bool known = std::any_of(coarse.begin(), coarse.end(), [&](const auto& other) {
        return other.is_equilibrium() && is_same_shape(solution, other, same_coarse_points);
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
    std::stable_sort(coarse.begin(), coarse.end(), [](const auto& a, const auto& b) {
      return a.is_equilibrium() != b.is_equilibrium() ? a.is_equilibrium() : a.energy < b.energy;
    });
    for (SpanSolution& solution : coarse) {
      const double above = solution.energy - lowest_coarse_;
      const bool higher = above >= fall_ || std::abs(above) <= 1e-8 * (1 + traits_.load);
      if (found_.has_stable_lowest() && (higher || !solution.is_equilibrium())) continue;
      SpanSolution fine = refined(on_, solution);
      lowest_coarse_ = solution.energy;
      fall_ = std::max(0.0, solution.energy - fine.energy);
      (void)add(std::move(fine));
    }
  }

  void log_omitted() const {
    if (on_.out_of_time()) options_.log->add_omitted("starts after the time limit");
    std::ptrdiff_t not_left = 0;
    for (std::size_t i = left_; i < found_.size(); ++i) {
      not_left += found_[i].status == SolveStatus::saddle ? 1 : 0;
    }
    if (left_ < most_saddles || not_left == 0) return;
    options_.log->add_omitted(std::to_string(not_left) + " unstable equilibria, beyond the first " +
                              std::to_string(most_saddles) +
                              " found, which were not followed downhill");
  }

  /// Number of starts that are followed in any case.
  [[nodiscard]] std::size_t followed() const {
    if (span_.has_material_directors()) return followed_natural_starts;
    return span_.soft_obstacles.empty() ? followed_starts : followed_starts_beside_obstacles;
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
    const std::shared_ptr<SpanEnergy> model = workspace_.model(
        span_, keeps ? coarse : std::max(8, std::min(traits_.natural_terms, coarse)));
    found_.spend(rank_starts(
        ranked,
        {.model = model,
         .load = traits_.load,
         .followed = followed(),
         .keeps_unknowns = model->terms() == on_.coarse_terms(),
         .stiffness = traits_.stiffness,
         .satisfies_constraints = model->constraints() > 0 && !traits_.taut &&
                                  !model->has_soft_obstacles() && !span_.has_material_directors(),
         .deadline = &options_.deadline}));
    return ranked;
  }

  /// Searches in space for a curved rod or a strip in a plane, if an equilibrium found is a saddle
  /// or all equilibria are wanted: out of its plane such a rod twists far and has other shapes.
  void search_in_space() {
    const auto is_saddle = [](const auto& solution) {
      return solution.status == SolveStatus::saddle;
    };
    if (!options_.wants_all() &&
        std::none_of(found_.in_order().begin(), found_.in_order().end(), is_saddle)) {
      return;
    }
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
    options_.log->tried(out_of_plane, own.starts());
    options_.log->found(out_of_plane, first);
    for (const std::string& what : own.omitted()) options_.log->add_omitted(what);
  }

  /// Certifies and adds a refined solution. @param strategy  name in the log; empty: not logged
  bool add(SpanSolution solution, const std::string& strategy = {}) {
    if (!is_of_span_class(solution)) return false;
    return found_.add(judged(std::move(solution), options_, workspace_), strategy);
  }

  /// Whether the solution belongs to the homotopy class of the clamps (is_of_class()); counts the
  /// evaluations of others.
  [[nodiscard]] bool is_of_span_class(SpanSolution& solution) {
    if (!span_.twist || is_of_class(solution, span_.twist->turns)) return true;
    found_.spend(std::exchange(solution.evaluations, 0));
    return false;
  }

  /// Descends from the unstable equilibria, including those that such a descent finds.
  void leave_saddles() {
    for (; left_ < found_.size() && left_ < most_saddles && !on_.out_of_time(); ++left_) {
      if (!options_.wants_all() && found_.has_stable_lowest()) return;
      if (found_[left_].status != SolveStatus::saddle) continue;
      const SpanSolution saddle = found_[left_];
      std::optional<SpanSolution> lower = leave_saddle(saddle, options_, workspace_);
      if (lower) (void)add(std::move(*lower), left_downhill);
    }
  }

  /// Returns the solution to report if nothing was found in time, or nothing of the clamps' class.
  [[nodiscard]] SpanSolution none() {
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
  double fall_ = 0;
  std::size_t left_ = 0;  // number of equilibria found from which a descent was tried or not needed
};

}  // namespace

std::vector<SpanSolution> solve_span(const Span& span, const SpanOptions& options,
                                     SpanWorkspace& workspace) {
  if (options.start.field) return list_of(solve_from_given_start(span, options, workspace));
  return Search(span, options, workspace).run();
}

}  // namespace dlo::energy_model
