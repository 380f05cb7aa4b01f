#include "search/contact_search.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "contact/clearance.hpp"
#include "contact/penalty_polygon.hpp"
#include "search/active_set.hpp"
#include "span/found.hpp"
#include "span/nearby_equilibria.hpp"
#include "span/span_solver.hpp"
#include "span/span_starts.hpp"

namespace dlo::energy_model {
namespace {

/// Number of initial guesses for polygons, unless all equilibria are wanted. Six instead of three
/// with one clamp gave the same equilibria on random floors and bodies in the plane, at 1.4 times
/// the cost.
constexpr std::size_t most_starts = 3;
/// Maximum number of descents from an unstable shape.
constexpr int most_departures = 4;
/// Energy above the lowest, divided by 1 + energy, up to which a polygon with few segments is
/// refined first: its energy has about this error, since segments cut the corners of bodies.
constexpr double first_refined_energy = 0.5;
/// Energy difference, divided by 1 + energy, below which two polygons with all segments count as
/// tied: with contact their energies have errors of up to 0.03, and the rod's own energies decide.
constexpr double polygon_tie_energy = 0.06;
/// Energy difference of equal polygons, divided by 1 + energy.
constexpr double same_energy_of_polygons = 1e-6;

constexpr const char* clear_of_obstacles = "shapes without obstacles that stay clear of them";
constexpr const char* polygons_at_rest = "polygons at rest on the obstacles";

constexpr const char* past_obstacles = "shapes that pass one or two obstacles on either side";

/// Largest distance between points of two coarse polygons that count as the same equilibrium,
/// divided by the span's length. Polygons in equilibrium are determined to 1e-7; different ones are
/// further apart.
constexpr double same_coarse_polygon = 1e-3;

/// Search for equilibria with contacts. @param found  results of this and other searches of the
/// span
class ContactSearch {
 public:
  ContactSearch(const Span& span, const SpanOptions& options, SpanWorkspace& workspace,
                Found& found)
      : span_(span), options_(options), workspace_(workspace), found_(found) {}

  void run() {
    const SpanStart& start = options_.start;
    const bool starts = start.field && !options_.wants_all();
    if (starts && start.known.model) {
      SpanSolution followed = follow_contacts(span_, options_, workspace_);
      if (followed.is_known() || options_.only_follows()) (void)found_.add(std::move(followed));
    }
    if (options_.only_follows()) return;
    if (found_.empty()) {
      if (starts) search_from({start.field});
      const bool suffices = !found_.empty() && succeeded(found_.best().status);
      if (!suffices && !options_.only_descends()) search();
    }
    for (int i = 0; i < most_departures && found_.best().status == SolveStatus::saddle; ++i) {
      const double energy = found_.best().energy;
      leave_saddle();
      if (!(found_.best().energy < energy)) break;
    }
  }

  /// Searches from shapes that pass obstacles. Each is relaxed as a coarse polygon. It is dropped
  /// if a known equilibrium relaxes to the same polygon or, unless all equilibria are wanted, if
  /// the polygon's energy exceeds that of the lowest known equilibrium's polygon by more than the
  /// errors of polygons (first_refined_energy, polygon_tie_energy).
  void search_past() {
    const std::vector<Span> starts = pinned_past_obstacles(span_);
    if (starts.empty()) return;
    std::vector<PenaltyPolygon> known;
    for (const SpanSolution& solution : found_.by_discovery()) {
      if (!succeeded(solution.status)) continue;
      known.push_back(coarse_polygon(solution.model->field(solution.x)));
    }
    const std::size_t before = known.size();
    for (const Span& start : starts) {
      if (omits_late_starts(options_)) break;
      log_tried(options_.log, past_obstacles);
      if (options_.other_side_starts != nullptr) ++*options_.other_side_starts;
      PenaltyPolygon polygon = coarse_polygon(arch_field(start));
      const bool is_new = std::ranges::none_of(known, [&](const auto& other) {
        return polygon.points.cols() == other.points.cols() &&
               (polygon.points - other.points).colwise().norm().maxCoeff() <
                   same_coarse_polygon * span_.length;
      });
      if (polygon.at_rest && is_new) known.push_back(std::move(polygon));
    }
    const auto wanted = [&](double energy, const PenaltyPolygon& lowest, double margin) {
      return options_.wants_all() ||
             energy - lowest.energy <= margin * (1 + std::abs(lowest.energy));
    };
    std::optional<PenaltyPolygon> lowest;
    for (std::size_t i = before; i < known.size() && !options_.deadline.passed(); ++i) {
      if (before > 0 && !wanted(known[i].energy, known.front(), first_refined_energy)) continue;
      const PenaltyPolygon fine = relax_refined(span_, known[i], options_.deadline, Descent::near);
      found_.add_evaluations(fine.evaluations);
      if (before > 0 && !options_.wants_all()) {
        if (!lowest) lowest = relax_refined(span_, known.front(), options_.deadline, Descent::near);
        if (!wanted(fine.energy, *lowest, polygon_tie_energy)) continue;
      }
      if (found_.add(from_polygon(fine))) log_found(options_.log, past_obstacles);
    }
  }

 private:
  [[nodiscard]] PenaltyPolygon coarse_polygon(const TangentField& start) {
    PenaltyPolygon polygon =
        relax_on_obstacles(span_, start, Segments::few, options_.deadline, Descent::near);
    found_.add_evaluations(polygon.evaluations);
    return polygon;
  }

  /// Searches from the equilibria without obstacles, which may be clear of them, and from
  /// start_fields().
  void search() {
    SpanOptions without_start = options_;
    without_start.start = {};
    SearchLog without_obstacles;
    if (options_.wants_all()) without_start.log = &without_obstacles;
    std::vector<TangentField> starts;
    std::optional<SpanSolution> failure;
    double lowest_within = std::numeric_limits<double>::infinity();
    std::vector<SpanSolution> clear = solve_span(span_, without_start, workspace_);
    if (!options_.wants_all()) clear.resize(1);
    for (SpanSolution& solution : clear) {
      found_.add_evaluations(std::exchange(solution.evaluations, 0));
      if (!solution.is_equilibrium()) {
        failure = std::move(solution);
        continue;
      }
      const SpanShape shape = solution.model->shape(solution.x);
      if (!gap_minima(span_, shape, -contact_tolerance * span_.length).empty()) {
        starts.push_back(solution.model->field(solution.x));
        lowest_within = std::min(lowest_within, solution.energy);
        continue;
      }
      (void)found_.add(std::move(solution), clear_of_obstacles);
    }
    if (options_.wants_all()) {
      options_.log->add_starts(without_obstacles, ", as if there were no obstacles");
    }
    // Obstacles raise the energy: a shape with contact has more energy than the shape without
    // obstacles from which it is found. It may still have less energy than all shapes that are
    // clear of obstacles. The search ends here only if the best clear shape has no more energy than
    // any shape that obstacles exclude.
    if (found_.suffices() && found_.best().energy <= lowest_within) return;
    for (TangentField& start : start_fields(span_)) starts.push_back(std::move(start));
    search_from(starts);
    if (found_.empty() && failure) (void)found_.add(std::move(*failure));
  }

  /// Relaxes polygons from these shapes and adds the rod's equilibria found from them, lowest
  /// first. With several starts coarse polygons are relaxed first: those near the lowest energy are
  /// refined, then the others if these yield no result, and at last polygons with all segments from
  /// the starts.
  void search_from(const std::vector<TangentField>& starts) {
    const auto whole = [&](Segments segments) {
      const std::size_t count =
          options_.wants_all() ? starts.size() : std::min(most_starts, starts.size());
      return polygons_from(count, [&, segments](std::size_t i) {
        const Descent descent = options_.only_descends() ? Descent::near : Descent::far;
        return relax_on_obstacles(span_, starts[i], segments, options_.deadline, descent);
      });
    };
    if (starts.size() > 1) {
      const std::vector<PenaltyPolygon> coarse = whole(Segments::few);
      std::vector<PenaltyPolygon> near;
      std::vector<PenaltyPolygon> other;
      for (const PenaltyPolygon& polygon : coarse) {
        if (!polygon.at_rest) continue;
        const double lowest = coarse.front().energy;
        const bool is_near =
            polygon.energy - lowest <= first_refined_energy * (1 + std::abs(lowest));
        (is_near ? near : other).push_back(polygon);
      }
      for (const std::vector<PenaltyPolygon>* from : {&near, &other}) {
        if (options_.deadline.passed() && !found_.empty()) return;
        refine(polygons_from(from->size(), [&](std::size_t i) {
          return relax_refined(span_, (*from)[i], options_.deadline);
        }));
        if (found_.suffices()) return;
      }
    }
    if (options_.deadline.passed() && !found_.empty()) return;
    refine(whole(Segments::all));
  }

  /// Solves for the rod's equilibria with the contacts of the polygons, lowest first, up to the
  /// first one that suffices and those tied with it.
  void refine(const std::vector<PenaltyPolygon>& polygons) {
    for (std::size_t i = 0; i < polygons.size(); ++i) {
      const PenaltyPolygon& polygon = polygons[i];
      if (!found_.empty() && omits_late_starts(options_)) return;
      if (found_.add(from_polygon(polygon))) log_found(options_.log, polygons_at_rest);
      const bool tie =
          i + 1 < polygons.size() && polygons[i + 1].energy - polygon.energy <=
                                         polygon_tie_energy * (1 + std::abs(polygon.energy));
      if (found_.suffices() && !tie) return;
    }
  }

  /// Relaxes polygons and sorts them by energy, without duplicates. Those that are not in
  /// equilibrium are kept only if none is.
  [[nodiscard]] std::vector<PenaltyPolygon> polygons_from(
      std::size_t count, const std::function<PenaltyPolygon(std::size_t)>& rest) {
    std::vector<PenaltyPolygon> polygons;
    for (std::size_t i = 0; i < count; ++i) {
      if (!polygons.empty() && omits_late_starts(options_)) break;
      log_tried(options_.log, polygons_at_rest);
      PenaltyPolygon polygon = rest(i);
      found_.add_evaluations(polygon.evaluations);
      const bool known = std::ranges::any_of(polygons, [&](const auto& other) {
        return other.at_rest && polygon.at_rest &&
               std::abs(other.energy - polygon.energy) <
                   same_energy_of_polygons * (1 + std::abs(other.energy));
      });
      if (!known) polygons.push_back(std::move(polygon));
    }
    const bool any_rests = std::ranges::any_of(polygons, &PenaltyPolygon::at_rest);
    std::erase_if(polygons, [&](const auto& polygon) { return any_rests && !polygon.at_rest; });
    std::ranges::stable_sort(polygons, {}, &PenaltyPolygon::energy);
    return polygons;
  }

  /// Descends from the best shape along its direction of negative curvature, also out of its plane.
  void leave_saddle() {
    const SpanSolution& saddle = found_.best();
    const std::optional<NegativeCurvature> descent = negative_curvature(saddle);
    if (!descent || options_.deadline.passed()) return;
    SpanEnergy pushed(descent->span, saddle.terms);
    const Eigen::VectorXd x =
        pushed.prolong(*saddle.model, saddle.x) + mode_amplitude * descent->direction;
    Span span = span_;
    span.planar = descent->span.planar;
    SpanOptions options = options_;
    options.start.approach = Approach::descend;
    ContactSearch(span, options, workspace_, found_).search_from({pushed.field(x)});
  }

  /// Solves for the rod's equilibrium with a polygon's contacts, which are updated until they
  /// converge.
  [[nodiscard]] SpanSolution from_polygon(const PenaltyPolygon& polygon) {
    Span span = span_;
    span.contacts = polygon.contacts;
    if (polygon.tangents.row(2).cwiseAbs().maxCoeff() > planar_tangent_tolerance)
      span.planar = false;
    SpanOptions options = options_;
    // Newton's method may step over soft obstacles, at which no constraint keeps the rod.
    if (!span_.soft_obstacles.empty()) options.start.approach = Approach::descend;
    return ActiveSet(span_, options, workspace_).solve(std::move(span), polygon.field());
  }

  const Span& span_;
  const SpanOptions& options_;
  SpanWorkspace& workspace_;
  Found& found_;
};

}  // namespace

std::vector<SpanSolution> solve_touching_span(const Span& span, const SpanOptions& options,
                                              SpanWorkspace& workspace) {
  Found found(options);
  ContactSearch(span, options, workspace, found).run();
  return std::move(found).take();
}

void search_past_obstacles(const Span& span, const SpanOptions& options, SpanWorkspace& workspace,
                           Found& found) {
  ContactSearch(span, options, workspace, found).search_past();
}

}  // namespace dlo::energy_model
