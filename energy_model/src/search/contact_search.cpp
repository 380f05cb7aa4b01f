#include "search/contact_search.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <cstdio>
#include <cstdlib>

#include "base/free_directions.hpp"
#include "certify/enough_terms.hpp"
#include "contact/clearance.hpp"
#include "contact/lift_off.hpp"
#include "contact/resting_polygon.hpp"
#include "newton/trust_region.hpp"
#include "search/span_starts.hpp"
#include "search/way_down.hpp"

namespace dlo::energy_model {
namespace {

/// What a shape may be behind a rigid wall, and how hard a wall may pull, over what all forces are
/// there: rounding.
constexpr double deepest = 1e-9;
/// The same while terms may be missing.
constexpr double deepest_coarse = 1e-6;
constexpr double strongest_pull = 1e-7;

/// Shapes from which polygons come to rest.
constexpr std::size_t most_starts = 3;
constexpr int most_rounds = 16;
constexpr int most_steps = 25;
/// Step of a lift-off at which it is found, in lengths.
constexpr double lift_off_tolerance = 1e-10;
/// Longest step of one, in lengths: the polygon has told where it is.
constexpr double longest_step = 0.02;
/// Length that a lying part is given where a point becomes one.
constexpr double first_part = 0.01;

class ContactSearch {
 public:
  ContactSearch(const Span& span, const SpanOptions& options, SpanWorkspace& workspace)
      : span_(span), options_(options), workspace_(workspace), load_(span.total_load()) {
    workspace_.newton().limit(options.deadline);
    bare_ = span;
    std::erase_if(bare_.walls, [](const Span::Wall& wall) { return std::isinf(wall.stiffness); });
  }

  [[nodiscard]] std::vector<SpanSolution> run() {
    std::vector<SpanSolution> found;
    std::vector<TangentField> starts;
    SpanOptions free_options = options_;
    std::vector<SpanSolution> free = solve_span(bare_, free_options, workspace_);
    for (SpanSolution& solution : free) {
      spent_ += std::exchange(solution.evaluations, 0);
      if (!solution.is_equilibrium()) continue;
      const SpanShape shape = solution.model->shape(solution.x);
      if (lowest_points(span_.walls, span_.length, shape, -deepest).empty()) {
        found.push_back(std::move(solution));
        if (!options_.all) return finished(std::move(found));
        continue;
      }
      starts.push_back(field_of(shape));
    }
    const std::vector<TangentField> others = start_fields(span_);
    starts.insert(starts.end(), others.begin(), others.end());
    if (options_.start) starts.insert(starts.begin(), options_.start);
    look_from(starts, found);
    if (!found.empty() && found.front().status == SolveStatus::saddle) leave(found);
    return finished(std::move(found));
  }

 private:
  /// What polygons lead to that come to rest from these shapes.
  void look_from(const std::vector<TangentField>& starts, std::vector<SpanSolution>& found) {
    const std::size_t most = options_.all ? starts.size() : std::min(most_starts, starts.size());
    std::vector<RestingPolygon> polygons;
    for (std::size_t i = 0; i < most && !options_.deadline.passed(); ++i) {
      RestingPolygon polygon = rest_on_walls(span_, starts[i], options_.deadline);
      spent_ += polygon.evaluations;
      const bool known = std::any_of(polygons.begin(), polygons.end(), [&](const auto& other) {
        return other.at_rest && polygon.at_rest &&
               std::abs(other.energy - polygon.energy) < 1e-6 * (1 + std::abs(other.energy));
      });
      if (!known) polygons.push_back(std::move(polygon));
    }
    std::stable_sort(polygons.begin(), polygons.end(), [](const auto& a, const auto& b) {
      return a.at_rest != b.at_rest ? a.at_rest : a.energy < b.energy;
    });
    for (const RestingPolygon& polygon : polygons) {
      if (options_.deadline.passed()) break;
      if (getenv("CT")) { printf("polygon rest %d energy %.6g ev %d contacts", polygon.at_rest, polygon.energy, polygon.evaluations); for (auto& c: polygon.contacts) printf(" [%zu %.4f %.4f]", c.wall, c.begin, c.end); printf("\n"); }
      add(from_polygon(polygon), found);
      if (!options_.all && !found.empty() && succeeded(found.front().status)) break;
    }
  }

  /// Where a shape that gives way comes to rest, out of its plane too.
  void leave(std::vector<SpanSolution>& found) {
    constexpr double push = 0.5;
    const std::optional<WayDown> way = way_down(found.front());
    if (!way || options_.deadline.passed()) return;
    Span span = span_;
    span.planar = way->span.planar;
    SpanEnergy pushed(way->span, found.front().terms);
    const Eigen::VectorXd x =
        pushed.adopt(*found.front().model, found.front().x) + push * way->along;
    ContactSearch search(span, options_, workspace_);
    search.look_from({field_of(pushed.shape(x))}, found);
    spent_ += search.spent_;
  }

  [[nodiscard]] static TangentField field_of(const SpanShape& shape) {
    return [shape](const Eigen::VectorXd& s) {
      return StartShape(shape.sample({s.data(), static_cast<std::size_t>(s.size())}).tangents);
    };
  }

  [[nodiscard]] std::vector<SpanSolution> finished(std::vector<SpanSolution> found) {
    if (found.empty()) {
      SpanSolution none;
      none.model = workspace_.model(bare_, 8);
      none.terms = 8;
      none.x.setZero(none.model->size());
      none.multipliers.setZero(none.model->constraints());
      none.finish(SolveStatus::time_limit);
      found.push_back(std::move(none));
    }
    found.front().evaluations = spent_;
    return found;
  }

  void add(SpanSolution solution, std::vector<SpanSolution>& found) {
    spent_ += std::exchange(solution.evaluations, 0);
    found.push_back(std::move(solution));
    const auto rank = [](const SpanSolution& s) { return succeeded(s.status) ? 0 : 1; };
    std::stable_sort(found.begin(), found.end(), [&](const auto& a, const auto& b) {
      return rank(a) != rank(b) ? rank(a) < rank(b) : a.energy < b.energy;
    });
  }

  /// With this span's contacts, from a shape near to it.
  [[nodiscard]] SpanSolution polished(const Span& span, const TangentField& near, int terms) {
    SpanSolution solution;
    solution.model = workspace_.model(span, terms);
    solution.terms = terms;
    solution.x = solution.model->fit(near(solution.model->nodes()));
    workspace_.newton().polish(solution, load_);
    if (solution.is_equilibrium()) return solution;
    solution.x = solution.model->fit(near(solution.model->nodes()));
    descend_in_trust_region(
        solution,
        {.load = load_, .gradient_tolerance = handover_gradient, .deadline = &options_.deadline});
    if (succeeded(solution.status)) workspace_.newton().polish(solution, load_);
    return solution;
  }

  /// The same contacts with their ends moved a little.
  [[nodiscard]] SpanSolution moved(const SpanSolution& from, const Span& span) {
    SpanSolution solution;
    solution.model = workspace_.model(span, from.terms);
    solution.terms = from.terms;
    solution.x = solution.model->adopt(*from.model, from.x);
    solution.multipliers = from.multipliers;
    workspace_.newton().polish(solution, load_);
    return solution;
  }

  [[nodiscard]] Eigen::VectorXd missed_by(const SpanSolution& solution,
                                          const std::vector<LiftOff>& ends) const {
    return missed(solution.model->span(), ends, solution.model->shape(solution.x));
  }

  [[nodiscard]] int terms(const Span& span) const {
    if (options_.terms > 0) return options_.terms;
    double longest = 0;
    for (const Piece& piece : pieces_of(span)) longest = std::max(longest, piece.length);
    return std::max(12, first_terms(load_, longest));
  }

  /// Moves the contacts' ends to where the rod lifts off by itself: Newton's method with
  /// differences for derivatives, then Broyden's. A lying part that wants to vanish, and ends that
  /// do not settle, are left as they are.
  void find_lift_offs(SpanSolution& solution) {
    const std::vector<LiftOff> ends = lift_offs(solution.model->span());
    const auto count = static_cast<Eigen::Index>(ends.size());
    if (count == 0) return;
    Eigen::VectorXd miss = missed_by(solution, ends);
    Eigen::MatrixXd jacobian(count, count);
    bool fresh = false;
    for (int step = 0; step < most_steps && !options_.deadline.passed(); ++step) {
      if (!fresh && (step == 0 || step % 8 == 0)) {
        if (!differentiate(solution, ends, miss, jacobian)) return;
        fresh = true;
      }
      Eigen::VectorXd way = -jacobian.partialPivLu().solve(miss);
      const Span before = solution.model->span();
      double share = 1;
      for (Eigen::Index i = 0; i < count; ++i) {
        const Room room = room_of(before, ends[static_cast<std::size_t>(i)]);
        const double most =
            std::min(0.45 * (way[i] < 0 ? room.down : room.up), longest_step * span_.length);
        if (std::abs(way[i]) > most) share = std::min(share, most / std::abs(way[i]));
      }
      if (!way.allFinite()) return;
      way *= share;
      Span next = before;
      for (Eigen::Index i = 0; i < count; ++i) ends[static_cast<std::size_t>(i)].move(next, way[i]);
      SpanSolution trial = moved(solution, next);
      spent_ += trial.evaluations;
      if (!trial.is_equilibrium()) return;
      const Eigen::VectorXd change = missed_by(trial, ends);
      const double size = way.cwiseAbs().maxCoeff();
      // Broyden's update
      jacobian += (change - miss - jacobian * way) * way.transpose() / way.squaredNorm();
      fresh = false;
      miss = change;
      trial.evaluations = 0;
      solution = std::move(trial);
      if (size < lift_off_tolerance * span_.length) return;
    }
  }

  [[nodiscard]] bool differentiate(const SpanSolution& solution, const std::vector<LiftOff>& ends,
                                   const Eigen::VectorXd& miss, Eigen::MatrixXd& jacobian) {
    const Span& span = solution.model->span();
    for (std::size_t i = 0; i < ends.size(); ++i) {
      const Room room = room_of(span, ends[i]);
      const double step = room.down > room.up ? -1e-6 * room.down : 1e-6 * room.up;
      Span next = span;
      ends[i].move(next, step);
      const SpanSolution beside = moved(solution, next);
      spent_ += beside.evaluations;
      if (!beside.is_equilibrium()) return false;
      jacobian.col(static_cast<Eigen::Index>(i)) = (missed_by(beside, ends) - miss) / step;
    }
    return true;
  }

  [[nodiscard]] SpanSolution from_polygon(const RestingPolygon& polygon) {
    Span span = bare_;
    span.contacts = polygon.contacts;
    constexpr double flat = 1e-6;
    if (polygon.tangents.row(2).cwiseAbs().maxCoeff() > flat) span.planar = false;
    TangentField near = polygon.field();
    SpanSolution solution;
    for (int round = 0; round < most_rounds; ++round) {
      solution = polished(span, near, terms(span));
      spent_ += std::exchange(solution.evaluations, 0);
      if (getenv("CT") && !solution.is_equilibrium()) printf(" round %d: %s\n", round, solution.message.c_str());
      if (!solution.is_equilibrium()) break;
      find_lift_offs(solution);
      near = field_of(solution.model->shape(solution.x));
      span = solution.model->span();
      if (getenv("CT")) { printf(" round %d terms %d E %.8g:", round, solution.terms, solution.energy); auto f=solution.model->contact_forces(solution.multipliers); for (size_t i=0;i<f.size();++i) printf(" [%.6f %.6f] F %.4g (%.3g %.3g) p %.3g", span.contacts[i].begin, span.contacts[i].end, f[i].total,f[i].begin,f[i].end,f[i].least_pressure); auto m=missed_by(solution, lift_offs(span)); for (double v: m) printf(" m %.1e", v); printf("\n"); }
      if (mend(solution, span, deepest_coarse)) continue;
      solution = with_all_terms(std::move(solution));
      if (!solution.is_equilibrium()) break;
      near = field_of(solution.model->shape(solution.x));
      span = solution.model->span();
      if (mend(solution, span, deepest)) continue;
      return solution;
    }
    solution.status = SolveStatus::not_resolved;
    solution.message = "the contacts did not settle: " + solution.message;
    return solution;
  }

  [[nodiscard]] SpanSolution finished_with(const SpanOptions& options, SpanSolution solution) {
    const Span span = solution.model->span();
    return finish_span(span, options, workspace_, std::move(solution));
  }

  /// As many terms as the shape takes, and as many as what lies takes to be on its wall.
  [[nodiscard]] SpanSolution with_all_terms(SpanSolution solution) {
    SpanOptions options = options_;
    options.start = nullptr;
    for (;;) {
      const int before = solution.terms;
      solution = finished_with(options, std::move(solution));
      if (!solution.is_equilibrium()) return solution;
      const bool more = solution.terms > before;
      if (more) find_lift_offs(solution);
      const std::vector<Lowest> behind =
          lowest_points(span_.walls, span_.length, solution.model->shape(solution.x),
                        -deepest * span_.length);
      const bool hardly = std::all_of(behind.begin(), behind.end(), [&](const Lowest& lowest) {
        return lowest.clearance > -deepest_coarse * span_.length;
      });
      const int finer = solution.terms + solution.terms / 2;
      if (behind.empty() || !hardly || options_.terms > 0 || finer > max_terms) {
        return more ? finished_with(options, std::move(solution)) : solution;
      }
      options.least_terms = finer;
      SpanSolution next;
      next.model = workspace_.model(solution.model->span(), finer);
      next.terms = finer;
      next.x = next.model->adopt(*solution.model, solution.x);
      next.multipliers = next.model->adopt_multipliers(*solution.model, solution.multipliers);
      workspace_.newton().polish(next, load_);
      if (!next.is_equilibrium()) return solution;
      find_lift_offs(next);
      solution = std::move(next);
    }
  }

  /// Changes the contacts where a wall would have to pull, and where the rod is behind one.
  /// @param[in,out] span  the solution's
  /// @return whether anything was wrong
  [[nodiscard]] bool mend(const SpanSolution& solution, Span& span, double depth) const {
    const std::vector<ContactForce> forces =
        solution.model->contact_forces(solution.multipliers);
    const double scale = 1 + load_ + solution.multipliers.norm();
    const double pull = -strongest_pull * scale;
    const SpanShape shape = solution.model->shape(solution.x);
    bool wrong = false;
    std::vector<Span::Contact> kept;
    for (std::size_t i = 0; i < span.contacts.size(); ++i) {
      Span::Contact contact = span.contacts[i];
      const ContactForce& force = forces[i];
      if (!contact.lies()) {
        if (force.total < pull) {
          wrong = true;
          continue;
        }
        kept.push_back(contact);
        continue;
      }
      const double length = contact.end - contact.begin;
      const bool lifted = force.least_pressure * length < pull || force.least_inner < pull;
      const bool too_short = length < 1e-6 * span.length;
      // Nothing beyond a free end is carried there.
      const bool begin_pulls = contact.begin > 0 && force.begin < pull;
      const bool end_pulls = contact.end < span.length && force.end < pull;
      if (begin_pulls || end_pulls || lifted || too_short) {
        wrong = true;
        double at = (contact.begin + contact.end) / 2;
        if (begin_pulls && !end_pulls) at = contact.end;
        if (end_pulls && !begin_pulls) at = contact.begin;
        contact.begin = contact.end = at;
      }
      kept.push_back(contact);
    }
    span.contacts = kept;
    wrong = join(shape, span) || wrong;
    for (const Lowest& lowest :
         lowest_points(span_.walls, span_.length, shape, -depth * span_.length)) {
      wrong = true;
      add_contact(lowest, shape, span);
    }
    return wrong;
  }

  /// Neighbouring contacts with a wall that the rod hardly leaves between them, or is behind, are
  /// one.
  [[nodiscard]] static bool join(const SpanShape& shape, Span& span) {
    bool joined = false;
    for (std::size_t i = 0; i + 1 < span.contacts.size();) {
      Span::Contact& here = span.contacts[i];
      const Span::Contact& next = span.contacts[i + 1];
      const double gap = next.begin - here.end;
      const bool same = here.wall == next.wall;
      // Of a free part as short as that nothing could be told.
      const bool no_gap = gap < 0.02 * span.length &&
                          highest_between(here, shape, here.end, next.begin) < 1e-3 * gap;
      if (!same || !(no_gap || highest_between(here, shape, here.end, next.begin) < 0)) {
        ++i;
        continue;
      }
      here.end = std::max(here.end, next.end);
      span.contacts.erase(span.contacts.begin() + static_cast<std::ptrdiff_t>(i) + 1);
      joined = true;
    }
    return joined;
  }

  /// Largest clearance over a contact's wall between two arc lengths.
  [[nodiscard]] static double highest_between(const Span::Contact& contact, const SpanShape& shape,
                                              double from, double to) {
    constexpr int looks = 16;
    std::vector<double> s;
    for (int i = 1; i < looks; ++i) s.push_back(from + (to - from) * i / looks);
    const SpanSamples samples = shape.sample(s);
    return (contact.normal.transpose() * samples.points).maxCoeff() + contact.offset;
  }

  /// What is behind a wall touches it; next to a point of contact both lie.
  void add_contact(const Lowest& lowest, const SpanShape& shape, Span& span) const {
    const Span::Wall& wall = span_.walls[lowest.wall];
    const double reach = first_part * span.length;
    for (Span::Contact& contact : span.contacts) {
      if (contact.normal != wall.normal || contact.offset != wall.offset) continue;
      const bool beside =
          lowest.s > contact.begin - 2 * reach && lowest.s < contact.end + 2 * reach;
      const bool to_tip = lowest.s == span.length && contact.end < span.length &&
                          highest_between(contact, shape, contact.end, span.length) < 0;
      if (to_tip) {
        contact.end = span.length;
        return;
      }
      if (!beside) continue;
      contact.begin = std::max(0.0, std::min(contact.begin, lowest.s) - reach / 2);
      contact.end = std::min(span.length, std::max(contact.end, lowest.s) + reach / 2);
      return;
    }
    const double at = std::clamp(lowest.s, 0.0, span.length);
    span.contacts.push_back({lowest.wall, wall.normal, wall.offset, at, at});
    std::sort(span.contacts.begin(), span.contacts.end(),
              [](const auto& a, const auto& b) { return a.begin < b.begin; });
  }

  const Span& span_;
  Span bare_;  // without rigid walls
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
