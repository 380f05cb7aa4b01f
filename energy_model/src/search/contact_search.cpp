#include "search/contact_search.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "contact/clearance.hpp"
#include "contact/mend.hpp"
#include "contact/resting_polygon.hpp"
#include "search/active_set.hpp"
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
/// Times that a shape is left which cannot hold itself.
constexpr int most_departures = 4;
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
      : span_(span),
        options_(options),
        workspace_(workspace),
        active_set_(span, options, workspace),
        load_(span.total_load()) {}

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
    std::optional<std::vector<Span::Contact>> contacts =
        moved_contacts(span, known.model->span().contacts);
    if (!contacts) return {};
    span.contacts = std::move(*contacts);
    const double share = goes_on_like_before() ? 1 : 0;
    SpanSolution solution = next_to_known(span, share);
    if (share > 0 && !solution.is_equilibrium()) solution = next_to_known(span, 0);
    // Where a point begins to lie it slides with no least gap, and a part is too short to be told.
    if (!solution.is_equilibrium() && hold_points(span)) {
      solution = active_set_.newton_from(span, options_.start);
    }
    if (!solution.is_equilibrium()) return solution;
    const Eigen::Matrix3Xd turned =
        solution.model->tangents() - options_.start(solution.model->nodes()).tangents;
    if (!(turned.cwiseAbs().maxCoeff() < followed_tangents)) return {};
    solution = active_set_.solve(std::move(solution));
    spent_ += std::exchange(solution.evaluations, 0);
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
    const int fewer =
        std::max(active_set_.terms_of_load(model.span()), many - std::max(2, many / 5));
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
    newton_solve(solution, {.load = load_, .deadline = &options_.deadline}, workspace_.newton());
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
      const SpanShape shape = solution.model->shape(solution.x);
      if (!lowest_points(span_, shape, -deepest * span_.length).empty()) {
        starts.push_back(solution.model->field(solution.x));
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
    search.look_from({pushed.field(x)}, found);
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
    return active_set_.solve(std::move(span), polygon.field());
  }

  const Span& span_;
  const SpanOptions& options_;
  SpanWorkspace& workspace_;
  ActiveSet active_set_;
  double load_;
  int spent_ = 0;
};

}  // namespace

std::vector<SpanSolution> solve_touching_span(const Span& span, const SpanOptions& options,
                                              SpanWorkspace& workspace) {
  return ContactSearch(span, options, workspace).run();
}

}  // namespace dlo::energy_model
