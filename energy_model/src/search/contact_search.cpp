#include "search/contact_search.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "certify/enough_terms.hpp"
#include "contact/clearance.hpp"
#include "contact/lift_off.hpp"
#include "contact/mend.hpp"
#include "contact/resting_polygon.hpp"
#include "newton/trust_region.hpp"
#include "search/free_boundary_newton.hpp"
#include "span/negative_curvature.hpp"
#include "span/refinement.hpp"
#include "span/same_shape.hpp"
#include "span/search_log.hpp"
#include "span/span_starts.hpp"

namespace dlo::energy_model {
namespace {

/// Shapes from which polygons come to rest: of one clamp, among them those past two bodies on
/// either side.
constexpr std::size_t most_starts = 3;
constexpr std::size_t most_starts_of_one_clamp = 6;
/// Times that the contacts are mended.
constexpr int most_rounds = 16;
/// Times that a shape is left which cannot hold itself.
constexpr int most_departures = 4;
/// Unknowns from which on half of the terms that a load takes are tried first.
constexpr int many_unknowns = 300;
/// A part that lies and is shorter, in lengths, may be a point instead: it is asked again whether
/// that is behind the obstacle.
constexpr double shortest_told = 1e-3;
/// Out of its plane a polygon has tangents with more than this across it.
constexpr double flat = 1e-6;
/// Of polygons with few segments those next to the lowest, over 1 + energy: their energies are off
/// by about this, since they cut the corners of bodies.
constexpr double near_lowest = 0.5;
/// Of polygons with all segments too, whose energies are off by up to 0.03 where they touch: both
/// are asked for the rod's own energy.
constexpr double near_tie_of_polygons = 0.06;
/// Polygons whose energies are this close, over 1 + energy, are the same.
constexpr double same_polygon = 1e-6;

constexpr const char* clear_of_obstacles = "shapes without obstacles that stay clear of them";
constexpr const char* polygons_at_rest = "polygons at rest on the obstacles";

class ContactSearch {
 public:
  ContactSearch(const Span& span, const SpanOptions& options, SpanWorkspace& workspace)
      : span_(span), options_(options), workspace_(workspace), load_(span.total_load()) {}

  [[nodiscard]] std::vector<SpanSolution> run() {
    std::vector<SpanSolution> found;
    if (options_.known.model && options_.start && !options_.wants_all()) {
      SpanSolution followed = follow();
      if (followed.is_equilibrium() || followed.is_singular_point() || options_.only_follows()) {
        found.push_back(std::move(followed));
      }
    }
    if (found.empty()) {
      if (options_.start && !options_.wants_all()) look_from({options_.start}, found);
      if (found.empty() || !succeeded(found.front().status)) search(found);
    }
    const int departures = options_.only_follows() ? 0 : most_departures;
    for (int i = 0; i < departures && found.front().status == SolveStatus::saddle; ++i) {
      const double energy = found.front().energy;
      leave(found);
      if (!(found.front().energy < energy)) break;
    }
    found.front().evaluations = spent_;
    if (!options_.wants_all()) found.resize(1);
    return found;
  }

 private:
  /// From a known shape with its contacts, which are mended as they change; no polygon.
  [[nodiscard]] SpanSolution follow() {
    const KnownShape& known = options_.known;
    Span span = span_;
    span.planar = span_.planar && known.model->span().planar;
    span.contacts = known.model->span().contacts;
    for (Span::Contact& contact : span.contacts) {
      const auto moved = std::find_if(
          span.rigid_obstacles.begin(), span.rigid_obstacles.end(),
          [&](const Span::Obstacle& other) { return other.index == contact.obstacle.index; });
      if (moved == span.rigid_obstacles.end()) return {};
      contact.obstacle = *moved;
      contact.slides = true;
    }
    const double share = goes_on_like_before() ? 1 : 0;
    SpanSolution solution = next_to_known(span, share);
    if (share > 0 && !solution.is_equilibrium()) solution = next_to_known(span, 0);
    // Where a point begins to lie it slides with no least gap, and a part is too short to be told.
    if (!solution.is_equilibrium() && hold_points(span)) {
      solution = newton_from(span, options_.start);
    }
    if (!solution.is_equilibrium()) return solution;
    const Eigen::Matrix3Xd turned =
        solution.model->tangents() - options_.start(solution.model->nodes()).tangents;
    if (!(turned.cwiseAbs().maxCoeff() < followed_tangents)) return {};
    spent_ += std::exchange(solution.evaluations, 0);
    span = solution.model->span();
    solution = with_right_contacts(std::move(span), {}, std::move(solution));
    solution.followed = succeeded(solution.status) || solution.is_singular_point();
    return solution;
  }

  /// Whether the last two shapes have the same unknowns and contacts, so that a third may be looked
  /// for where they lead.
  [[nodiscard]] bool goes_on_like_before() const {
    const KnownShape& known = options_.known;
    const KnownShape& before = options_.before;
    if (!before.model || before.x.size() != known.x.size() ||
        before.model->terms() != known.model->terms() ||
        before.multipliers.size() != known.multipliers.size()) {
      return false;
    }
    const std::vector<Span::Contact>& a = before.model->span().contacts;
    const std::vector<Span::Contact>& b = known.model->span().contacts;
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const auto& x, const auto& y) {
      return x.obstacle.index == y.obstacle.index && x.lies() == y.lies();
    });
  }

  /// Fewer than the known shape has, where the last ones are for nothing: a contact that has just
  /// begun takes many for a while. Of rods in the plane.
  [[nodiscard]] int enough_terms_of_known() const {
    const SpanEnergy& model = *options_.known.model;
    const int many = model.terms();
    const int fewer = std::max(terms_of_load(model.span()), many - std::max(2, many / 5));
    if (!model.span().planar || options_.terms > 0 || fewer >= many) return many;
    // As refined() has it, with a margin.
    constexpr double margin = 0.1;
    const double most = margin * options_.tolerance * 4 * fewer * fewer;
    const Eigen::Index first = model.size() - static_cast<Eigen::Index>(model.pieces()) * many;
    for (Eigen::Index e = 0; e < model.pieces(); ++e) {
      const auto last = options_.known.x.segment(first + e * many + fewer - 2, many - fewer + 2);
      if (model.piece(e).angle(0) * last.cwiseAbs().maxCoeff() > most) return many;
    }
    return fewer;
  }

  /// An equilibrium with the known contacts, by Newton's method from where the last two shapes
  /// lead.
  /// @param share  of the way from the one before to the known one that is gone on
  [[nodiscard]] SpanSolution next_to_known(Span span, double share) {
    const KnownShape& known = options_.known;
    const KnownShape& before = options_.before;
    for (std::size_t i = 0; share > 0 && i < span.contacts.size(); ++i) {
      const Span::Contact& last = before.model->span().contacts[i];
      const Span::Contact at = span.contacts[i];
      // The ends of the rod are no places from where a contact comes.
      const bool inside = at.begin > 0 && at.end < span.length;
      const double begin = at.begin + share * (at.begin - last.begin);
      const double end = at.end + share * (at.end - last.end);
      const bool ordered = (i == 0 || begin > span.contacts[i - 1].end) && begin <= end &&
                           begin > 0 && end < span.length;
      if (!inside || !ordered) continue;
      span.contacts[i].begin = begin;
      span.contacts[i].end = at.lies() ? end : begin;
    }
    SpanSolution solution =
        workspace_.empty_solution(span, share > 0 ? enough_terms_of_known() : known.model->terms());
    SpanEnergy& model = *solution.model;
    if (model.pieces() != known.model->pieces()) return {};
    const bool fits = span.planar || span.has_material_directors();
    // The fit also says how often the clamps are wound.
    solution.x =
        fits ? model.fit(options_.start(model.nodes())) : model.adopt(*known.model, known.x);
    // A part that comes to be short has fewer of them.
    const bool as_held = known.multipliers.size() == model.constraints();
    if (as_held) solution.multipliers = known.multipliers;
    const bool as_many = solution.terms == known.model->terms();
    if (share > 0 && as_many && as_held && known.x.size() == solution.x.size()) {
      solution.x = known.x + share * (known.x - before.x);
      solution.multipliers += share * (known.multipliers - before.multipliers);
    }
    newton(solution);
    return solution;
  }

  /// From the rod without obstacles, which may stay clear of them, and from the starts of all
  /// searches.
  void search(std::vector<SpanSolution>& found) {
    SpanOptions without_start = options_;
    without_start.start = nullptr;
    SearchLog without_obstacles;
    if (options_.wants_all()) without_start.log = &without_obstacles;
    std::vector<TangentField> starts;
    double lowest_within = std::numeric_limits<double>::infinity();
    for (SpanSolution& solution : solve_span(span_, without_start, workspace_)) {
      spent_ += std::exchange(solution.evaluations, 0);
      if (!solution.is_equilibrium()) {
        if (found.empty()) found.push_back(std::move(solution));
        continue;
      }
      SpanShape shape = solution.model->shape(solution.x);
      if (!lowest_points(span_, shape, -deepest * span_.length).empty()) {
        starts.push_back(field_of(std::move(shape)));
        lowest_within = std::min(lowest_within, solution.energy);
        continue;
      }
      const bool is_new = add(std::move(solution), found);
      note_tried(options_.log, clear_of_obstacles);
      if (is_new) note_found(options_.log, clear_of_obstacles);
    }
    if (options_.wants_all()) {
      options_.log->add_starts(without_obstacles, ", as if there were no obstacles");
    }
    // What touches beside a shape that obstacles forbid costs more than that, but may cost less
    // than what stays clear elsewhere.
    const bool is_clear =
        !found.empty() && succeeded(found.front().status) && found.front().energy <= lowest_within;
    if (!options_.wants_all() && is_clear) return;
    for (TangentField& start : start_fields(span_)) starts.push_back(std::move(start));
    look_from(starts, found);
  }

  /// What polygons lead to that come to rest from these shapes, the lowest first. Of several starts
  /// coarse polygons tell which are worth a finer one: those that come to rest next to the lowest;
  /// the others, and at last the starts themselves, where these lead nowhere.
  void look_from(const std::vector<TangentField>& starts, std::vector<SpanSolution>& found) {
    const auto whole = [&](Segments segments) {
      const std::size_t most = span_.holds.empty() ? most_starts_of_one_clamp : most_starts;
      const std::size_t count =
          options_.wants_all() ? starts.size() : std::min(most, starts.size());
      return polygons_from(count, [&, segments](std::size_t i) {
        return rest_on_obstacles(span_, starts[i], segments, options_.deadline);
      });
    };
    if (starts.size() > 1) {
      const std::vector<RestingPolygon> coarse = whole(Segments::few);
      std::vector<RestingPolygon> near;
      std::vector<RestingPolygon> other;
      for (const RestingPolygon& polygon : coarse) {
        if (!polygon.at_rest) continue;
        const double lowest = coarse.front().energy;
        const bool is_near = polygon.energy - lowest <= near_lowest * (1 + std::abs(lowest));
        (is_near ? near : other).push_back(polygon);
      }
      for (const std::vector<RestingPolygon>* from : {&near, &other}) {
        if (options_.deadline.passed() && !found.empty()) return;
        look_from(polygons_from(from->size(),
                                [&](std::size_t i) {
                                  return rest_refined(span_, (*from)[i], options_.deadline);
                                }),
                  found);
        if (!options_.wants_all() && !found.empty() && succeeded(found.front().status)) return;
      }
    }
    if (options_.deadline.passed() && !found.empty()) return;
    look_from(whole(Segments::all), found);
  }

  void look_from(const std::vector<RestingPolygon>& polygons, std::vector<SpanSolution>& found) {
    for (std::size_t i = 0; i < polygons.size(); ++i) {
      const RestingPolygon& polygon = polygons[i];
      if (options_.deadline.passed() && !found.empty()) {
        note_left_out(options_.log, "starts after the time limit");
        return;
      }
      if (add(from_polygon(polygon), found)) note_found(options_.log, polygons_at_rest);
      const bool tie =
          i + 1 < polygons.size() && polygons[i + 1].energy - polygon.energy <=
                                         near_tie_of_polygons * (1 + std::abs(polygon.energy));
      if (!options_.wants_all() && succeeded(found.front().status) && !tie) return;
    }
  }

  /// Those that do not come to rest only where none does.
  [[nodiscard]] std::vector<RestingPolygon> polygons_from(
      std::size_t count, const std::function<RestingPolygon(std::size_t)>& rest) {
    std::vector<RestingPolygon> polygons;
    for (std::size_t i = 0; i < count; ++i) {
      if (options_.deadline.passed() && !polygons.empty()) {
        note_left_out(options_.log, "starts after the time limit");
        break;
      }
      note_tried(options_.log, polygons_at_rest);
      RestingPolygon polygon = rest(i);
      spent_ += polygon.evaluations;
      const bool known = std::any_of(polygons.begin(), polygons.end(), [&](const auto& other) {
        return other.at_rest && polygon.at_rest &&
               std::abs(other.energy - polygon.energy) <
                   same_polygon * (1 + std::abs(other.energy));
      });
      if (!known) polygons.push_back(std::move(polygon));
    }
    const bool any_rests = std::any_of(polygons.begin(), polygons.end(),
                                       [](const auto& polygon) { return polygon.at_rest; });
    std::erase_if(polygons, [&](const auto& polygon) { return any_rests && !polygon.at_rest; });
    std::stable_sort(polygons.begin(), polygons.end(),
                     [](const auto& a, const auto& b) { return a.energy < b.energy; });
    return polygons;
  }

  /// Where a shape that gives way comes to rest, out of its plane too.
  void leave(std::vector<SpanSolution>& found) {
    constexpr double push = 0.5;
    const std::optional<NegativeCurvature> way = negative_curvature(found.front());
    if (!way || options_.deadline.passed()) return;
    SpanEnergy pushed(way->span, found.front().terms);
    const Eigen::VectorXd x =
        pushed.adopt(*found.front().model, found.front().x) + push * way->direction;
    Span span = span_;
    span.planar = way->span.planar;
    SpanOptions options = options_;
    options.approach = Approach::descend;
    ContactSearch search(span, options, workspace_);
    search.look_from({field_of(pushed.shape(x))}, found);
    spent_ += search.spent_;
  }

  /// @return whether it is an equilibrium that was not known
  bool add(SpanSolution solution, std::vector<SpanSolution>& found) {
    spent_ += std::exchange(solution.evaluations, 0);
    if (!found.empty()) {
      if (!solution.is_equilibrium() && found.front().is_equilibrium()) return false;
      const bool known = std::any_of(found.begin(), found.end(), [&](const SpanSolution& other) {
        return solution.is_equilibrium() && other.is_equilibrium() &&
               is_same_shape(solution, other);
      });
      if (known) return false;
      if (!found.front().is_equilibrium()) found.clear();
    }
    const bool is_equilibrium = solution.is_equilibrium();
    // Of many equilibria it would take much memory.
    if (options_.wants_all()) solution.factor.reset();
    found.push_back(std::move(solution));
    std::stable_sort(found.begin(), found.end(), is_better);
    return is_equilibrium;
  }

  /// The rod's own shape with a polygon's contacts, mended until they are right.
  [[nodiscard]] SpanSolution from_polygon(const RestingPolygon& polygon) {
    Span span = span_;
    span.contacts = polygon.contacts;
    if (polygon.tangents.row(2).cwiseAbs().maxCoeff() > flat) span.planar = false;
    return with_right_contacts(std::move(span), polygon.field(), {});
  }

  /// Contacts mended until they are right. @param solution  with the span's, if there is one; else
  /// from `near`
  [[nodiscard]] SpanSolution with_right_contacts(Span span, TangentField near,
                                                 SpanSolution solution) {
    for (int round = 0; round < most_rounds; ++round) {
      const bool found_already = round == 0 && solution.is_equilibrium();
      if (!found_already) solution = newton_from(span, near);
      if (!solution.is_equilibrium() && hold_points(span)) solution = newton_from(span, near);
      if (!solution.is_equilibrium()) break;
      spent_ += free_boundary_newton(solution, options_.deadline, workspace_);
      std::optional<std::vector<Span::Contact>> next = mended(solution, load_, Terms::some);
      if (!next) {
        const TangentField here = field_of(solution.model->shape(solution.x));
        span = solution.model->span();
        solution = with_all_terms(std::move(solution));
        // Where two points are about to become a part that lies neither slides with a least gap.
        if (!solution.is_equilibrium() && hold_points(span)) {
          solution = newton_from(span, here);
          if (solution.is_equilibrium()) solution = with_all_terms(std::move(solution));
        }
        if (!solution.is_equilibrium()) break;
        next = mended(solution, load_, Terms::all);
        if (!next && !lifts_off(solution)) break;
        if (!next) return solution;
      }
      near = field_of(solution.model->shape(solution.x));
      span = solution.model->span();
      span.contacts = std::move(*next);
      for (Span::Contact& contact : span.contacts) contact.slides = true;
    }
    std::string why = solution.is_equilibrium() ? "" : ": " + solution.message;
    solution.finish(SolveStatus::not_verified);
    solution.message += ": the contacts did not converge" + why;
    return solution;
  }

  /// Where an obstacle would have to pull there may be no shape that slides, but one that is held;
  /// and a part so short that a point is hardly behind the obstacle beside it is one.
  /// @return whether any contact has changed
  [[nodiscard]] static bool hold_points(Span& span) {
    bool any = false;
    for (Span::Contact& contact : span.contacts) {
      const bool inside = contact.begin > 0 && contact.end < span.length;
      const double middle = (contact.begin + contact.end) / 2;
      if (contact.lies() && inside && contact.end - contact.begin < shortest_told * span.length) {
        contact.begin = contact.end = middle;
      }
      any = any || (contact.slides && !contact.lies());
      contact.slides = false;
    }
    return any;
  }

  /// Whether the contacts end where an obstacle without friction lets them, which is what makes the
  /// shape an equilibrium: a slope or a moment that is left there would take more than pressure.
  [[nodiscard]] static bool lifts_off(const SpanSolution& solution) {
    constexpr double settled = 1e-6;
    const Span& span = solution.model->span();
    const std::vector<LiftOff> ends = lift_offs(span);
    if (ends.empty()) return true;
    const Eigen::VectorXd miss = missed(solution, ends);
    if (!(miss.cwiseAbs().maxCoeff() <= settled)) return false;
    // Two points share a force by where they are.
    constexpr double share = 1e-7;
    for (std::size_t i = 0; i < ends.size(); ++i) {
      if (span.contacts[ends[i].contact].lies()) continue;
      const Room room = room_of(span, ends[i]);
      const double off = std::abs(miss[static_cast<Eigen::Index>(i)]);
      if (!(off <= share * std::min(room.down, room.up))) return false;
    }
    return true;
  }

  [[nodiscard]] SpanSolution newton_from(const Span& span, const TangentField& near) {
    SpanSolution solution = workspace_.empty_solution(span, terms(span));
    solution.x = solution.model->fit(near(solution.model->nodes()));
    const Eigen::VectorXd start = solution.x;
    // Newton's method would go back to the saddle, or into the plane, that a shape has left.
    const bool has_left = options_.approach == Approach::descend || span.planar != span_.planar;
    if (!has_left) newton(solution);
    if (!solution.is_equilibrium()) {
      solution.x = start;
      descend_in_trust_region(
          solution,
          {.load = load_, .gradient_tolerance = handover_gradient, .deadline = &options_.deadline});
      if (succeeded(solution.status)) newton(solution);
    }
    spent_ += std::exchange(solution.evaluations, 0);
    return solution;
  }

  void newton(SpanSolution& solution) {
    newton_solve(solution, {.load = load_, .deadline = &options_.deadline}, workspace_.newton());
  }

  [[nodiscard]] int terms(const Span& span) const {
    if (options_.terms > 0) return options_.terms;
    // What is followed takes about as many as it has taken before.
    return std::max(terms_of_load(span), options_.known.terms());
  }

  [[nodiscard]] int terms_of_load(const Span& span) const {
    constexpr int fewest = 12;  // beside a kink
    double longest = 0;
    const std::vector<Piece> pieces = pieces_of(span);
    for (const Piece& piece : pieces) longest = std::max(longest, piece.length);
    const int count = std::max(fewest, first_terms(load_, longest));
    // Many pieces are short, and what they do not take need not be borne while contacts change.
    const int unknowns = count * static_cast<int>(pieces.size()) * (span.planar ? 1 : 2);
    return unknowns > many_unknowns ? std::max(fewest, count / 2) : count;
  }

  /// As many terms as the shape takes, and as what lies takes to be on its obstacle; certified.
  [[nodiscard]] SpanSolution with_all_terms(SpanSolution solution) {
    for (;;) {
      const int before = solution.terms;
      solution = finished(std::move(solution));
      if (solution.is_equilibrium() && solution.terms > before) {
        spent_ += free_boundary_newton(solution, options_.deadline, workspace_);
        solution = finished(std::move(solution));
      }
      const int finer = solution.terms + solution.terms / 2;
      const bool more = options_.terms == 0 && finer <= max_terms && hardly_behind(solution);
      if (!more || options_.deadline.passed()) return solution;
      SpanSolution next = workspace_.with_terms(solution, finer);
      newton(next);
      if (!next.is_equilibrium()) return solution;
      solution = std::move(next);
      spent_ += free_boundary_newton(solution, options_.deadline, workspace_);
    }
  }

  /// Behind an obstacle by no more than missing terms may make it.
  [[nodiscard]] bool hardly_behind(const SpanSolution& solution) const {
    if (!solution.is_equilibrium()) return false;
    const std::vector<Lowest> behind =
        lowest_points(span_, solution.model->shape(solution.x), -deepest * span_.length);
    return !behind.empty() && std::all_of(behind.begin(), behind.end(), [&](const auto& lowest) {
      return lowest.clearance > -deepest_coarse * span_.length;
    });
  }

  [[nodiscard]] SpanSolution finished(SpanSolution solution) {
    SpanOptions options = options_;
    options.start = nullptr;
    solution = finish(std::move(solution), options, workspace_);
    spent_ += std::exchange(solution.evaluations, 0);
    return solution;
  }

  const Span& span_;
  const SpanOptions& options_;
  SpanWorkspace& workspace_;
  double load_;
  int spent_ = 0;
};

}  // namespace

std::vector<SpanSolution> solve_touching_span(const Span& span, const SpanOptions& options,
                                              SpanWorkspace& workspace) {
  return ContactSearch(span, options, workspace).run();
}

}  // namespace dlo::energy_model
