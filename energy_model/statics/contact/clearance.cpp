#include "contact/clearance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <sstream>
#include <utility>
#include <vector>

#include "dlo/energy_model/energy.hpp"
#include "dlo/energy_model/problem.hpp"

namespace dlo::energy_model {
namespace {

constexpr Eigen::Index grid_points = 1001;
/// Spacing, in grid points, of the points that are evaluated first.
constexpr std::size_t coarse_stride = 20;
/// Maximum number of Newton steps that refine a minimum of the clearance, starting from a grid
/// point. The steps stay between the neighbouring grid points.
constexpr int newton_steps = 6;

/// Number of additional points beyond each end of a contact, each at half the distance of the
/// one before. If a point contact should become a part in contact, the rod is within the obstacle
/// next to it, closer than the grid resolves.
constexpr int halvings_beside_contact = 10;

/// Clearance of points that are not evaluated, as no point near them is low enough.
constexpr double not_evaluated = std::numeric_limits<double>::infinity();

/// Returns indices of points of a grid in ascending order: all points of every coarse interval
/// (`stride` grid intervals) that has a clearance of at most `most` at one of its ends. The
/// clearance changes along a rod by no more than the arc length; all other points therefore have a
/// clearance above `most` minus half a coarse interval.
/// @param s       arc lengths of the grid, equally spaced, a multiple of `stride` intervals
/// @param sample  returns samples of the shape at arc lengths
template <typename Sample>
std::vector<std::size_t> points_near_obstacle(const std::vector<double>& s, std::size_t stride,
                                              double most,
                                              const std::vector<const obstacle::Body*>& bodies,
                                              const Sample& sample) {
  std::vector<double> coarse;
  for (std::size_t i = 0; i < s.size(); i += stride) coarse.push_back(s[i]);
  const Samples samples = sample(coarse);
  Eigen::VectorXd least = Eigen::VectorXd::Constant(samples.points.cols(), not_evaluated);
  for (const obstacle::Body* body : bodies) {
    least = least.cwiseMin(body->clearances(samples.points));
  }
  std::vector<std::size_t> result;
  for (std::size_t k = 0; k + 1 < coarse.size(); ++k) {
    const auto at = static_cast<Eigen::Index>(k);
    if (std::min(least[at], least[at + 1]) > most) continue;
    for (std::size_t i = k * stride; i <= (k + 1) * stride; ++i) {
      if (result.empty() || result.back() < i) result.push_back(i);
    }
  }
  return result;
}

/// Finds the smallest clearance between `low` and `high` by Newton's method from `at`.
GapMinimum smallest_clearance(const Span::Obstacle& obstacle, const SpanShape& shape, double low,
                              double at, double high) {
  GapMinimum lowest{obstacle, at, std::numeric_limits<double>::infinity()};
  for (int k = 0; k < newton_steps; ++k) {
    const Clearance here = clearance_at(obstacle.body, shape.sample(std::array{at}), 0);
    if (here.value < lowest.clearance) lowest = {obstacle, at, here.value};
    if (!(here.rate > 0)) break;
    at = std::clamp(at - here.slope / here.rate, low, high);
  }
  lowest.feature = obstacle.body.feature(shape.sample(std::array{lowest.s}).points.col(0));
  return lowest;
}

/// Adds minima of the clearance below `below` beyond the ends of the obstacle's contacts, closer
/// than `reach`.
void add_minima_beside_contacts(const Span& span, const Span::Obstacle& obstacle,
                                const SpanShape& shape, double below, double reach,
                                std::vector<GapMinimum>& found) {
  const auto scan = [&](double end, double first_step) {
    std::vector<double> s;
    for (double step = first_step; std::ssize(s) < halvings_beside_contact; step /= 2) {
      s.push_back(std::clamp(end + step, 0.0, span.length));
    }
    const Eigen::VectorXd clearance = obstacle.body.clearances(shape.sample(s).points);
    for (Eigen::Index k = 1; k + 1 < clearance.size(); ++k) {
      // At least two thirds of the depth at a minimum occur at one of these points.
      const bool is_low = clearance[k] < below / 2;
      if (!is_low || clearance[k] > clearance[k - 1] || clearance[k] >= clearance[k + 1]) continue;
      const auto at = static_cast<std::size_t>(k);
      const double low = std::min(s[at - 1], s[at + 1]);
      const double high = std::max(s[at - 1], s[at + 1]);
      const GapMinimum lowest = smallest_clearance(obstacle, shape, low, s[at], high);
      // The grid may already have found it.
      const bool known = std::ranges::any_of(found, [&](const GapMinimum& other) {
        return other.obstacle.index == obstacle.index && other.s >= low && other.s <= high;
      });
      if (lowest.clearance < below && !known) found.push_back(lowest);
    }
  };
  for (const Span::Contact& contact : span.contacts) {
    if (contact.obstacle.index != obstacle.index) continue;
    scan(contact.begin, -reach);
    scan(contact.end, reach);
  }
}

/// Number of grid points. Between two of them a shape of curvature k penetrates l^2 k / (8 grid^2)
/// deeper, 3e-8 l for k = 1/l.
constexpr Eigen::Index penetration_grid = 2001;

bool is_rigid(const Obstacle& obstacle) { return std::isinf(obstacle.stiffness); }

/// Returns the largest depth of a shape within a body [m], negative if the shape is outside. A body
/// of small radius may lie between grid points; where the shape may be deeper there than `enough`,
/// it is sampled again 16 times as densely, at most four times.
double depth_within(const obstacle::Body& body, const Equilibrium& shape, std::vector<double> s,
                    double h, const Samples& grid, double enough) {
  constexpr int subdivisions = 16;
  constexpr int most_levels = 4;
  Eigen::VectorXd clearance = body.clearances(grid.points);
  double deepest = -clearance.minCoeff();
  const double length = s.back();
  for (int level = 0; level < most_levels; ++level) {
    const double sag = h * h / (8 * body.smallest_radius());
    if (!(sag > enough)) break;
    std::vector<double> between;
    for (std::size_t i = 0; i < s.size(); ++i) {
      const double here = clearance[static_cast<Eigen::Index>(i)];
      if (here - sag > -std::max(deepest, enough)) continue;
      for (int k = 1 - subdivisions; k < subdivisions; ++k) {
        const double at = s[i] + h * k / subdivisions;
        if (k != 0 && at >= 0 && at <= length) between.push_back(at);
      }
    }
    if (between.empty()) break;
    std::sort(between.begin(), between.end());
    s = std::move(between);
    clearance = body.clearances(shape.sample(s).points);
    deepest = std::max(deepest, -clearance.minCoeff());
    h /= subdivisions;
  }
  return deepest;
}

/// Returns the grid points that may be within a rigid obstacle or adjacent to an unsampled part
/// within one, and the ends.
std::vector<double> near_obstacles(const Problem& problem, const Equilibrium& shape) {
  constexpr std::size_t stride = 40;
  const std::vector<double> s = equal_arc_lengths(problem.length, penetration_grid);
  // Half a coarse interval, plus what may lie between two points.
  const double most = (static_cast<double>(stride) / 2 + 2) * s[1];
  std::vector<const obstacle::Body*> bodies;
  for (const Obstacle& obstacle : problem.obstacles) {
    if (is_rigid(obstacle)) bodies.push_back(&obstacle.body);
  }
  std::vector<double> near = {s.front()};
  for (const std::size_t i : points_near_obstacle(s, stride, most, bodies, shape.sample)) {
    if (i > 0) near.push_back(s[i]);
  }
  if (near.back() < s.back()) near.push_back(s.back());
  return near;
}

/// Returns the largest depth within a rigid obstacle [m], and that obstacle; the depth is 0 if the
/// shape is outside all of them.
Penetration penetration(const Problem& problem, const Equilibrium& shape) {
  const double h = problem.length / (penetration_grid - 1);
  const std::vector<double> s = near_obstacles(problem, shape);
  const Samples grid = shape.sample(s);
  Penetration deepest;
  for (std::size_t i = 0; i < problem.obstacles.size(); ++i) {
    const Obstacle& obstacle = problem.obstacles[i];
    if (!is_rigid(obstacle)) continue;
    const double depth =
        depth_within(obstacle.body, shape, s, h, grid, allowed_penetration * problem.length);
    if (depth > deepest.depth) deepest = {depth, i};
  }
  return deepest;
}

/// Largest pull of an obstacle, divided by the scale of all forces, that counts as rounding.
constexpr double tensile_tolerance = 1e-7;
/// Length, divided by the span's length: a shorter part in contact becomes a point.
constexpr double shortest_part = 1e-6;
/// Length, divided by the span's length. A contact is extended to include the point of largest
/// depth if that is less than twice this length away, and by at most half of this length beyond it.
constexpr double contact_extension = 0.01;
/// Length between two contacts, divided by the span's length, and rise of the free part between
/// them, divided by its length, below which both contacts are joined.
constexpr double joining_gap = 0.02;
constexpr double least_rise = 1e-3;

/// Returns the largest clearance at 15 points between two arc lengths.
double highest(const SpanShape& shape, const Span::Obstacle& obstacle, double from, double to) {
  constexpr int samples = 16;
  std::vector<double> s;
  for (int i = 1; i < samples; ++i) s.push_back(from + (to - from) * i / samples);
  const Samples inside = shape.sample(s);
  return obstacle.body.clearances(inside.points).maxCoeff();
}

class Contacts {
 public:
  Contacts(const SpanSolution& solution, Resolution resolution)
      : solution_(solution),
        span_(solution.model->span()),
        shape_(solution.model->shape(solution.x)),
        pull_(-tensile_tolerance * solution.scale_of_forces()),
        resolution_(resolution),
        contacts_(span_.contacts) {}

  [[nodiscard]] std::optional<std::vector<Span::Contact>> updated() {
    for (Span::Contact& contact : contacts_) {
      const double middle = (contact.begin + contact.end) / 2;
      contact.feature =
          contact.obstacle.body.feature(shape_.sample(std::array{middle}).points.col(0));
    }
    release_tensile();
    join();
    has_changed_ = wrong_;
    const double depth =
        resolution_ == Resolution::resolved ? contact_tolerance : coarse_contact_tolerance;
    for (const GapMinimum& lowest : gap_minima(span_, shape_, -depth * span_.length)) {
      wrong_ = true;
      add(lowest);
    }
    if (!wrong_) return std::nullopt;
    return std::move(contacts_);
  }

 private:
  /// Removes contact points at which the obstacle would have to pull, and replaces parts that it
  /// would have to pull, or that are too short, by one or two points.
  void release_tensile() {
    const std::vector<ContactForce> forces =
        solution_.model->contact_forces(*solution_.at_x(), solution_.multipliers);
    std::vector<Span::Contact> kept;
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
      Span::Contact contact = contacts_[i];
      const ContactForce& force = forces[i];
      if (!contact.lies()) {
        if (force.total >= pull_) kept.push_back(contact);
        continue;
      }
      const double length = contact.end - contact.begin;
      const bool pulled_along =
          resolution_ == Resolution::resolved && force.least_pressure * length < pull_;
      const bool lifted = force.least_inner_force < pull_ || pulled_along;
      // The rod carries no force beyond a free end.
      const bool begin_pulls = contact.begin > 0 && force.begin < pull_;
      const bool end_pulls = contact.end < span_.length && force.end < pull_;
      if (begin_pulls || end_pulls || lifted || length < shortest_part * span_.length) {
        wrong_ = true;
        double at = (contact.begin + contact.end) / 2;
        if (begin_pulls && !end_pulls) at = contact.end;
        if (end_pulls && !begin_pulls) at = contact.begin;
        // The obstacle pushes only at the ends: the rod leaves the obstacle between them.
        const bool inside = contact.begin > 0 && contact.end < span_.length;
        if (inside && pulled_along && !begin_pulls && !end_pulls &&
            length > joining_gap * span_.length) {
          Span::Contact first = contact;
          first.end = first.begin;
          kept.push_back(first);
          at = contact.end;
          second_split_points_.push_back(at);
        }
        contact.begin = contact.end = at;
      }
      kept.push_back(contact);
    }
    wrong_ = wrong_ || kept.size() != contacts_.size();
    contacts_ = std::move(kept);
  }

  void join() {
    for (std::size_t i = 0; i + 1 < contacts_.size();) {
      Span::Contact& here = contacts_[i];
      const Span::Contact& next = contacts_[i + 1];
      const bool split =
          std::ranges::find(second_split_points_, next.begin) != second_split_points_.end();
      if (split || !should_join(here, next)) {
        ++i;
        continue;
      }
      here.end = std::max(here.end, next.end);
      contacts_.erase(contacts_.begin() + static_cast<std::ptrdiff_t>(i) + 1);
      wrong_ = true;
    }
  }

  /// Adds a contact where the rod is within an obstacle. If a contact is close, it is extended to
  /// include the point; if the rod is within the obstacle all the way to the tip, it is extended to
  /// the tip.
  void add(const GapMinimum& lowest) {
    const double length = span_.length;
    for (Span::Contact& contact : contacts_) {
      const bool same = contact.obstacle.index == lowest.obstacle.index;
      if (!same || contact.feature != lowest.feature) continue;
      if (lowest.s == length && contact.end < length &&
          highest(shape_, contact.obstacle, contact.end, length) < 0) {
        contact.end = length;
        return;
      }
      const double reach = contact_extension * length;
      const bool beside =
          lowest.s > contact.begin - 2 * reach && lowest.s < contact.end + 2 * reach;
      if (!beside) continue;
      // Near a contact that has just changed the present shape is not meaningful.
      if (has_changed_) return;
      // A point that becomes a part has its ends closer than the point of largest depth.
      const double away = std::max({contact.begin - lowest.s, lowest.s - contact.end, 0.0});
      const bool is_short = contact.end - contact.begin < reach;
      const double more = is_short ? std::min(away / 4, reach / 2) : reach / 2;
      contact.begin = std::max(0.0, std::min(contact.begin, lowest.s) - more);
      contact.end = std::min(length, std::max(contact.end, lowest.s) + more);
      return;
    }
    const double at = std::clamp(lowest.s, 0.0, length);
    contacts_.push_back({lowest.obstacle, at, at, true, lowest.feature});
    std::ranges::sort(contacts_, {}, &Span::Contact::begin);
  }

  /// Whether a contact and the next one should be joined: they are with the same feature of the
  /// same obstacle, and between them the rod hardly leaves it or is within it.
  [[nodiscard]] bool should_join(const Span::Contact& here, const Span::Contact& next) const {
    if (here.obstacle.index != next.obstacle.index || here.feature != next.feature) return false;
    const double gap = next.begin - here.end;
    const double rise = highest(shape_, here.obstacle, here.end, next.begin);
    // A shorter free part could not be resolved.
    return rise < 0 || (gap < joining_gap * span_.length && rise < least_rise * gap);
  }

  const SpanSolution& solution_;
  const Span& span_;
  SpanShape shape_;
  double pull_;
  Resolution resolution_;
  std::vector<Span::Contact> contacts_;
  std::vector<double>
      second_split_points_;  // second points of parts that were split into two points
  bool wrong_ = false;
  bool has_changed_ = false;  // contacts_ differ from the contacts of the shape
};

}  // namespace

Clearance clearance_at(const obstacle::Body& body, const Samples& samples, Eigen::Index i) {
  const obstacle::Gap gap = body.gap(samples.points.col(i));
  const Eigen::Vector3d t = samples.tangents.col(i);
  return {gap.value, gap.gradient.dot(t),
          gap.gradient.dot(samples.curvature.col(i)) + t.dot(gap.hessian * t)};
}

std::vector<GapMinimum> gap_minima(const Span& span, const SpanShape& shape, double below) {
  const std::vector<double> s = equal_arc_lengths(span.length, grid_points);
  // Half a coarse interval, plus one neighbouring point and the sag between points.
  const double most = below + (static_cast<double>(coarse_stride) / 2 + 3) * s[1];
  std::vector<const obstacle::Body*> bodies;
  for (const Span::Obstacle& obstacle : span.rigid_obstacles) bodies.push_back(&obstacle.body);
  std::vector<std::size_t> evaluated = points_near_obstacle(
      s, coarse_stride, most, bodies, [&](const auto& coarse) { return shape.sample(coarse); });
  if (evaluated.empty()) evaluated.push_back(0);
  std::vector<double> near;
  near.reserve(evaluated.size());
  for (const std::size_t i : evaluated) near.push_back(s[i]);
  const Samples grid = shape.sample(near);
  const double h = s[1];
  const double bent = grid.curvature.colwise().norm().maxCoeff();
  std::vector<GapMinimum> found;
  for (const Span::Obstacle& obstacle : span.rigid_obstacles) {
    // Between two grid points the clearance may be lower by this amount.
    const double sag = h * h / 8 * (bent + 1 / obstacle.body.smallest_radius());
    Eigen::VectorXd clearance = Eigen::VectorXd::Constant(grid_points, not_evaluated);
    const Eigen::VectorXd found_near = obstacle.body.clearances(grid.points);
    for (std::size_t k = 0; k < evaluated.size(); ++k) {
      clearance[static_cast<Eigen::Index>(evaluated[k])] = found_near[static_cast<Eigen::Index>(k)];
    }
    for (Eigen::Index i = 0; i < grid_points; ++i) {
      const bool is_decreasing = i == 0 || clearance[i] < clearance[i - 1];
      const bool is_increasing = i + 1 == grid_points || clearance[i] <= clearance[i + 1];
      if (!is_decreasing || !is_increasing || clearance[i] > below + 2 * sag) continue;
      const double low = s[static_cast<std::size_t>(std::max<Eigen::Index>(0, i - 1))];
      const double high = s[static_cast<std::size_t>(std::min(grid_points - 1, i + 1))];
      const double at = s[static_cast<std::size_t>(i)];
      GapMinimum lowest = smallest_clearance(obstacle, shape, low, at, high);
      if (lowest.clearance < below) found.push_back(std::move(lowest));
    }
    add_minima_beside_contacts(span, obstacle, shape, below, h, found);
  }
  std::ranges::sort(found, {}, &GapMinimum::s);
  return found;
}

Penetration judge_penetration(const Problem& problem, Equilibrium& equilibrium) {
  if (std::ranges::none_of(problem.obstacles, is_rigid)) return {};
  const double l = problem.length;
  const Penetration deepest = penetration(problem, equilibrium);
  equilibrium.penetration = deepest.depth;
  if (!succeeded(equilibrium.status)) return deepest;
  if (equilibrium.penetration <= allowed_penetration * l) return deepest;
  std::ostringstream why;
  why.precision(2);
  why << "the shape penetrates a rigid obstacle by " << equilibrium.penetration
      << " m = " << equilibrium.penetration / l << " l (allowed: at most " << allowed_penetration
      << " l)";
  equilibrium.status = SolveStatus::not_verified;
  equilibrium.message = std::string(to_string(equilibrium.status)) + ": " + why.str();
  return deepest;
}

std::optional<std::vector<Span::Contact>> updated_contacts(const SpanSolution& solution,
                                                           Resolution resolution) {
  return Contacts(solution, resolution).updated();
}

}  // namespace dlo::energy_model
