#include "search/span_solver.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "base/legendre.hpp"
#include "base/minimise.hpp"
#include "certify/certify.hpp"
#include "certify/enough_terms.hpp"
#include "certify/free_turns.hpp"
#include "certify/piece_cuts.hpp"
#include "linear/free_directions.hpp"
#include "newton/penalty_descent.hpp"
#include "newton/restore.hpp"
#include "newton/trust_region.hpp"
#include "problem/segments.hpp"
#include "search/search_log.hpp"
#include "search/span_starts.hpp"
#include "search/start_ranking.hpp"
#include "search/way_down.hpp"

namespace dlo::energy_model {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

/// Above this sum of weight and loads (in EI/l^2) a rod is nearer to its soft limit than to
/// straight.
constexpr double soft_load = 12;

/// Coefficients up to which a coarser start is not worth its set-up, and the fewest of one.
constexpr int few_terms = 10;
constexpr int least_terms = 7;

/// Unknowns with which a minimum between grips is looked for.
constexpr int coarse_unknowns = 100;

/// The same where they are more than `most_unknowns` because pieces end where the shape wants it.
constexpr int most_graded_unknowns = 2 * most_unknowns;

/// Error over the length above which a shape is asked about with more terms than it takes to look
/// right.
constexpr double largest_told_error = 1e-5;

/// Gradient over the load that a shape may have in more terms than its own.
constexpr double largest_residual = 1e-5;

/// Cost over that of the last start that is followed anyway, of what starts fall by, up to which
/// another one is followed too.
constexpr double near_tie = 0.1;

/// Gap over the tolerance that it may have there.
constexpr double largest_gap = 10;

/// Difference of points over the length up to which what is only roughly polished is one shape.
constexpr double same_coarse_points = 10 * rough_step;

/// A step of the trust region works with the cube of the unknowns.
constexpr Eigen::Index most_descended = 160;

/// Models that are kept for as many terms each.
constexpr std::size_t most_kept_models = 8;

/// Unstable equilibria that are left for what lies below them.
constexpr std::size_t most_saddles = 8;

/// Equilibria between each two of which others are looked for.
constexpr std::size_t most_joined = 6;

/// Coefficients that resolve a layer over six of its lengths.
constexpr int layer_terms = 20;

constexpr const char* left_downhill = "unstable equilibria, left downhill";
constexpr const char* between_found = "between two of those found, by Newton's method";
constexpr const char* beside_found = "beside what was found, by Newton's method";
constexpr const char* out_of_plane = "the same and others, out of the plane";

/// What start_fields() and natural_fields() are, in words.
std::string starts_of(const Span& span) {
  const std::string plain = span.holds.empty() && span.start_direction
                                ? "shapes of a soft rod below its clamp"
                                : "arches, S-shapes and loops between grips";
  return span.has_material_directors() ? "the free rod's shape, " + plain : plain;
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

/// Whether all tangents lie between the clamp's direction and the load's, on the shorter way, of a
/// plain cantilever that is pulled one way. Then an equilibrium is the lowest one. With the angle
/// chi from the load's opposite and the force n(s) of what hangs beyond s,
///     chi'' = -n sin(chi),  chi(0) given,  chi'(length) = 0,
/// and the energy's minimum has chi in [0, pi]: what is beyond may be mirrored, which costs no
/// more. There is but one such solution, because sin(chi) / chi falls (Brezis and Oswald, 1986); a
/// second one, chi = 0, only where the clamp points against the load, and that is unstable if it is
/// not the only one.
bool turns_to_load(const Span& span, const Eigen::Matrix3Xd& tangents) {
  constexpr double rounding = 1e-9;  // sine of an angle that the terms leave
  Eigen::Vector3d force = span.weight_between(0, span.length);
  for (const Span::Load& load : span.loads) force += load.force;
  const Eigen::Vector3d across(-force.y(), force.x(), 0);
  const double side = std::copysign(1.0, across.dot(*span.start_direction));
  for (Eigen::Index q = 0; q < tangents.cols(); ++q) {
    if (side * across.dot(tangents.col(q)) < -rounding * force.norm()) return false;
  }
  return true;
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
        load_(span.total_load()),
        graded_(!span.cuts.empty()) {
    workspace_.newton().limit(options.deadline);
    for (const Segment& segment : segments_of(span)) {
      if (!segment.taut()) continue;
      taut_ = true;
      stiffness_ = std::max(stiffness_, segment.tension / std::max(1e-12, segment.slack()));
    }
    // Where contact begins inside a piece it takes more terms than the piece's length tells.
    if (!span.soft_obstacles.empty() || span.is_plain_cantilever()) {
      longest_piece_ = span.length;
      return;
    }
    for (const Piece& piece : pieces_of(span)) {
      longest_piece_ = std::max(longest_piece_, piece.length);
    }
    if (!span.has_material_directors()) return;
    // What the free rod turns by has to be resolved as well.
    const double curvature = span.natural.largest();
    natural_terms_ = first_terms(curvature * curvature, longest_piece_);
  }

  [[nodiscard]] SpanSolution finish(SpanSolution solution) {
    // It may have pieces of its own.
    const Span own = solution.model->span();
    solution = own.cuts == span_.cuts
                   ? refined(std::move(solution))
                   : Search(own, options_, workspace_).refined(std::move(solution));
    judge(solution);
    return solution;
  }

  [[nodiscard]] std::vector<SpanSolution> run() {
    if (options_.start) return list_of(from_given_start_to_rest());
    std::vector<SpanSolution> found;
    if (!options_.all && span_.is_plain_cantilever() && span_.pulled_one_way()) {
      SpanSolution solution = plain_cantilever();
      certify_sideways(solution, load_, workspace_.newton());
      if (solution.status != SolveStatus::saddle) return list_of(std::move(solution));
      add(std::move(solution), found);
    }
    const std::vector<Start> starts = ranked_starts();
    std::size_t first = options_.all ? starts.size() : std::min(followed(), starts.size());
    std::vector<SpanSolution> coarse;
    const std::string kind = options_.log != nullptr ? starts_of(span_) : std::string();
    for (std::size_t i = 0; i < starts.size() && !out_of_time(); ++i) {
      // The other starts only where the first ones and what they lead to do not hold.
      if (i >= first && has_stable_lowest(found)) break;
      SpanSolution solution = from_start(starts[i]);
      spent_ += solution.evaluations;
      solution.evaluations = 0;
      const bool known =
          is_known(solution, coarse, options_.all ? same_points : same_coarse_points);
      if (!known) coarse.push_back(std::move(solution));
      if (options_.all) {
        note(kind + ", downhill", !known && add(refined(coarse.back()), found));
        // Descending leaves unstable equilibria; Newton's method alone stays near them.
        note(kind + ", by Newton's method", add(refined(near_field(starts[i].field)), found));
      }
      if (i + 1 == first && may_lead_lower(starts, first, coarse)) ++first;
      if (i + 1 < first) continue;
      if (!options_.all) refine_lowest(std::exchange(coarse, {}), found);
      leave_saddles(found);
    }
    if (options_.all) {
      look_between(found);
      look_beside(found);
    }
    if (span_.planar && span_.has_material_directors()) look_in_space(found);
    if (options_.log != nullptr) tell_what_was_left_out(found);
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
      const bool higher = above >= fall_ || std::abs(above) <= 1e-8 * (1 + load_);
      if (has_stable_lowest(found) && (higher || !solution.is_equilibrium())) continue;
      SpanSolution fine = refined(solution);
      lowest_coarse_ = solution.energy;
      fall_ = std::max(0.0, solution.energy - fine.energy);
      (void)add(std::move(fine), found);
    }
  }

  /// Of one start.
  void note(const std::string& strategy, bool is_new) const {
    if (options_.log == nullptr) return;
    options_.log->tried(strategy);
    if (is_new) options_.log->found(strategy);
  }

  void tell_what_was_left_out(const std::vector<SpanSolution>& found) const {
    if (out_of_time()) options_.log->leave_out("starts after the time limit");
    const auto not_left = std::count_if(
        found.begin() + static_cast<std::ptrdiff_t>(std::min(left_, found.size())), found.end(),
        [](const SpanSolution& solution) { return solution.status == SolveStatus::saddle; });
    if (left_ < most_saddles || not_left == 0) return;
    options_.log->leave_out(std::to_string(not_left) + " unstable equilibria, beyond the first " +
                            std::to_string(most_saddles) + " found, which were not left downhill");
  }

  [[nodiscard]] int terms() const {
    if (options_.terms > 0) return options_.terms;
    const int layers = taut_ || graded_ ? layer_terms : 0;
    const int first = graded_ ? 0 : first_terms(load_, longest_piece_);
    return std::max({first, options_.least_terms, layers, natural_terms_});
  }

  [[nodiscard]] bool out_of_time() const { return options_.deadline.passed(); }

  /// NLopt comes near with few terms; Newton's method adds the others.
  [[nodiscard]] int coarse_terms() const {
    if (options_.terms > 0) return options_.terms;
    if (terms() <= few_terms) return terms();
    const int fields = span_.planar ? 1 : span_.has_material_directors() ? 3 : 2;
    int coarse = terms() / 2;
    if (!span_.holds.empty()) {
      const int pieces = static_cast<int>(pieces_of(span_).size());
      coarse = std::min(coarse, coarse_unknowns / (fields * pieces));
    }
    return std::max(least_terms, coarse);
  }

  [[nodiscard]] SpanSolution empty_solution(int terms) {
    SpanSolution solution;
    solution.model = workspace_.model(span_, terms);
    solution.terms = terms;
    return solution;
  }

  /// As the load on the straight rod bends it, if that lowers its energy; else straight.
  static void bend_slightly(SpanSolution& solution) {
    SpanEnergy& model = *solution.model;
    solution.x.setZero(model.size());
    Eigen::VectorXd gradient(model.size());
    const double energy = model.value(solution.x, gradient);
    ++solution.evaluations;
    const Eigen::VectorXd bent = -gradient;
    // Newton's method begins with this value, and counts it.
    if (model.value(bent, gradient) < energy) solution.x = bent;
  }

  /// By Newton's method at once; where that leads elsewhere, downhill from the straight rod for a
  /// stiff one, from the soft limit for a soft one or where straight is a saddle.
  [[nodiscard]] SpanSolution plain_cantilever() {
    SpanSolution at_once = empty_solution(terms());
    if (load_ < soft_load) {
      bend_slightly(at_once);
    } else {
      at_once.x = at_once.model->fit(soft_field(span_)(at_once.model->nodes()));
    }
    workspace_.newton().polish(at_once, load_);
    at_once = refined(std::move(at_once));
    if (succeeded(at_once.status) && at_once.evaluations <= options_.max_evaluations &&
        turns_to_load(span_, at_once.model->tangents())) {
      return at_once;
    }
    int spent = at_once.evaluations;
    if (load_ < soft_load) {
      SpanSolution straight = empty_solution(coarse_terms());
      straight.x.setZero(straight.model->size());
      descend(straight);
      SpanSolution solution = refined(std::move(straight));
      if (solution.status != SolveStatus::saddle) {
        solution.evaluations += spent;
        return solution;
      }
      spent += solution.evaluations;
    }
    SpanSolution solution = refined(from_start(Start{soft_field(span_)}));
    solution.evaluations += spent;
    return solution;
  }

  /// Whether the first of the starts that need not be followed costs about as much as the last of
  /// those: next to what these have fallen by, that is no difference.
  [[nodiscard]] bool may_lead_lower(const std::vector<Start>& starts, std::size_t next,
                                    const std::vector<SpanSolution>& found) const {
    if (options_.all || taut_ || next >= starts.size() || !starts.front().model) return false;
    double lowest = infinite;
    for (const SpanSolution& solution : found) {
      if (solution.is_equilibrium()) lowest = std::min(lowest, solution.energy);
    }
    const double last = starts[followed() - 1].cost;
    return starts[next].cost - last <= near_tie * (last - lowest);
  }

  /// Starts that are descended from in any case.
  [[nodiscard]] std::size_t followed() const {
    return span_.has_material_directors() ? followed_natural_starts : followed_starts;
  }

  [[nodiscard]] std::vector<Start> ranked_starts() {
    std::vector<Start> starts;
    for (TangentField& field :
         span_.has_material_directors() ? natural_fields(span_) : start_fields(span_)) {
      starts.emplace_back().field = std::move(field);
    }
    if (options_.all) return starts;
    const int coarse = coarse_terms();
    // What is looked at with the terms that it is left with need not be fitted twice.
    const bool keeps = coarse <= few_terms && span_.holds.empty() && span_.contacts.empty();
    const std::shared_ptr<SpanEnergy> model =
        workspace_.model(span_, keeps ? coarse : std::max(8, std::min(natural_terms_, coarse)));
    spent_ += rank_starts(
        starts, {.model = model,
                 .load = load_,
                 .followed = followed(),
                 .keeps_unknowns = model->terms() == coarse_terms(),
                 .stiffness = stiffness_,
                 .meets_grips = model->constraints() > 0 && !taut_ &&
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
    if (!options_.all && std::none_of(found.begin(), found.end(), is_saddle)) return;
    Span space = span_;
    space.planar = false;
    SearchLog own;
    SpanOptions options = options_;
    if (options_.log != nullptr) options.log = &own;
    int first = 0;
    for (SpanSolution& solution : Search(space, options, workspace_).run()) {
      if (add(std::move(solution), found)) ++first;
    }
    if (options_.log == nullptr) return;
    options_.log->tried(out_of_plane, own.starts());
    options_.log->found(out_of_plane, first);
    for (const std::string& what : own.not_looked()) options_.log->leave_out(what);
  }

  /// Those of a ranked start.
  [[nodiscard]] static Eigen::VectorXd unknowns_of(const Start& start, SpanEnergy& model) {
    Eigen::VectorXd x = model.adopt(*start.model, start.x);
    model.wind_to(x);
    return x;
  }

  /// From a field to an equilibrium, with as many terms as it takes to meet the grips.
  [[nodiscard]] SpanSolution from_start(const Start& from) {
    SpanSolution solution;
    int spent = 0;
    for (int count = coarse_terms();; count *= 2) {
      solution = empty_solution(std::min(count, max_terms));
      solution.x = from.model ? unknowns_of(from, *solution.model)
                              : solution.model->fit(from.field(solution.model->nodes()));
      const Eigen::VectorXd start = solution.x;
      // Where the rod is taut such a start is near to the shape already.
      const bool is_near = taut_ && !solution.model->has_soft_obstacles();
      if (is_near) workspace_.newton().polish(solution, load_);
      if (falls_by_newton(solution)) return solution;
      if (!is_near || (!solution.is_equilibrium() && !out_of_time())) {
        solution.x = start;
        solution.multipliers.resize(0);
        descend(solution);
      }
      if (solution.model->constraints() > 0 && !solution.is_equilibrium() &&
          !solution.model->has_soft_obstacles()) {
        solution.x = start;
        solution.multipliers.resize(0);
        pull_to_grips(solution);
      }
      spent += solution.evaluations;
      solution.evaluations = spent;
      const bool plain =
          solution.model->constraints() == 0 && !solution.model->has_soft_obstacles();
      if (solution.is_equilibrium() || plain) return solution;
      const bool more = 2 * solution.model->size() <= most_descended && options_.terms == 0;
      if (!more || out_of_time()) return solution;
    }
  }

  /// Newton's method at once, of a rod that one clamp holds. @return whether it has led from
  /// solution.x down to a minimum nearby
  [[nodiscard]] bool falls_by_newton(SpanSolution& solution) {
    constexpr double far = 2;  // of strains, as much as Newton's method goes in one step
    SpanEnergy& model = *solution.model;
    if (options_.all || !span_.start_direction || span_.has_material_directors() ||
        span_.is_plain_cantilever() || model.constraints() > 0 || model.has_soft_obstacles()) {
      return false;
    }
    const Eigen::VectorXd start = solution.x;
    Eigen::VectorXd gradient(model.size());
    const double energy = model.value(start, gradient);
    if (solution.terms < terms()) {
      workspace_.newton().polish_roughly(solution, load_);
    } else {
      workspace_.newton().polish(solution, load_);
    }
    if (succeeded(solution.status) && solution.energy <= energy &&
        (solution.x - start).norm() < far && solution.evaluations <= options_.max_evaluations) {
      return true;
    }
    solution.x = start;
    return false;
  }

  /// By springs at the grips that become stiffer, then Newton's method.
  void pull_to_grips(SpanSolution& solution) {
    descend_by_penalty(solution,
                       {.load = load_, .deadline = &options_.deadline, .stiffness = stiffness_});
    if (succeeded(solution.status)) workspace_.newton().polish(solution, load_);
  }

  /// The same, and of a shape that is followed (SpanOptions::known) to where it falls from a
  /// saddle.
  [[nodiscard]] SpanSolution from_given_start_to_rest() {
    SpanSolution solution = finish(from_given_start());
    solution.followed = came_by_newton_;
    if (!options_.known.model || options_.only_known || solution.status != SolveStatus::saddle)
      return solution;
    std::optional<SpanSolution> lower = leave_saddle(solution);
    if (!lower) return solution;
    certify(*lower, load_, workspace_.newton());
    lower->evaluations += solution.evaluations;
    return succeeded(lower->status) ? std::move(*lower) : std::move(solution);
  }

  /// From the caller's own start.
  [[nodiscard]] SpanSolution from_given_start() {
    const bool follow = options_.approach == Approach::follow;
    SpanSolution solution = follow ? near_field(options_.start) : from_start(Start{options_.start});
    came_by_newton_ = follow && options_.known.model != nullptr && solution.is_equilibrium() &&
                      is_near_start(solution);
    if (succeeded(solution.status) && (came_by_newton_ || !options_.known.model)) return solution;
    if (options_.only_known) return solution;
    const int spent = solution.evaluations;
    if (std::optional<SpanSolution> graded = graded_start()) {
      graded->evaluations += spent;
      return std::move(*graded);
    }
    solution = follow ? from_start(Start{options_.start}) : near_field(options_.start);
    solution.evaluations += spent;
    return solution;
  }

  [[nodiscard]] bool is_near_start(const SpanSolution& solution) const {
    const Eigen::Matrix3Xd start = options_.start(solution.model->nodes()).tangents;
    return (solution.model->tangents() - start).cwiseAbs().maxCoeff() < followed_tangents;
  }

  [[nodiscard]] SpanSolution near_field(const TangentField& field) {
    SpanSolution solution = empty_solution(terms());
    const StartShape wanted = field(solution.model->nodes());
    Newton& newton = workspace_.newton();
    if (!adopt_known(wanted, solution)) {
      solution.x = solution.model->fit(wanted);
      newton.polish(solution, load_);
    } else if (newton.has_factor_of(options_.known.model.get())) {
      solution.multipliers =
          solution.model->adopt_multipliers(*options_.known.model, options_.known.multipliers);
      newton.polish_from_neighbour(solution, load_);
    } else {
      newton.polish(solution, load_);
    }
    return solution;
  }

  /// In space a rod that is straight by nature has next to the same strains where its grips have
  /// hardly moved, unless the frame of its start has turned about it. @return whether they give the
  /// tangents that are wanted
  [[nodiscard]] bool adopt_known(const StartShape& wanted, SpanSolution& solution) const {
    constexpr double near = 0.2;  // of tangents
    const KnownShape& known = options_.known;
    SpanEnergy& model = *solution.model;
    if (!known.model || span_.planar || span_.has_material_directors()) return false;
    if (known.model->span().planar || known.model->pieces() != model.pieces()) return false;
    if (known.model->span().cuts != span_.cuts) return false;
    solution.x = model.adopt(*known.model, known.x);
    Eigen::VectorXd gradient(model.size());
    (void)model.value(solution.x, gradient);
    return (model.tangents() - wanted.tangents).cwiseAbs().maxCoeff() < near;
  }

  /// NLopt from solution.x, then Newton.
  void descend(SpanSolution& solution) {
    minimise(solution);
    if (!succeeded(solution.status)) return;
    // A cantilever is polished once it has all its terms.
    if (span_.is_plain_cantilever() && solution.terms < terms()) return;
    if (solution.terms < terms()) {
      polish_before_more_terms(solution);
    } else {
      workspace_.newton().polish(solution, load_);
    }
  }

  void polish_before_more_terms(SpanSolution& solution) {
    if (options_.all || options_.terms > 0 || solution.model->constraints() == 0) {
      workspace_.newton().polish(solution, load_);
    } else {
      workspace_.newton().polish_roughly(solution, load_);
    }
  }

  void minimise(SpanSolution& solution) const {
    SpanEnergy& model = *solution.model;
    if (model.constraints() > 0) {
      descend_in_trust_region(solution, {.load = load_,
                                         .gradient_tolerance = handover_gradient,
                                         .nearest = handover_step,
                                         .deadline = &options_.deadline});
      return;
    }
    const Objective objective = [&model](const Eigen::Ref<const Eigen::VectorXd>& x,
                                         Eigen::Ref<Eigen::VectorXd> gradient) {
      return model.value(x, gradient);
    };
    const MinimiseResult result = minimise_lbfgs(
        objective, solution.x, {handover_gradient * (1 + load_), options_.max_evaluations});
    solution.evaluations += result.evaluations;
    // Newton's method has to prove the shape anyway.
    solution.status = result.is_a_start() ? SolveStatus::roundoff_limited : result.status;
    solution.message = result.message;
  }

  /// Raises the number of terms until the last ones do not matter any more.
  [[nodiscard]] SpanSolution refined(SpanSolution solution) {
    const int fields = span_.planar ? 1 : span_.has_material_directors() ? 3 : 2;
    const int unknowns = graded_ ? most_graded_unknowns : most_unknowns;
    const bool touches = !span_.contacts.empty();
    // Contacts cut the rod into short pieces; it still may take the terms of its load.
    const int least = touches ? std::max(32, terms()) : 32;
    const int affordable = std::max(least, unknowns / (fields * solution.model->pieces()));
    // Soft obstacles make kinks inside pieces, where contact begins; more terms help only so far.
    constexpr int most_with_soft_obstacles = 64;
    const int most_terms =
        std::min(affordable, span_.soft_obstacles.empty() ? max_terms : most_with_soft_obstacles);
    Tail before;
    bool polished = false;
    while (solution.is_equilibrium()) {
      solution.resolved = options_.terms > 0 || resolved(solution);
      if (solution.resolved && solution.next_step > coarsest_step && !polished) {
        workspace_.newton().polish(solution, load_);
        polished = true;
        continue;
      }
      if (solution.resolved) break;
      if (out_of_time()) {
        solution.finish(SolveStatus::time_limit);
        break;
      }
      if (solution.terms >= most_terms) {
        solution.resolved = !span_.soft_obstacles.empty();
        if (solution.resolved) break;
        if (std::optional<SpanSolution> graded = graded_anew(solution)) return std::move(*graded);
        solution.fail(solution.too_few_terms());
        break;
      }
      const bool too_few = solution.terms < terms() && !touches;
      int more = too_few ? terms() : terms_by_decay(solution, before);
      // Grips may pull harder than weight and loads do.
      if (solution.multipliers.size() > 0 && !taut_ && !graded_) {
        more =
            std::max(more, first_terms(solution.multipliers.cwiseAbs().maxCoeff(), longest_piece_));
      }
      if (before.terms == 0) more = std::max(more, terms_by_own_decay(solution));
      before = {solution.terms, solution.model->tail(solution.x)};
      const bool hessian_known = workspace_.newton().has_factor_of(solution.model.get());
      solution = with_terms(solution, std::min(most_terms, more), hessian_known);
    }
    return solution;
  }

  /// The span with pieces that end where a shape wants it, unless they do so already.
  [[nodiscard]] std::optional<Span> graded_for(const SpanSolution& shape) const {
    const bool touches = !span_.rigid_obstacles.empty() || !span_.contacts.empty() ||
                         shape.model->has_soft_obstacles();
    if (graded_ || touches || span_.has_material_directors() || options_.terms > 0) {
      return std::nullopt;
    }
    Span span = shape.model->span();
    span.cuts = piece_cuts(shape);
    if (span.cuts.empty()) return std::nullopt;
    return span;
  }

  /// Where the terms that can be afforded do not resolve a shape, its pieces may end in the wrong
  /// places.
  [[nodiscard]] std::optional<SpanSolution> graded_anew(const SpanSolution& solution) {
    const std::optional<Span> span = graded_for(solution);
    if (!span) return std::nullopt;
    Search search(*span, options_, workspace_);
    SpanSolution finer = search.empty_solution(search.terms());
    const TangentField field = field_of(solution.model->shape(solution.x));
    finer.x = finer.model->fit(field(finer.model->nodes()));
    if (span->twist) {
      finer.x = finer.model->with_twist(finer.x, solution.model->twist(solution.x));
    }
    finer.multipliers = solution.multipliers;
    finer.evaluations = solution.evaluations;
    workspace_.newton().polish(finer, load_);
    finer = search.refined(std::move(finer));
    if (!finer.is_equilibrium()) return std::nullopt;
    return finer;
  }

  /// From a start next to which Newton's method has found nothing, with pieces for the start's own
  /// shape, downhill if need be.
  [[nodiscard]] std::optional<SpanSolution> graded_start() {
    if (options_.known.model || span_.holds.empty()) return std::nullopt;
    SpanSolution looked = empty_solution(max_terms);
    PointOnSpan point;
    point.x = looked.x = looked.model->fit(options_.start(looked.model->nodes()));
    evaluate(looked, point);
    looked.multipliers = point.jacobian.transpose().householderQr().solve(point.gradient);
    const std::optional<Span> span = graded_for(looked);
    if (!span) return std::nullopt;
    Search search(*span, options_, workspace_);
    SpanSolution solution = search.near_field(options_.start);
    const int spent = solution.evaluations;
    if (!solution.is_equilibrium()) {
      solution = search.empty_solution(search.terms());
      solution.x = solution.model->fit(options_.start(solution.model->nodes()));
      search.pull_to_grips(solution);
      solution.evaluations += spent;
    }
    solution = search.refined(std::move(solution));
    if (!solution.is_equilibrium()) return std::nullopt;
    return solution;
  }

  /// Last coefficients of a shape with so many terms.
  struct Tail {
    int terms = 0;
    double size = 0;
  };

  /// Terms with which the last ones of a first shape will be small enough, if they go on falling
  /// exponentially as its second half does, which is a little too few; as many as it has where they
  /// do not fall.
  [[nodiscard]] int terms_by_own_decay(const SpanSolution& solution) const {
    constexpr double reserve = 1.15;
    constexpr double falls = 0.5;
    const int K = solution.terms;
    const int half = K / 2;
    const double before = solution.model->tail(solution.x, half);
    const double now = solution.model->tail(solution.x);
    if (options_.terms > 0 || half < 2 || !(now > 0 && now < falls * before)) return K;
    const double rate = std::log(before / now) / (K - half);
    double all = K;
    // What is small enough grows with the terms.
    for (int i = 0; i < 2; ++i) {
      all = K + std::log(now / (options_.tolerance * 4 * all * all)) / rate;
      if (!(all > K)) return K;
    }
    return static_cast<int>(std::ceil(std::min(reserve * all, 1.0 * max_terms)));
  }

  /// Terms with which the last ones will be small enough, if they go on falling
  /// exponentially as from those before; a quarter more where nothing is known.
  [[nodiscard]] int terms_by_decay(const SpanSolution& solution, const Tail& before) const {
    const int K = solution.terms;
    const double now = solution.model->tail(solution.x);
    const double wanted = options_.tolerance * 4 * K * K;
    int more = std::max(2, K / 4);
    if (before.terms > 0 && now < before.size && now > wanted) {
      const double rate = std::log(before.size / now) / (K - before.terms);
      more = std::clamp(static_cast<int>(std::ceil(std::log(now / wanted) / rate)), 2, 2 * more);
    }
    return K + more;
  }

  [[nodiscard]] SpanSolution with_terms(const SpanSolution& solution, int terms,
                                        bool hessian_known) {
    SpanSolution finer = empty_solution(terms);
    finer.x = finer.model->adopt(*solution.model, solution.x);
    finer.multipliers = finer.model->adopt_multipliers(*solution.model, solution.multipliers);
    if (hessian_known) {
      workspace_.newton().polish_with_more_terms(finer, solution, load_);
    } else {
      workspace_.newton().polish(finer, load_);
    }
    const bool descends = finer.model->size() <= most_descended;
    if (descends && (!finer.is_equilibrium() || finer.model->has_soft_obstacles())) descend(finer);
    if (!finer.is_equilibrium() && !finer.model->has_soft_obstacles()) {
      finer.x = finer.model->adopt(*solution.model, solution.x);
      finer.multipliers = finer.model->adopt_multipliers(*solution.model, solution.multipliers);
      pull_to_grips(finer);
    }
    finer.evaluations += solution.evaluations;
    return finer;
  }

  [[nodiscard]] bool resolved(const SpanSolution& solution) {
    if (span_.is_plain_cantilever() && solution.terms < terms()) return false;
    if (span_.twist && solution.terms < terms_under_twist(solution)) return false;
    const double K = solution.terms;
    // The angle that the last coefficient adds is a_K / (2K); positions feel it as little again.
    if (solution.model->tail(solution.x) > options_.tolerance * 4 * K * K) return false;
    if (span_.is_plain_cantilever() || !span_.soft_obstacles.empty()) return true;
    return holds_with_more_terms(solution);
  }

  /// Whether gradient and gaps of the shape are as small in half as many terms more, with the
  /// quadrature of these: frames in space are integrated the better the more terms there are, and a
  /// gap moves the shape by as much.
  [[nodiscard]] bool holds_with_more_terms(const SpanSolution& solution) {
    const std::shared_ptr<SpanEnergy> model =
        workspace_.model(span_, std::min(max_terms, 3 * solution.terms / 2));
    const Eigen::VectorXd x = model->adopt(*solution.model, solution.x);
    Eigen::VectorXd gradient(model->size());
    (void)model->value(x, gradient);
    Eigen::VectorXd residual(model->constraints());
    Eigen::MatrixXd jacobian(model->constraints(), model->size());
    model->constraint(residual, jacobian);
    gradient -=
        jacobian.transpose() * model->adopt_multipliers(*solution.model, solution.multipliers);
    return gradient.norm() < largest_residual * (1 + load_) &&
           residual.norm() < largest_gap * options_.tolerance;
  }

  /// Next to a fold what the terms left out push decides whether there is a shape, and elsewhere it
  /// may be most of the error that is told: then it is asked once more, with half as many terms
  /// more.
  void judge(SpanSolution& solution) {
    certify(solution, load_, workspace_.newton());
    const bool asks = solution.status == SolveStatus::near_singular ||
                      (counts(solution) && solution.error > largest_told_error);
    const int more = std::min(max_terms, 3 * solution.terms / 2);
    const Span& own = solution.model->span();
    const int fields = own.planar ? 1 : own.has_material_directors() ? 3 : 2;
    if (!asks || options_.terms > 0 || out_of_time() ||
        more * fields * solution.model->pieces() > most_unknowns) {
      return;
    }
    SpanSolution finer;
    // The shape may have left the plane, or the span's own pieces.
    finer.model = workspace_.model(own, more);
    finer.terms = more;
    finer.x = finer.model->adopt(*solution.model, solution.x);
    finer.multipliers = finer.model->adopt_multipliers(*solution.model, solution.multipliers);
    workspace_.newton().polish(finer, load_);
    // Of what Newton's method left open before nobody has asked whether its terms resolve it.
    if (!solution.resolved) finer = Search(own, options_, workspace_).refined(std::move(finer));
    finer.resolved = finer.resolved || solution.resolved;
    certify(finer, load_, workspace_.newton());
    spent_ += finer.evaluations;
    const int evaluations = solution.evaluations + finer.evaluations;
    if (finer.error < solution.error) solution = std::move(finer);
    solution.evaluations = evaluations;
  }

  /// Keeps an equilibrium that is not known yet, or the first failure until there is one.
  /// @return whether it is such an equilibrium
  bool add(SpanSolution solution, std::vector<SpanSolution>& found) {
    spent_ += solution.evaluations;
    judge(solution);
    if (!counts(solution)) {
      if (found.empty()) found.push_back(std::move(solution));
      return false;
    }
    if (!found.empty() && !counts(found.front())) found.clear();
    if (is_known(solution, found)) return false;
    found.push_back(std::move(solution));
    return true;
  }

  /// Among all equilibria those that a fold or a bifurcation leaves open count too.
  [[nodiscard]] bool counts(const SpanSolution& solution) const {
    return solution.is_equilibrium() || (options_.all && solution.is_left_open());
  }

  [[nodiscard]] bool is_known(const SpanSolution& solution, const std::vector<SpanSolution>& found,
                              double tolerance = same_points) const {
    return std::any_of(found.begin(), found.end(), [&](const SpanSolution& other) {
      return counts(other) && is_same_shape(solution, other, tolerance);
    });
  }

  /// Descends from the unstable equilibria, once more from those that it leads to.
  void leave_saddles(std::vector<SpanSolution>& found) {
    for (; left_ < found.size() && left_ < most_saddles && !out_of_time(); ++left_) {
      if (!options_.all && has_stable_lowest(found)) return;
      if (found[left_].status != SolveStatus::saddle) continue;
      std::optional<SpanSolution> lower = leave_saddle(found[left_]);
      if (lower) note(left_downhill, add(std::move(*lower), found));
    }
  }

  /// Between two minima there is a pass, and a saddle on it: by Newton's method from where the
  /// unknowns of two equilibria are joined.
  void look_between(std::vector<SpanSolution>& found) {
    constexpr std::array<double, 5> shares = {0.2, 0.3, 0.5, 0.7, 0.8};
    for (std::size_t j = 1; j < found.size() && j < most_joined; ++j) {
      for (std::size_t i = 0; i < j && !out_of_time(); ++i) {
        const SpanSolution a = found[i];
        const SpanSolution b = found[j];
        const Span& span = a.model->span();
        if (span.planar != b.model->span().planar || span.cuts != b.model->span().cuts) continue;
        Search search(span, options_, workspace_);
        for (const double share : shares) {
          SpanSolution between = search.empty_solution(std::max(a.terms, b.terms));
          SpanEnergy& model = *between.model;
          between.x = (1 - share) * model.adopt(*a.model, a.x);
          between.x += share * model.adopt(*b.model, b.x);
          between.multipliers = (1 - share) * model.adopt_multipliers(*a.model, a.multipliers) +
                                share * model.adopt_multipliers(*b.model, b.multipliers);
          workspace_.newton().polish(between, load_);
          note(between_found, add(search.refined(std::move(between)), found));
        }
      }
    }
    if (options_.log != nullptr && found.size() > most_joined) {
      options_.log->leave_out("what lies between the equilibria found, but for the first " +
                              std::to_string(most_joined));
    }
  }

  /// At a fold two equilibria come from one, and lie on both sides of it along its softest
  /// direction: by Newton's method from beside those found, also those found that way.
  void look_beside(std::vector<SpanSolution>& found) {
    constexpr std::array<double, 6> steps = {0.5, -0.5, 1, -1, 2, -2};
    std::size_t i = 0;
    for (; i < found.size() && i < most_saddles && !out_of_time(); ++i) {
      if (!counts(found[i])) continue;
      const std::shared_ptr<SpanEnergy> model = found[i].model;
      const Eigen::VectorXd x = found[i].x;
      const Eigen::VectorXd multipliers = found[i].multipliers;
      const std::optional<Eigen::VectorXd> softest = softest_of(found[i]);
      if (!softest) continue;
      Search search(model->span(), options_, workspace_);
      for (const double step : steps) {
        SpanSolution beside = search.empty_solution(model->terms());
        beside.x = beside.model->adopt(*model, x) + step * *softest;
        beside.multipliers = beside.model->adopt_multipliers(*model, multipliers);
        workspace_.newton().polish(beside, load_);
        note(beside_found, add(search.refined(std::move(beside)), found));
      }
    }
    if (options_.log == nullptr || i >= found.size()) return;
    options_.log->leave_out("what lies beside the equilibria found, but for the first " +
                            std::to_string(i));
  }

  /// Unit vector along the eigenvalue of the projected second variation that is nearest to zero,
  /// free turns left aside; none if the constraints leave no other.
  [[nodiscard]] static std::optional<Eigen::VectorXd> softest_of(const SpanSolution& solution) {
    SpanEnergy& model = *solution.model;
    Eigen::VectorXd gradient(model.size());
    (void)model.value(solution.x, gradient);
    Eigen::VectorXd residual(model.constraints());
    Eigen::MatrixXd jacobian(model.constraints(), model.size());
    model.constraint(residual, jacobian);
    Eigen::MatrixXd hessian;
    model.hessian(solution.multipliers, hessian);
    FreeHessian on_free_directions;
    on_free_directions.compute(hessian, jacobian);
    const Eigen::Index free = free_turns(model.span(), model.tangents()).in_plane;
    if (free >= model.size() - model.constraints()) return std::nullopt;
    return direction_by_size(on_free_directions, free);
  }

  /// Where an equilibrium that cannot hold itself comes to rest; out of its plane if that is the
  /// only way in which it gives way.
  [[nodiscard]] std::optional<SpanSolution> leave_saddle(const SpanSolution& solution) {
    constexpr double push = 0.5;
    const std::optional<WayDown> way = way_down(solution);
    if (!way) return std::nullopt;
    return pushed_from(way->span, solution, push * way->along);
  }

  [[nodiscard]] SpanSolution pushed_from(const Span& span, const SpanSolution& solution,
                                         const Eigen::VectorXd& disturbance) {
    Search search(span, options_, workspace_);
    const std::shared_ptr<SpanEnergy> model = workspace_.model(span, solution.terms);
    const Eigen::VectorXd pushed = model->adopt(*solution.model, solution.x) + disturbance;
    SpanSolution lower = search.empty_solution(std::min(solution.terms, search.coarse_terms()));
    lower.x = lower.model->adopt(*model, pushed);
    search.descend(lower);
    return search.refined(std::move(lower));
  }

  [[nodiscard]] std::vector<SpanSolution> sorted(std::vector<SpanSolution> found) {
    std::stable_sort(found.begin(), found.end(), [](const SpanSolution& a, const SpanSolution& b) {
      const bool a_stable = succeeded(a.status);
      const bool b_stable = succeeded(b.status);
      if (a_stable != b_stable) return a_stable;
      return a.energy < b.energy;
    });
    if (found.empty()) {
      found.push_back(empty_solution(terms()));
      found.back().x.setZero(found.back().model->size());
      found.back().multipliers.setZero(found.back().model->constraints());
      found.back().finish(SolveStatus::time_limit);
    }
    found.front().evaluations = spent_;
    if (!options_.all) found.resize(1);
    return found;
  }

  const Span& span_;
  const SpanOptions& options_;
  SpanWorkspace& workspace_;
  double load_;
  bool graded_;  // pieces end where a shape that is known wants it
  double longest_piece_ = 0;
  int natural_terms_ = 0;  // that the free rod's own strains take
  bool taut_ = false;      // pieces end where the layers at taut segments' ends have decayed
  double stiffness_ = 0;   // of the tautest segment along its chord
  // Of the last equilibrium that was refined, and by how much its energy fell.
  double lowest_coarse_ = infinite;
  double fall_ = 0;
  int spent_ = 0;         // evaluations of everything that was looked at
  std::size_t left_ = 0;  // how many of the equilibria found have been looked at for a way down
  bool came_by_newton_ = false;  // from the known shape to one next to it
};

}  // namespace

std::shared_ptr<SpanEnergy> SpanWorkspace::model(const Span& span, int terms) {
  const auto is_unused = [](const auto& model) { return model.use_count() == 1; };
  auto unused = std::find_if(models_.begin(), models_.end(), [&](const auto& model) {
    return is_unused(model) && model->terms() == terms;
  });
  // Another one has buffers of another size.
  if (unused == models_.end() && models_.size() >= most_kept_models) {
    unused = std::find_if(models_.begin(), models_.end(), is_unused);
  }
  if (unused != models_.end()) {
    (*unused)->reset(span, terms);
    return *unused;
  }
  models_.push_back(std::make_shared<SpanEnergy>(span, terms));
  return models_.back();
}

bool is_same_shape(const SpanSolution& a, const SpanSolution& b, double tolerance) {
  const Span& span = a.model->span();
  if (std::abs(a.energy - b.energy) > 1e-2 * tolerance * (1 + span.total_load())) return false;
  // Without softer parts points differ by less than strains do.
  if (a.model->size() == b.model->size() && a.terms == b.terms && span.parts.empty() &&
      span.planar == b.model->span().planar && span.cuts == b.model->span().cuts &&
      (a.x - b.x).norm() < tolerance * span.length) {
    return true;
  }
  const std::vector<double> s = {0.3 * span.length, 0.6 * span.length, span.length};
  const Eigen::Matrix3Xd of_a = a.model->shape(a.x).sample(s).points;
  const Eigen::Matrix3Xd of_b = b.model->shape(b.x).sample(s).points;
  if ((of_a - of_b).norm() < tolerance * span.length) return true;
  const bool planar = span.planar && b.model->span().planar;
  return !planar && is_turned_copy(span, of_a, of_b);
}

std::vector<SpanSolution> solve_span(const Span& span, const SpanOptions& options,
                                     SpanWorkspace& workspace) {
  return Search(span, options, workspace).run();
}

SpanSolution finish_span(const Span& span, const SpanOptions& options, SpanWorkspace& workspace,
                         SpanSolution solution) {
  return Search(span, options, workspace).finish(std::move(solution));
}

}  // namespace dlo::energy_model
