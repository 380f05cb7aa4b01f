#include "span/span_solver.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "base/legendre.hpp"
#include "certify/certify.hpp"
#include "certify/rigid_body_modes.hpp"
#include "linear/free_directions.hpp"
#include "span/local_solver.hpp"
#include "span/negative_curvature.hpp"
#include "span/plain_cantilever.hpp"
#include "span/refinement.hpp"
#include "span/same_shape.hpp"
#include "span/search_log.hpp"
#include "span/settle_contact.hpp"
#include "span/span_starts.hpp"
#include "span/start_ranking.hpp"
#include "strain/point_on_span.hpp"

namespace dlo::energy_model {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

/// Starts, in the order of their energy, that the search for the lowest minimum follows.
constexpr std::size_t followed_starts = 2;
/// The same of a rod with material directors, whose lowest shape is harder to guess.
constexpr std::size_t followed_natural_starts = 6;
/// The same beside obstacles that yield, which a rod may pass on either side.
constexpr std::size_t followed_starts_beside_obstacles = 6;

/// Cost over that of the last start that is followed anyway, of what starts fall by, up to which
/// another one is followed too.
constexpr double near_tie = 0.1;

/// Difference of points over the length up to which what Newton's method has only come near to is
/// one shape.
constexpr double same_coarse_points = 10 * rough_step;

/// Unstable equilibria that are left for what lies below them.
constexpr std::size_t most_saddles = 8;

/// Equilibria between each two of which others are looked for.
constexpr std::size_t most_joined = 6;

constexpr const char* left_downhill = "unstable equilibria, left downhill";
constexpr const char* between_found = "between two of those found, by Newton's method";
constexpr const char* beside_found = "beside what was found, by Newton's method";
constexpr const char* out_of_plane = "the same and others, out of the plane";

/// What start_fields() and natural_fields() are, in words.
std::string starts_of(const Span& span) {
  const std::string plain = span.holds.empty() && span.start_direction
                                ? "shapes of a soft rod below its clamp"
                                : "arches, S-shapes and loops between grips";
  return span.has_material_directors() ? "the stress-free shape, " + plain : plain;
}

/// Whether the lowest of the equilibria found can hold itself.
bool has_stable_lowest(const std::vector<SpanSolution>& found) {
  const SpanSolution* lowest = nullptr;
  for (const SpanSolution& solution : found) {
    if (!solution.is_equilibrium()) continue;
    if (lowest == nullptr || solution.energy < lowest->energy) lowest = &solution;
  }
  return lowest != nullptr && succeeded(lowest->status);
}

/// A braced list would copy it.
std::vector<SpanSolution> list_of(SpanSolution solution) {
  std::vector<SpanSolution> result;
  result.push_back(std::move(solution));
  return result;
}

class Search {
 public:
  Search(const Span& span, const SpanOptions& options, SpanWorkspace& workspace)
      : span_(span),
        options_(options),
        workspace_(workspace),
        on_(span, options, workspace),
        traits_(on_.traits()) {}

  [[nodiscard]] std::vector<SpanSolution> run() {
    if (options_.start) return list_of(from_given_start_to_rest());
    std::vector<SpanSolution> found;
    if (!options_.wants_all() && span_.is_plain_cantilever() && span_.pulled_one_way()) {
      SpanSolution solution = plain_cantilever(on_);
      certify_out_of_plane(solution, traits_.load, workspace_.factors());
      if (solution.status != SolveStatus::saddle) return list_of(std::move(solution));
      add(std::move(solution), found);
    }
    const std::vector<Start> starts = ranked_starts();
    std::size_t first = options_.wants_all() ? starts.size() : std::min(followed(), starts.size());
    std::vector<SpanSolution> coarse;
    const std::string kind = options_.wants_all() ? starts_of(span_) : std::string();
    for (std::size_t i = 0; i < starts.size() && !on_.out_of_time(); ++i) {
      // The other starts only where the first ones and what they lead to do not hold.
      if (i >= first && has_stable_lowest(found)) break;
      // Refined later, it would keep a factor's memory in use and gain nothing by it.
      if (!coarse.empty()) coarse.back().factor.reset();
      SpanSolution solution = on_.from_start(starts[i]);
      spent_ += solution.evaluations;
      solution.evaluations = 0;
      const bool known =
          is_known(solution, coarse, options_.wants_all() ? same_points : same_coarse_points);
      if (!known) coarse.push_back(std::move(solution));
      if (options_.wants_all()) {
        note(kind + ", downhill", !known && add(refined(on_, coarse.back()), found));
        // Descending leaves unstable equilibria; Newton's method alone stays near them.
        note(kind + ", by Newton's method",
             add(refined(on_, on_.newton_from(starts[i].field)), found));
      }
      if (i + 1 == first && may_lead_lower(starts, first, coarse)) ++first;
      if (i + 1 < first) continue;
      if (!options_.wants_all()) refine_lowest(std::exchange(coarse, {}), found);
      leave_saddles(found);
    }
    if (options_.wants_all()) {
      look_between(found);
      look_beside(found);
    }
    if (span_.planar && span_.has_material_directors()) look_in_space(found);
    if (options_.wants_all()) tell_what_was_left_out(found);
    return sorted(std::move(found));
  }

 private:
  /// Adds those of the coarse equilibria that may be the lowest one, with all of their terms,
  /// lowest first. More terms lower the energy, of one shape about as much as of another; of a
  /// mirror image by as much.
  void refine_lowest(std::vector<SpanSolution> coarse, std::vector<SpanSolution>& found) {
    std::stable_sort(coarse.begin(), coarse.end(), [](const auto& a, const auto& b) {
      return a.is_equilibrium() != b.is_equilibrium() ? a.is_equilibrium() : a.energy < b.energy;
    });
    for (SpanSolution& solution : coarse) {
      const double above = solution.energy - lowest_coarse_;
      const bool higher = above >= fall_ || std::abs(above) <= 1e-8 * (1 + traits_.load);
      if (has_stable_lowest(found) && (higher || !solution.is_equilibrium())) continue;
      SpanSolution fine = refined(on_, solution);
      lowest_coarse_ = solution.energy;
      fall_ = std::max(0.0, solution.energy - fine.energy);
      (void)add(std::move(fine), found);
    }
  }

  /// Of one start.
  void note(const std::string& strategy, bool is_new) const {
    note_tried(options_.log, strategy);
    if (is_new) note_found(options_.log, strategy);
  }

  void tell_what_was_left_out(const std::vector<SpanSolution>& found) const {
    if (on_.out_of_time()) options_.log->leave_out("starts after the time limit");
    const auto not_left = std::count_if(
        found.begin() + static_cast<std::ptrdiff_t>(std::min(left_, found.size())), found.end(),
        [](const SpanSolution& solution) { return solution.status == SolveStatus::saddle; });
    if (left_ < most_saddles || not_left == 0) return;
    options_.log->leave_out(std::to_string(not_left) + " unstable equilibria, beyond the first " +
                            std::to_string(most_saddles) + " found, which were not left downhill");
  }

  /// Whether the first of the starts that need not be followed costs about as much as the last of
  /// those: next to what these have fallen by, that is no difference.
  [[nodiscard]] bool may_lead_lower(const std::vector<Start>& starts, std::size_t next,
                                    const std::vector<SpanSolution>& found) const {
    if (options_.wants_all() || traits_.taut || next >= starts.size() || !starts.front().model)
      return false;
    double lowest = infinite;
    for (const SpanSolution& solution : found) {
      if (solution.is_equilibrium()) lowest = std::min(lowest, solution.energy);
    }
    const double last = starts[followed() - 1].cost;
    return starts[next].cost - last <= near_tie * (last - lowest);
  }

  /// Starts that are descended from in any case.
  [[nodiscard]] std::size_t followed() const {
    if (span_.has_material_directors()) return followed_natural_starts;
    return span_.soft_obstacles.empty() ? followed_starts : followed_starts_beside_obstacles;
  }

  [[nodiscard]] std::vector<Start> ranked_starts() {
    std::vector<Start> starts;
    for (TangentField& field :
         span_.has_material_directors() ? natural_fields(span_) : start_fields(span_)) {
      starts.emplace_back().field = std::move(field);
    }
    if (options_.wants_all()) return starts;
    const int coarse = on_.coarse_terms();
    // What is looked at with the terms that it is left with need not be fitted twice.
    const bool keeps = coarse <= few_terms && span_.holds.empty() && span_.contacts.empty();
    const std::shared_ptr<SpanEnergy> model = workspace_.model(
        span_, keeps ? coarse : std::max(8, std::min(traits_.natural_terms, coarse)));
    spent_ += rank_starts(
        starts, {.model = model,
                 .load = traits_.load,
                 .followed = followed(),
                 .keeps_unknowns = model->terms() == on_.coarse_terms(),
                 .stiffness = traits_.stiffness,
                 .meets_grips = model->constraints() > 0 && !traits_.taut &&
                                !model->has_soft_obstacles() && !span_.has_material_directors(),
                 .deadline = &options_.deadline});
    return starts;
  }

  /// A curved rod, or a strip, that gives way out of its plane twists far: it has shapes of its own
  /// there.
  void look_in_space(std::vector<SpanSolution>& found) {
    const auto is_saddle = [](const auto& solution) {
      return solution.status == SolveStatus::saddle;
    };
    if (!options_.wants_all() && std::none_of(found.begin(), found.end(), is_saddle)) return;
    Span space = span_;
    space.planar = false;
    SearchLog own;
    SpanOptions options = options_;
    if (options_.wants_all()) options.log = &own;
    int first = 0;
    for (SpanSolution& solution : Search(space, options, workspace_).run()) {
      if (add(std::move(solution), found)) ++first;
    }
    if (!options_.wants_all()) return;
    options_.log->tried(out_of_plane, own.starts());
    options_.log->found(out_of_plane, first);
    for (const std::string& what : own.not_looked()) options_.log->leave_out(what);
  }

  /// From the caller's own start, certified; a shape that is followed (SpanOptions::known) to where
  /// it falls from a saddle.
  [[nodiscard]] SpanSolution from_given_start_to_rest() {
    SpanSolution solution = from_given_start();
    // What gives way to contact that is found on the way may fall elsewhere.
    const bool may_fall = came_by_newton_ && !span_.soft_obstacles.empty();
    const Eigen::Matrix3Xd near = may_fall ? looked_at(solution) : Eigen::Matrix3Xd();
    solution = finish(std::move(solution), options_, workspace_);
    solution.followed =
        came_by_newton_ &&
        !(may_fall && (looked_at(solution) - near).cwiseAbs().maxCoeff() > followed_tangents);
    if (!options_.known.model || options_.only_follows() || solution.status != SolveStatus::saddle)
      return solution;
    std::optional<SpanSolution> lower = leave_saddle(solution);
    if (!lower) return solution;
    certify(*lower, traits_.load, workspace_.factors());
    lower->evaluations += solution.evaluations;
    return succeeded(lower->status) ? std::move(*lower) : std::move(solution);
  }

  [[nodiscard]] SpanSolution from_given_start() {
    const bool follow = options_.approach != Approach::descend;
    SpanSolution solution =
        follow ? on_.newton_from(options_.start) : on_.from_start(Start{options_.start});
    came_by_newton_ = follow && options_.known.model != nullptr && solution.is_equilibrium() &&
                      is_near_start(solution);
    if (succeeded(solution.status) && (came_by_newton_ || !options_.known.model)) return solution;
    if (options_.only_follows()) return solution;
    const int spent = solution.evaluations;
    if (std::optional<SpanSolution> adapted = start_on_adapted_mesh()) {
      adapted->evaluations += spent;
      return std::move(*adapted);
    }
    solution = follow ? on_.from_start(Start{options_.start}) : on_.newton_from(options_.start);
    solution.evaluations += spent;
    return solution;
  }

  /// Tangents of a shape at arc lengths that are the same for all.
  [[nodiscard]] Eigen::Matrix3Xd looked_at(const SpanSolution& solution) const {
    constexpr Eigen::Index looks = 65;
    const Eigen::VectorXd s = Eigen::VectorXd::LinSpaced(looks, 0, span_.length);
    return solution.model->shape(solution.x).sample({s.data(), s.data() + looks}).tangents;
  }

  [[nodiscard]] bool is_near_start(const SpanSolution& solution) const {
    const Eigen::Matrix3Xd start = options_.start(solution.model->nodes()).tangents;
    return (solution.model->tangents() - start).cwiseAbs().maxCoeff() < followed_tangents;
  }

  /// From a start next to which Newton's method has found nothing, with pieces for the start's own
  /// shape, downhill if need be.
  [[nodiscard]] std::optional<SpanSolution> start_on_adapted_mesh() {
    if (options_.known.model || span_.holds.empty()) return std::nullopt;
    SpanSolution looked = on_.empty_solution(max_terms);
    looked.x = looked.model->fit(options_.start(looked.model->nodes()));
    const PointOnSpan point = evaluated(*looked.model, looked.x);
    looked.multipliers = point.jacobian.transpose().householderQr().solve(point.gradient);
    const std::optional<Span> span = adapted_mesh(on_, looked);
    if (!span) return std::nullopt;
    LocalSolver own(*span, options_, workspace_);
    SpanSolution solution = own.newton_from(options_.start);
    const int spent = solution.evaluations;
    if (!solution.is_equilibrium()) {
      solution = own.empty_solution(own.terms());
      solution.x = solution.model->fit(options_.start(solution.model->nodes()));
      own.by_augmented_lagrangian(solution);
      solution.evaluations += spent;
    }
    solution = refined(own, std::move(solution));
    if (!solution.is_equilibrium()) return std::nullopt;
    return solution;
  }

  /// Keeps an equilibrium that is not known yet, or the first failure until there is one.
  /// @return whether it is such an equilibrium
  bool add(SpanSolution solution, std::vector<SpanSolution>& found) {
    spent_ += solution.evaluations;
    spent_ += judge(solution, options_, workspace_);
    if (!counts(solution, options_)) {
      if (found.empty()) found.push_back(std::move(solution));
      return false;
    }
    if (!found.empty() && !counts(found.front(), options_)) found.clear();
    if (is_known(solution, found)) return false;
    // Of many equilibria it would take much memory, and nothing goes on from most of them.
    if (options_.wants_all()) solution.factor.reset();
    found.push_back(std::move(solution));
    return true;
  }

  [[nodiscard]] bool is_known(const SpanSolution& solution, const std::vector<SpanSolution>& found,
                              double tolerance = same_points) const {
    return std::any_of(found.begin(), found.end(), [&](const SpanSolution& other) {
      return counts(other, options_) && is_same_shape(solution, other, tolerance);
    });
  }

  /// Descends from the unstable equilibria, once more from those that it leads to.
  void leave_saddles(std::vector<SpanSolution>& found) {
    for (; left_ < found.size() && left_ < most_saddles && !on_.out_of_time(); ++left_) {
      if (!options_.wants_all() && has_stable_lowest(found)) return;
      if (found[left_].status != SolveStatus::saddle) continue;
      std::optional<SpanSolution> lower = leave_saddle(found[left_]);
      if (lower) note(left_downhill, add(std::move(*lower), found));
    }
  }

  /// Each shape has its own ends of contact with obstacles that yield.
  [[nodiscard]] SpanSolution on_shared_pieces(const SpanSolution& solution) {
    Span span = solution.model->span();
    if (span.contact_ends.empty()) return solution;
    span.contact_ends.clear();
    LocalSolver own(span, options_, workspace_);
    return on_other_pieces(own, solution, own.coarse_terms());
  }

  /// Between two minima there is a pass, and a saddle on it: by Newton's method from where the
  /// unknowns of two equilibria are joined.
  void look_between(std::vector<SpanSolution>& found) {
    constexpr std::array<double, 5> shares = {0.2, 0.3, 0.5, 0.7, 0.8};
    for (std::size_t j = 1; j < found.size() && j < most_joined; ++j) {
      for (std::size_t i = 0; i < j && !on_.out_of_time(); ++i) {
        const SpanSolution a = on_shared_pieces(found[i]);
        const SpanSolution b = on_shared_pieces(found[j]);
        const Span& span = a.model->span();
        if (span.planar != b.model->span().planar || span.cuts != b.model->span().cuts) continue;
        LocalSolver own(span, options_, workspace_);
        for (const double share : shares) {
          SpanSolution between = own.empty_solution(std::max(a.terms, b.terms));
          SpanEnergy& model = *between.model;
          between.x = (1 - share) * model.adopt(*a.model, a.x);
          between.x += share * model.adopt(*b.model, b.x);
          between.multipliers = (1 - share) * model.adopt_multipliers(*a.model, a.multipliers) +
                                share * model.adopt_multipliers(*b.model, b.multipliers);
          own.newton(between);
          note(between_found, add(refined(own, std::move(between)), found));
        }
      }
    }
    if (found.size() > most_joined) {
      options_.log->leave_out("what lies between the equilibria found, but for the first " +
                              std::to_string(most_joined));
    }
  }

  /// At a fold two equilibria come from one, and lie on both sides of it along its mode
  /// direction: by Newton's method from beside those found, also those found that way.
  void look_beside(std::vector<SpanSolution>& found) {
    constexpr std::array<double, 6> steps = {0.5, -0.5, 1, -1, 2, -2};
    std::size_t i = 0;
    for (; i < found.size() && i < most_saddles && !on_.out_of_time(); ++i) {
      if (!counts(found[i], options_)) continue;
      const SpanSolution from = found[i];
      const std::optional<Eigen::VectorXd> mode = mode_nearest_zero(from);
      if (!mode) continue;
      LocalSolver own(from.model->span(), options_, workspace_);
      for (const double step : steps) {
        SpanSolution beside = workspace_.with_terms(from, from.terms);
        beside.x += step * *mode;
        own.newton(beside);
        note(beside_found, add(refined(own, std::move(beside)), found));
      }
    }
    if (i >= found.size()) return;
    options_.log->leave_out("what lies beside the equilibria found, but for the first " +
                            std::to_string(i));
  }

  /// Unit vector along the eigenvalue of the projected second variation that is nearest to zero,
  /// rigid-body modes left aside; none if the constraints leave no other.
  [[nodiscard]] static std::optional<Eigen::VectorXd> mode_nearest_zero(
      const SpanSolution& solution) {
    SpanEnergy& model = *solution.model;
    const SecondDerivatives at = second_derivatives(solution);
    ReducedHessian reduced;
    reduced.compute(at.hessian, at.jacobian);
    const Eigen::Index free = rigid_body_modes(model.span(), model.tangents()).in_plane;
    if (free >= model.size() - model.constraints()) return std::nullopt;
    return direction_by_size(reduced, free);
  }

  /// Where an equilibrium that cannot hold itself comes to rest; out of its plane if that is the
  /// only way in which it gives way.
  [[nodiscard]] std::optional<SpanSolution> leave_saddle(const SpanSolution& solution) {
    constexpr double push = 0.5;
    const std::optional<NegativeCurvature> way = negative_curvature(solution);
    if (way) return pushed_from(way->span, solution, push * way->direction);
    // Through an obstacle's middle it gives way in a mode that its series does not see as unstable.
    const std::optional<Eigen::VectorXd> mode = mode_nearest_zero(solution);
    if (!mode || solution.model->span().soft_obstacles.empty()) return std::nullopt;
    return pushed_from(solution.model->span(), solution, push * *mode);
  }

  [[nodiscard]] SpanSolution pushed_from(const Span& span, const SpanSolution& solution,
                                         const Eigen::VectorXd& disturbance) {
    LocalSolver own(span, options_, workspace_);
    const std::shared_ptr<SpanEnergy> model = workspace_.model(span, solution.terms);
    const Eigen::VectorXd pushed = model->adopt(*solution.model, solution.x) + disturbance;
    SpanSolution lower = own.empty_solution(std::min(solution.terms, own.coarse_terms()));
    lower.x = lower.model->adopt(*model, pushed);
    own.descend(lower);
    return refined(own, std::move(lower));
  }

  [[nodiscard]] std::vector<SpanSolution> sorted(std::vector<SpanSolution> found) {
    std::stable_sort(found.begin(), found.end(), is_better);
    if (found.empty()) {
      found.push_back(on_.empty_solution(on_.terms()));
      found.back().x.setZero(found.back().model->size());
      found.back().multipliers.setZero(found.back().model->constraints());
      found.back().finish(SolveStatus::time_limit);
    }
    found.front().evaluations = spent_;
    if (!options_.wants_all()) found.resize(1);
    return found;
  }

  const Span& span_;
  const SpanOptions& options_;
  SpanWorkspace& workspace_;
  LocalSolver on_;
  const SpanTraits& traits_;
  // Of the last equilibrium that was refined, and by how much its energy fell.
  double lowest_coarse_ = infinite;
  double fall_ = 0;
  int spent_ = 0;         // evaluations of everything that was looked at
  std::size_t left_ = 0;  // how many of the equilibria found have been looked at for a way down
  bool came_by_newton_ = false;  // from the known shape to one next to it
};

}  // namespace

std::vector<SpanSolution> solve_span(const Span& span, const SpanOptions& options,
                                     SpanWorkspace& workspace) {
  return Search(span, options, workspace).run();
}

}  // namespace dlo::energy_model
