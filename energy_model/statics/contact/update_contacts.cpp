#include "contact/update_contacts.hpp"

#include <algorithm>
#include <array>

#include "contact/clearance.hpp"

namespace dlo::energy_model {
namespace {

/// Largest pull of an obstacle, divided by the scale of all forces, that counts as rounding.
constexpr double strongest_pull = 1e-7;
/// Length, divided by the rod length: a shorter part in contact becomes a point.
constexpr double shortest_part = 1e-6;
/// Length, divided by the rod length. A contact is extended to include the point of largest depth
/// if that is less than twice this length away, and by at most half of this length beyond it.
constexpr double first_part = 0.01;
/// Length between two contacts, divided by the rod length, and rise of the free part between them,
/// divided by its length, below which both contacts are joined.
constexpr double short_gap = 0.02;
constexpr double least_rise = 1e-3;

/// Returns the largest clearance between two arc lengths.
double highest(const SpanShape& shape, const Span::Obstacle& obstacle, double from, double to) {
  constexpr int samples = 16;
  std::vector<double> s;
  for (int i = 1; i < samples; ++i) s.push_back(from + (to - from) * i / samples);
  const SpanSamples inside = shape.sample(s);
  return obstacle.body.clearances(inside.points).maxCoeff();
}

class Contacts {
 public:
  Contacts(const SpanSolution& solution, double load, Resolution resolution)
      : solution_(solution),
        span_(solution.model->span()),
        shape_(solution.model->shape(solution.x)),
        pull_(-strongest_pull * (1 + load + solution.multipliers.norm())),
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
    unlike_ = wrong_;
    const double depth = resolution_ == Resolution::resolved ? deepest : deepest_coarse;
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
      const bool lifted = force.least_inner < pull_ || pulled_along;
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
            length > short_gap * span_.length) {
          Span::Contact first = contact;
          first.end = first.begin;
          kept.push_back(first);
          at = contact.end;
          split_.push_back(at);
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
      const bool split = std::find(split_.begin(), split_.end(), next.begin) != split_.end();
      if (split || !are_one(here, next)) {
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
      const double reach = first_part * length;
      const bool beside =
          lowest.s > contact.begin - 2 * reach && lowest.s < contact.end + 2 * reach;
      if (!beside) continue;
      // Near a contact that has just changed the present shape is not meaningful.
      if (unlike_) return;
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
    std::sort(contacts_.begin(), contacts_.end(),
              [](const auto& a, const auto& b) { return a.begin < b.begin; });
  }

  /// Whether a contact and the next one should be joined: they are with the same feature of the
  /// same obstacle, and between them the rod hardly leaves it or is within it.
  [[nodiscard]] bool are_one(const Span::Contact& here, const Span::Contact& next) const {
    if (here.obstacle.index != next.obstacle.index || here.feature != next.feature) return false;
    const double gap = next.begin - here.end;
    const double rise = highest(shape_, here.obstacle, here.end, next.begin);
    // A shorter free part could not be resolved.
    return rise < 0 || (gap < short_gap * span_.length && rise < least_rise * gap);
  }

  const SpanSolution& solution_;
  const Span& span_;
  SpanShape shape_;
  double pull_;
  Resolution resolution_;
  std::vector<Span::Contact> contacts_;
  std::vector<double> split_;  // second points of parts that were split into two points
  bool wrong_ = false;
  bool unlike_ = false;  // contacts_ differ from the contacts of the shape
};

}  // namespace

std::optional<std::vector<Span::Contact>> updated_contacts(const SpanSolution& solution,
                                                           double load, Resolution resolution) {
  return Contacts(solution, load, resolution).updated();
}

}  // namespace dlo::energy_model
