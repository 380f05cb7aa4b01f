#include "search/placed_span.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <utility>

#include "base/deadline.hpp"
#include "contact/penalty_polygon.hpp"
#include "dlo/energy_model/turns.hpp"
#include "kirchhoff/relaxed_polygon.hpp"
#include "kirchhoff/rod_mesh.hpp"
#include "kirchhoff/rod_span.hpp"
#include "search/active_set.hpp"
#include "search/contact_search.hpp"
#include "search/known_shape.hpp"
#include "search/twist_path.hpp"
#include "span/found.hpp"
#include "span/span_solver.hpp"

namespace dlo::energy_model {
namespace {

constexpr std::size_t most_fields = 12;

/// Maximum number of intervals of a polygon that is relaxed again.
constexpr double most_field_intervals = 600;

Eigen::VectorXd midpoints(const RodMesh& mesh) {
  const Eigen::Index count = mesh.intervals();
  return (mesh.s.head(count) + mesh.s.tail(count)) / 2;
}

constexpr const char* from_polygons = "lowest minima of coarse polygons, by Newton's method";

std::vector<SpanSolution> search_untwisted(const Span& span, const SpanOptions& options,
                                           SpanWorkspace& workspace) {
  // A polygon stays on the side of an obstacle on which a given shape is; a descent may step over
  // the obstacle.
  const bool by_polygon = options.only_descends() && !span.soft_obstacles.empty();
  const auto solver =
      span.rigid_obstacles.empty() && !by_polygon ? solve_span : solve_touching_span;
  return solver(span, options, workspace);
}

/// Largest component of a tangent out of the plane [-] for scattered points of a rod in a plane.
/// The certificate shows whether the equilibrium near such points is unstable out of the plane; it
/// is then left in space.
constexpr double tilt_of_points = 0.1;

/// Whether a shape leaves the plane of its span.
bool is_out_of_plane(const Span& span, const TangentField& shape, double largest_tilt) {
  const Eigen::VectorXd s = Eigen::VectorXd::LinSpaced(17, 0, span.length);
  return !(shape(s).tangents.row(2).cwiseAbs().maxCoeff() < largest_tilt);
}

/// Whether there is an obstacle that the rod may pass on another side.
bool has_passable_obstacle(const Span& span) {
  const auto is_body = [](const Span::Obstacle& obstacle) {
    return !obstacle.body.is_half_space();
  };
  return std::ranges::any_of(span.rigid_obstacles, is_body) ||
         std::ranges::any_of(span.soft_obstacles, is_body);
}

/// Solves for the single equilibrium near SpanOptions::start.
SpanSolution from_start(const Span& span, SpanOptions options, SpanWorkspace& workspace) {
  options.log = nullptr;
  return std::move(search_untwisted(span, options, workspace).front());
}

/// The lowest minima of a coarse polygon, lowest first: the initial guesses of solve_exact(). For a
/// planar span they include minima in its plane and out of it. There are none if clamps transmit a
/// torque, which the polygon does not model.
class PolygonFields {
 public:
  PolygonFields(const Problem& problem, const PlacedSpan& placed, const Deadline& deadline)
      : deadline_(deadline), reversed_(placed.reversed), frame_(placed.frame) {
    const auto is_clamp = [](const Span::Hold& hold) { return hold.direction.has_value(); };
    if (std::ranges::any_of(placed.span.holds, is_clamp)) return;
    const double begin = placed.reversed ? placed.start / problem.length - placed.span.length
                                         : placed.start / problem.length;
    const std::vector<RodSpan> spans = cut_at_clamps(problem);
    span_ = *std::ranges::min_element(
        spans, {}, [&](const RodSpan& span) { return std::abs(span.begin - begin); });
    // Resolves boundary layers of the loads, but no more than a coarse polygon needs.
    const double load = std::min(total_load(*span_), 1e4);
    longest_ = std::min(span_->length / 16, 1 / std::sqrt(std::max(load, 1.0)));
    const RodMesh mesh = make_mesh(*span_, longest_);
    minima_ = polygon_minima(*span_, mesh, deadline).found;
    if (minima_.size() > most_fields) minima_.resize(most_fields);
  }

  [[nodiscard]] std::size_t size() const { return minima_.size(); }
  /// Returns the tangents of one minimum, in the span's frame. If the grips' forces bend it within
  /// less than a segment, it is first relaxed with shorter segments.
  [[nodiscard]] TangentField field(std::size_t index) const {
    const RelaxedPolygon& minimum = minima_[index];
    const RodMesh mesh = make_mesh(*span_, longest_);
    Eigen::VectorXd middles = midpoints(mesh);
    Eigen::Matrix3Xd tangents = minimum.tangents();
    const double force =
        minimum.force.colwise().norm().maxCoeff() / least_bending_stiffness(*span_);
    const double resolving =
        std::max(1 / std::sqrt(std::max(force, 1.0)), span_->length / most_field_intervals);
    if (longest_ > 1.1 * resolving) {
      const RodMesh finer = make_mesh(*span_, resolving);
      middles = midpoints(finer);
      tangents = relax_on_mesh(*span_, finer, mesh, minimum, deadline_).tangents();
    }
    return [middles = std::move(middles), tangents = std::move(tangents), length = span_->length,
            reversed = reversed_, frame = frame_](const Eigen::VectorXd& s) {
      Eigen::Matrix3Xd result(3, s.size());
      for (Eigen::Index q = 0; q < s.size(); ++q) {
        const double at = reversed ? length - s[q] : s[q];
        const Eigen::Vector3d t = frame * tangent_between(middles, tangents, at);
        result.col(q) = reversed ? Eigen::Vector3d(-t) : t;
      }
      return result;
    };
  }

 private:
  Deadline deadline_;
  bool reversed_;
  Eigen::Matrix3d frame_;
  std::optional<RodSpan> span_;
  double longest_ = 0;  // length of the longest interval of the mesh
  std::vector<RelaxedPolygon> minima_;
};

/// Adds the equilibria found from minima of a coarse polygon, in the plane and out of it.
void add_polygon_minima(const PlacedSpan& placed, const Problem& problem, SpanOptions options,
                        SpanWorkspace& workspace, Found& found) {
  if (!problem.obstacles.empty()) {
    log_omitted(options.log, "minima of coarse polygons, which ignore obstacles");
    return;
  }
  const PolygonFields fields(problem, placed, options.deadline);
  for (std::size_t i = 0; i < fields.size(); ++i) {
    if (omits_late_starts(options)) return;
    // A minimum of the polygon is near one of the rod; with too few coefficients the solver could
    // converge elsewhere.
    options.start = {fields.field(i)};
    Span span = placed.span;
    const bool is_out =
        span.planar && is_out_of_plane(span, options.start.field, planar_tangent_tolerance);
    if (is_out && span.stays_in_plane()) continue;
    span.planar = span.planar && !is_out;
    (void)found.add(from_start(span, options, workspace), from_polygons);
    if (found.suffices()) return;
  }
}

/// Largest rotation of a clamp at once that may stay on the same branch [rad].
constexpr double largest_followed_rotation = 1;

constexpr const char* rotated_in_small_steps =
    "stable shapes without twist, rotated in small steps";

class TwistedSpan {
 public:
  TwistedSpan(const PlacedSpan& placed, const Problem& problem, const SpanOptions& options,
              SpanWorkspace& workspace)
      : placed_(placed),
        problem_(problem),
        options_(options),
        workspace_(workspace),
        held_(*placed.frames) {}

  /// Returns std::nullopt if the known shape has no twist of this span or other turns than are
  /// prescribed (with material directors: another homotopy class), or if no equilibrium is found.
  [[nodiscard]] std::optional<SpanSolution> from_known(const Equilibrium& start) const {
    const double l = problem_.length;
    const TwistedPart* part = known_twist(start, placed_, l);
    if (part == nullptr) return std::nullopt;
    const auto lost =
        missing_turns(held_.turns, part->angle, writhe(start.sample, part->begin, part->end));
    if (!lost || (*lost != 0 && !placed_.span.has_material_directors())) return std::nullopt;
    SpanSolution solution = solve_near_twisted(
        field_of(start, placed_, l), {prescribed_end_d1(held_, placed_.span), part->angle},
        known_contacts(start, placed_, l));
    if (!solution.is_known()) return std::nullopt;
    return solution;
  }

  /// Solves from a shape without a known twist: relaxes a polygon with the prescribed turns from
  /// it (not for a rod with material directors), then runs Newton's method.
  [[nodiscard]] SpanSolution relax_from(const Equilibrium& shape) const {
    const TangentField field = field_of(shape, placed_, problem_.length);
    Span span = placed_.span;
    span.planar = false;
    SpanSolution guess = workspace_.empty_solution(span, unknown_terms);
    guess.x = guess.model->fit(field(guess.model->nodes()));
    EndFrame frame = end_frame_for(guess);
    if (span.has_material_directors()) {
      frame.twist += guess.model->twist(guess.x);
      return solve_near_twisted(field, frame, {});
    }
    span.twist = Span::Twist{held_.stiffness, frame.d1};
    const PenaltyPolygon polygon = relax_on_obstacles(
        span,
        [&](const Eigen::VectorXd& s) {
          StartShape start = field(s);
          start.twist = frame.twist;
          return start;
        },
        Segments::all, options_.deadline, Descent::near);
    frame.twist = polygon.twist;
    SpanSolution solution = solve_near_twisted(polygon.field(), frame, polygon.contacts);
    solution.evaluations += polygon.evaluations;
    return solution;
  }

  [[nodiscard]] std::vector<SpanSolution> without_twist(const RememberedShape& last) const {
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

  [[nodiscard]] EndFrame end_frame_for(const SpanSolution& untwisted) const {
    return end_frame(held_, untwisted_shape(untwisted, workspace_));
  }

  /// Solves from the last twisted shape, rotated further.
  [[nodiscard]] SpanSolution followed(const Remembered& memory, double turned,
                                      const EndFrame& frame) const {
    SpanSolution solution =
        solve_near_twisted(memory.twisted.field(placed_), {frame.d1, memory.twist + turned},
                           memory.twisted.last.model->span().contacts);
    solution.followed = solution.is_known();
    return solution;
  }

  /// Rotates each stable shape without twist until it meets the frame. For a rod with material
  /// directors and no rigid obstacles, also adds results of a search with the prescribed frame.
  [[nodiscard]] std::vector<SpanSolution> turned(const std::vector<SpanSolution>& untwisted) const {
    Found found(options_);
    const HeldFrames held = frames_with_turns_of(untwisted.front());
    for (const SpanSolution& from : untwisted) {
      if (!succeeded(from.status)) continue;
      found.add_evaluations(from.evaluations);
      const UntwistedShape shape = untwisted_shape(from, workspace_);
      SpanSolution solution = twist_to(end_frame(held, shape), placed_.span, held.stiffness, shape,
                                       options_, workspace_);
      if (!belongs_to_class(solution, held.turns.turns)) solution.fail(no_equilibrium_of_class);
      (void)found.add(std::move(solution), rotated_in_small_steps);
    }
    if (placed_.span.has_material_directors() && placed_.span.rigid_obstacles.empty()) {
      search_with_frame(held, found);
    } else {
      log_omitted(options_.log,
                  "unstable twisted shapes, and those that no stable one is turned to");
    }
    return std::move(found).take();
  }

 private:
  /// Returns the prescribed frames. If their turns are unknown, they are counted from the best
  /// shape without twist.
  [[nodiscard]] HeldFrames frames_with_turns_of(const SpanSolution& best) const {
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
    span.twist = Span::Twist{held.stiffness, prescribed_end_d1(held, span), held.turns.turns};
    for (SpanSolution& solution : solve_span(span, options_, workspace_)) {
      (void)found.add(std::move(solution));
    }
  }

  /// Solves for the equilibrium near a known twisted shape.
  [[nodiscard]] SpanSolution solve_near_twisted(const TangentField& field, const EndFrame& frame,
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

void RememberedShape::store(const SpanSolution& found, const PlacedSpan& placed) {
  last = {};
  frame = placed.frame;
  if (!succeeded(found.status) && !found.is_singular_point()) return;
  last = {found.model, found.x, found.multipliers, found.factor};
  point = found.at_x();
}

TangentField RememberedShape::field(const PlacedSpan& placed) const {
  const Eigen::Matrix3d turn = placed.frame * frame.transpose();
  const bool rolls = placed.span.has_material_directors() && !planar();
  return [model = last.model, point = point, turn, rolls](const Eigen::VectorXd& s) {
    StartShape shape(turn * point->tangents());
    if (rolls) shape.roll = roll_of(point->tangents(), point->d1());
    const Eigen::VectorXd& nodes = model->nodes();
    if (s.size() == nodes.size() && s == nodes) return shape;
    StartShape nearest(Eigen::Matrix3Xd(3, s.size()), Eigen::VectorXd(rolls ? s.size() : 0));
    for (Eigen::Index q = 0; q < s.size(); ++q) {
      Eigen::Index at = 0;
      (nodes.array() - s[q]).abs().minCoeff(&at);
      nearest.tangents.col(q) = shape.tangents.col(at);
      if (rolls) nearest.roll[q] = shape.roll[at];
    }
    return nearest;
  };
}

std::vector<SpanSolution> solve_untwisted(const PlacedSpan& placed, const Problem& problem,
                                          SpanOptions options, const Equilibrium* shape,
                                          const RememberedShape& last, SpanWorkspace& workspace) {
  const bool is_known = shape == nullptr && last.is_known();
  Found found(options);
  // After a failure no shape is known.
  if (options.only_follows() && !is_known) return as_list({});
  const double tilt = options.only_descends() ? tilt_of_points : planar_tangent_tolerance;
  const bool leaves = placed.span.confined && shape != nullptr && !options.only_descends() &&
                      is_out_of_plane(placed.span, field_of(*shape, placed, problem.length), tilt);
  if (!options.wants_all() && (shape != nullptr || is_known) && !leaves) {
    Span span = placed.span;
    if (is_known) {
      options.start = {last.field(placed), options.start.approach, last.last};
      span.cuts = last.last.model->span().cuts;
      span.contact_ends = last.last.model->span().contact_ends;
    } else {
      options.start.field = field_of(*shape, placed, problem.length);
    }
    const bool may_leave = (shape != nullptr || !last.planar()) && !span.stays_in_plane();
    span.planar = span.planar && !(may_leave && is_out_of_plane(span, options.start.field, tilt));
    SpanSolution followed = from_start(span, options, workspace);
    const bool ends = !followed.is_known();
    // A failure means that the branch has ended or that the step was too large for it.
    found.add_evaluations(ends ? std::exchange(followed.evaluations, 0) : 0);
    if (!ends || options.only_follows() || options.only_descends()) {
      (void)found.add(std::move(followed));
      return std::move(found).take();
    }
  }
  options.start = {};
  for (SpanSolution& solution : search_untwisted(placed.span, options, workspace)) {
    (void)found.add(std::move(solution));
  }
  if (has_passable_obstacle(placed.span))
    search_past_obstacles(placed.span, options, workspace, found);
  const SolveStatus status = found.best().status;
  const bool at_limit =
      status == SolveStatus::evaluation_limit || status == SolveStatus::time_limit;
  if (options.wants_all() || !(succeeded(status) || at_limit)) {
    add_polygon_minima(placed, problem, options, workspace, found);
  }
  return std::move(found).take();
}

std::vector<SpanSolution> solve_twisted(const PlacedSpan& placed, const Problem& problem,
                                        const SpanOptions& options, const Equilibrium* start,
                                        Remembered& memory, SpanWorkspace& workspace) {
  const TwistedSpan span(placed, problem, options, workspace);
  if (options.only_descends()) return as_list(span.relax_from(*start));
  const bool follows = memory.twisted.is_known() && !options.wants_all();
  if (start != nullptr && !options.wants_all() && !follows) {
    if (std::optional<SpanSolution> known = span.from_known(*start)) {
      return as_list(std::move(*known));
    }
  }
  std::vector<SpanSolution> untwisted = span.without_twist(memory.untwisted);
  if (!options.wants_all()) untwisted.resize(1);
  SpanSolution& best = untwisted.front();
  memory.untwisted.store(best, placed);
  if (!succeeded(best.status)) {
    // An equilibrium of the rod without twist is none of the twisted rod.
    if (best.is_known()) best.fail("no stable shape without twist was found");
    return as_list(std::move(best));
  }
  const EndFrame frame = span.end_frame_for(best);
  const double turned = frame.twist - std::exchange(memory.turned, frame.twist);
  if (follows && std::abs(turned) < largest_followed_rotation) {
    SpanSolution followed = span.followed(memory, turned, frame);
    followed.evaluations += best.evaluations;
    if (followed.followed || options.only_follows()) return as_list(std::move(followed));
  }
  if (!options.only_follows()) return span.turned(untwisted);
  best.followed = false;
  return untwisted;
}

}  // namespace dlo::energy_model
