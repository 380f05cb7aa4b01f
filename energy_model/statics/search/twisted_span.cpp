#include "search/twisted_span.hpp"

#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "contact/penalty_polygon.hpp"
#include "dlo/energy_model/turns.hpp"
#include "search/active_set.hpp"
#include "search/known_shape.hpp"
#include "search/twist_path.hpp"
#include "search/untwisted_span.hpp"
#include "span/found.hpp"

namespace dlo::energy_model {
namespace {

/// Largest rotation of a clamp at once that may stay on the same branch [rad].
constexpr double largest_followed_turn = 1;

/// Number of coefficients for the writhe of a shape that is only a guess.
constexpr int terms_of_guess = 24;

constexpr const char* rotated_in_small_steps =
    "stable shapes without twist, rotated in small steps";

/// Whether a shape may be followed: an equilibrium, or a singular point.
bool is_known(const SpanSolution& solution) {
  return solution.is_equilibrium() || solution.is_singular_point();
}

class TwistedSpan {
 public:
  TwistedSpan(const PlacedSpan& placed, const Problem& problem, const SpanOptions& options,
              SpanWorkspace& workspace)
      : placed_(placed),
        problem_(problem),
        options_(options),
        workspace_(workspace),
        held_(*placed.frames) {}

  /// Returns std::nullopt if the known shape has other turns than are prescribed, or if no
  /// equilibrium is found from it.
  [[nodiscard]] std::optional<SpanSolution> from_known(const Equilibrium& start) const {
    const double l = problem_.length;
    const TwistedPart* part = known_twist(start, placed_, l);
    if (part == nullptr) return std::nullopt;
    const auto lost =
        turns_lost(held_.turns, part->angle, writhe(start.sample, part->begin, part->end));
    if (!lost || (*lost != 0 && !placed_.span.has_material_directors())) return std::nullopt;
    SpanSolution solution =
        next_to(field_of(start, placed_, l), {held_end_d1(held_, placed_.span), part->angle},
                known_contacts(start, placed_, l));
    if (!is_known(solution)) return std::nullopt;
    return solution;
  }

  /// Solves from a shape without a known twist: relaxes a polygon with the prescribed turns from
  /// it, then runs Newton's method.
  [[nodiscard]] SpanSolution downhill_of(const Equilibrium& shape) const {
    const TangentField field = field_of(shape, placed_, problem_.length);
    Span span = placed_.span;
    span.planar = false;
    SpanSolution guess = workspace_.empty_solution(span, terms_of_guess);
    guess.x = guess.model->fit(field(guess.model->nodes()));
    EndFrame frame = frame_for(guess);
    if (span.has_material_directors()) {
      frame.twist += guess.model->twist(guess.x);
      return next_to(field, frame, {});
    }
    span.twist = Span::Twist{held_.stiffness, frame.d1};
    const PenaltyPolygon polygon = rest_on_obstacles(
        span,
        [&](const Eigen::VectorXd& s) {
          StartShape start = field(s);
          start.twist = frame.twist;
          return start;
        },
        Segments::all, options_.deadline, Descent::near);
    frame.twist = polygon.twist;
    SpanSolution solution = next_to(polygon.field(), frame, polygon.contacts);
    solution.evaluations += polygon.evaluations;
    return solution;
  }

  [[nodiscard]] std::vector<SpanSolution> without_twist(const Remembered* last) const {
    SpanOptions options = options_;
    // The log counts the starts, but not the solutions, which are not equilibria of the twisted
    // rod.
    SearchLog log;
    if (options_.wants_all()) options.log = &log;
    std::vector<SpanSolution> found =
        solve_untwisted(placed_, problem_, options, nullptr, last, workspace_);
    if (options_.wants_all()) options_.log->add_starts(log, ", without twist");
    return found;
  }

  [[nodiscard]] EndFrame frame_for(const SpanSolution& untwisted) const {
    return end_frame(held_, untwisted_shape(untwisted, workspace_));
  }

  /// Solves from the last twisted shape, rotated further.
  [[nodiscard]] SpanSolution followed(const RememberedTwist& memory, double turned,
                                      const EndFrame& frame) const {
    SpanSolution solution =
        next_to(memory.twisted.field(placed_), {frame.d1, memory.twist + turned},
                memory.twisted.last.model->span().contacts);
    solution.followed = is_known(solution);
    return solution;
  }

  /// Rotates each stable shape without twist until it meets the frame. For a rod with material
  /// directors, also adds results of a search with the prescribed frame.
  [[nodiscard]] std::vector<SpanSolution> turned(const std::vector<SpanSolution>& untwisted) const {
    Found found(options_);
    const HeldFrames held = counted_from(untwisted.front());
    for (const SpanSolution& from : untwisted) {
      if (!succeeded(from.status)) continue;
      found.spend(from.evaluations);
      const UntwistedShape shape = untwisted_shape(from, workspace_);
      SpanSolution solution = twist_to(end_frame(held, shape), placed_.span, held.stiffness, shape,
                                       options_, workspace_);
      if (!is_of_class(solution, held.turns.turns)) solution.fail(no_equilibrium_of_class);
      (void)found.add(std::move(solution), rotated_in_small_steps);
    }
    if (placed_.span.has_material_directors() && placed_.span.rigid_obstacles.empty()) {
      search_with_frame(held, found);
    } else {
      note_omitted(options_.log,
                   "unstable twisted shapes, and those that no stable one is turned to");
    }
    return std::move(found).take();
  }

 private:
  /// Returns the prescribed frames. If their turns are unknown, they are counted from the best
  /// shape without twist.
  [[nodiscard]] HeldFrames counted_from(const SpanSolution& best) const {
    HeldFrames held = held_;
    if (held.turns.turns) return held;
    const UntwistedShape shape = untwisted_shape(best, workspace_);
    if (!shape.writhe) return held;
    held.turns.turns = (shape.twist + end_frame(held, shape).twist) / (2 * std::numbers::pi) +
                       shape.writhe->value.value_or(shape.writhe->modulo_two);
    return held;
  }

  /// Adds equilibria found from initial guesses whose frames meet the prescribed one.
  void search_with_frame(const HeldFrames& held, Found& found) const {
    Span span = placed_.span;
    span.planar = false;
    span.twist = Span::Twist{held.stiffness, held_end_d1(held, span), held.turns.turns};
    for (SpanSolution& solution : solve_span(span, options_, workspace_)) {
      (void)found.add(std::move(solution));
    }
  }

  /// Solves for the equilibrium near a known twisted shape.
  [[nodiscard]] SpanSolution next_to(const TangentField& field, const EndFrame& frame,
                                     std::vector<Span::Contact> contacts) const {
    Span span = placed_.span;
    if (auto moved = moved_contacts(span, std::move(contacts))) span.contacts = std::move(*moved);
    return twist_from(field, frame, span, held_.stiffness, options_, workspace_);
  }

  const PlacedSpan& placed_;
  const Problem& problem_;
  const SpanOptions& options_;
  SpanWorkspace& workspace_;
  const HeldFrames& held_;
};

}  // namespace

std::vector<SpanSolution> solve_twisted(const PlacedSpan& placed, const Problem& problem,
                                        const SpanOptions& options, const Equilibrium* start,
                                        RememberedTwist& memory, SpanWorkspace& workspace) {
  const TwistedSpan span(placed, problem, options, workspace);
  if (options.only_descends()) return list_of(span.downhill_of(*start));
  const bool follows = memory.twisted.is_known() && !options.wants_all();
  if (start != nullptr && !options.wants_all() && !follows) {
    if (std::optional<SpanSolution> known = span.from_known(*start)) {
      return list_of(std::move(*known));
    }
  }
  std::vector<SpanSolution> untwisted =
      span.without_twist(memory.untwisted.is_known() ? &memory.untwisted : nullptr);
  if (!options.wants_all()) untwisted.resize(1);
  SpanSolution& best = untwisted.front();
  memory.untwisted.remember(best, placed);
  if (!succeeded(best.status)) return untwisted;
  const EndFrame frame = span.frame_for(best);
  const double turned = frame.twist - std::exchange(memory.turned, frame.twist);
  if (follows && std::abs(turned) < largest_followed_turn) {
    SpanSolution followed = span.followed(memory, turned, frame);
    followed.evaluations += best.evaluations;
    if (followed.followed || options.only_follows()) return list_of(std::move(followed));
  }
  if (!options.only_follows()) return span.turned(untwisted);
  best.followed = false;
  return untwisted;
}

}  // namespace dlo::energy_model
