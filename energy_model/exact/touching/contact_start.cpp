#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "base/spin.hpp"
#include "problem/rod_law.hpp"
#include "shooting/span_equilibrium.hpp"
#include "shooting/span_search.hpp"
#include "touching/contacts.hpp"

namespace dlo::energy_model {
namespace {

constexpr double twist_step = 1e-4;  // distance over which the rotation of d1 is measured, in l

class Layout {
 public:
  Layout(const Problem& problem, const Equilibrium& shape)
      : problem_(problem),
        shape_(shape),
        l_(problem.length),
        force_unit_(bending_unit(problem) / (l_ * l_)) {
    start_.span = whole_span(problem);
    const Eigen::Vector3d& origin = problem.grips.front().position;
    for (const Obstacle& obstacle : problem.obstacles) {
      start_.bodies.push_back(obstacle.body.transformed(origin, Eigen::Matrix3d::Identity(), l_));
    }
    start_.frames = held_frames(start_.span);
  }

  [[nodiscard]] std::optional<ContactStart> run(double tolerance) {
    make_nodes();
    if (!place_contacts() || !are_contacts_separate()) return std::nullopt;
    sample();
    if (!has_material_directors(problem_)) {
      carry_frames(start_.span, start_.mesh, tolerance, start_.states);
    }
    if (!set_lying_forces(tolerance)) return std::nullopt;
    return std::move(start_);
  }

 private:
  /// Returns the arc length of an end, a grip, a load or a part of the rod if `s` is equal to it up
  /// to rounding; else `s`.
  [[nodiscard]] double snapped(double s) const {
    std::vector<double> fixed = {0, start_.span.length};
    for (const RodSpan::Hold& hold : start_.span.holds) fixed.push_back(hold.at);
    for (const RodSpan::Load& load : start_.span.loads) fixed.push_back(load.at);
    for (const RodSpan::Part& part : start_.span.parts) fixed.push_back(part.begin);
    for (const double at : fixed) {
      if (std::abs(at - s) < same_arc_length_share) return at;
    }
    return s;
  }

  void make_nodes() {
    double force = total_load(start_.span);
    for (const Reaction& grip : shape_.grips) {
      force = std::max(force, grip.force.norm() / force_unit_);
    }
    std::vector<double> touched;
    for (const ContactPart& contact : shape_.contacts) {
      for (const double at : {contact.begin, contact.end}) touched.push_back(snapped(at / l_));
    }
    std::sort(touched.begin(), touched.end());
    const auto is_duplicate = [](double a, double b) { return b - a < same_arc_length_share; };
    touched.erase(std::unique(touched.begin(), touched.end(), is_duplicate), touched.end());
    force = std::max(1.0, force / least_bending_stiffness(start_.span));
    const double longest = std::min(start_.span.length / 8, largest_growth / std::sqrt(force));
    start_.mesh = make_mesh(start_.span, longest, touched);
    start_.mesh.contacts.surface.resize(static_cast<std::size_t>(start_.mesh.intervals()));
  }

  [[nodiscard]] Eigen::Index node_at(double arc_length) const {
    return energy_model::node_at(start_.mesh.s, snapped(arc_length / l_) - same_arc_length_share);
  }

  [[nodiscard]] bool place_contacts() {
    for (const ContactPart& part : shape_.contacts) {
      PlacedContact placed{part, node_at(part.begin), node_at(part.end), {}, {}};
      if (part.kind == ContactKind::lying) {
        placed.begin_force = add_end(placed.begin, part.begin_force);
        placed.end_force = add_end(placed.end, part.end_force);
        const double middle = (start_.mesh.s[placed.begin] + start_.mesh.s[placed.end]) / 2;
        const Surface surface = surface_of(start_.bodies[part.obstacle], point_at(middle));
        for (Eigen::Index i = placed.begin; i < placed.end; ++i) {
          start_.mesh.contacts.surface[static_cast<std::size_t>(i)] = surface;
        }
        for (const auto& end : {placed.begin_force, placed.end_force}) {
          if (end) start_.mesh.contacts.nodes[*end].surface = surface;
        }
      } else {
        const bool is_fixed = start_.mesh.is_fixed(placed.begin);
        placed.begin_force = add_end(placed.begin, part.force.norm());
        if (!placed.begin_force) return false;
        start_.mesh.contacts.nodes.back().touched = start_.bodies[part.obstacle];
        if (is_fixed && part.kind != ContactKind::tip) return false;
      }
      start_.contacts.push_back(placed);
    }
    return std::ranges::is_sorted(start_.mesh.contacts.nodes, std::ranges::less_equal{},
                                  &RodContact::node);
  }

  /// Adds a node at which contact ends and a force may act. @return its index; std::nullopt at a
  /// grip
  std::optional<std::size_t> add_end(Eigen::Index node, double force) {
    if (start_.mesh.hold[static_cast<std::size_t>(node)] != nullptr) return std::nullopt;
    RodContact contact;
    contact.node = node;
    contact.is_position_unknown = !start_.mesh.is_fixed(node);
    contact.force = force / force_unit_;
    start_.mesh.contacts.nodes.push_back(contact);
    return start_.mesh.contacts.nodes.size() - 1;
  }

  /// Whether no grip, load or part is within a part that lies, and no such part is adjacent to
  /// another one.
  [[nodiscard]] bool are_contacts_separate() const {
    for (const PlacedContact& contact : start_.contacts) {
      for (Eigen::Index i = contact.begin + 1; i < contact.end; ++i) {
        if (start_.mesh.is_fixed(i)) return false;
      }
      const bool lies = contact.part.kind == ContactKind::lying;
      if (lies && start_.mesh.contacts.surface_of(contact.end) != nullptr) return false;
    }
    return true;
  }

  [[nodiscard]] Eigen::Vector3d point_at(double s) const {
    const Samples sample = shape_.sample(std::array{std::min(s, 1.0) * l_});
    return (sample.points.col(0) - problem_.grips.front().position) / l_;
  }

  /// Returns the strain about the tangent at s, for a shape with d1.
  [[nodiscard]] double twist_at(double s) const {
    const double from = std::max(0.0, s - twist_step);
    const double to = std::min(1.0, s + twist_step);
    const Samples sample = shape_.sample(std::array{from * l_, s * l_, to * l_});
    const Eigen::Vector3d t = sample.tangents.col(1);
    const Eigen::Vector3d d1 = sample.d1.col(1);
    return (sample.d1.col(2) - sample.d1.col(0)).dot(t.cross(d1)) / (to - from);
  }

  [[nodiscard]] double torque_at(double s) const {
    for (const TwistedPart& part : shape_.twists) {
      if (part.begin <= s * l_ && s * l_ <= part.end) return part.torque / (force_unit_ * l_);
    }
    return 0;
  }

  void sample() {
    const bool directors = has_material_directors(problem_);
    // The shape is sampled just after the nodes, at which its curvature may jump.
    std::vector<double> after;
    for (const double s : start_.mesh.s)
      after.push_back(std::min(s + same_arc_length_share, 1.0) * l_);
    const Samples at = shape_.sample(after);
    for (Eigen::Index i = 0; i < start_.mesh.s.size(); ++i) {
      const double s = start_.mesh.s[i];
      const bool last = i == start_.mesh.intervals();
      const Eigen::Vector3d t = at.tangents.col(i).normalized();
      RodState state;
      state.r = (at.points.col(i) - problem_.grips.front().position) / l_;
      state.R = frame_along(t, directors ? Eigen::Vector3d(at.d1.col(i)) : t.unitOrthogonal());
      if (!last) {
        const RodSection& section = start_.mesh.section_of(i);
        const Eigen::Vector3d bent = l_ * at.curvature.col(i);
        const Eigen::Vector3d u(-bent.dot(state.R.col(1)), bent.dot(state.R.col(0)), 0);
        state.m = state.R * section.stiffness().cwiseProduct(u) +
                  (directors ? section.torsion * twist_at(s) : torque_at(s)) * t;
        state.n = force_after(i);
      }
      start_.states.push_back(state);
    }
  }

  /// Returns n just after a node, from the actions of the shape's grips, contacts and loads before
  /// it.
  [[nodiscard]] Eigen::Vector3d force_after(Eigen::Index node) const {
    Eigen::Vector3d force = implied_force(problem_, shape_, start_.mesh.s[node]);
    for (const PlacedContact& contact : start_.contacts) {
      if (contact.end <= node) force -= contact.part.force / force_unit_;
    }
    return force;
  }

  /// Sets n of parts that lie. At the begin its component across the surface follows from the lying
  /// conditions; from there on the pressure of the surface is integrated.
  [[nodiscard]] bool set_lying_forces(double tolerance) {
    for (const PlacedContact& contact : start_.contacts) {
      for (Eigen::Index i = contact.begin; i < contact.end; ++i) {
        RodState& state = start_.states[static_cast<std::size_t>(i)];
        if (i == contact.begin) {
          const Surface& surface = *start_.mesh.contacts.surface_of(i);
          const Eigen::Vector3d normal = surface.gap(state.r).gradient;
          const LyingConditions lying = lying_conditions(surface, start_.mesh.section_of(i), state);
          const double by = lying.by_state.row(3).tail<3>().dot(normal);
          state.n -= lying.values[3] / by * normal;
        }
        if (i + 1 == contact.end) break;
        RodState end = state;
        if (!integrate_rod(rod_element(start_.span, start_.mesh, i), tolerance, end)) {
          return false;
        }
        start_.states[static_cast<std::size_t>(i + 1)].n = end.n;
      }
    }
    return true;
  }

  const Problem& problem_;
  const Equilibrium& shape_;
  double l_;
  double force_unit_;
  ContactStart start_;
};

}  // namespace

std::optional<ContactStart> start_with_contacts(const Problem& problem, const Equilibrium& shape,
                                                double tolerance) {
  return Layout(problem, shape).run(tolerance);
}

}  // namespace dlo::energy_model
