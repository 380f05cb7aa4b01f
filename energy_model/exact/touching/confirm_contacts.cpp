#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "problem/rod_law.hpp"
#include "shooting/span_equilibrium.hpp"
#include "touching/contacts.hpp"

namespace dlo::energy_model {
namespace {

// Largest accepted depth, in l; a tenth of that of solve_energy().
constexpr double confirmed_depth = 1e-9;
// Largest accepted tensile contact force or pressure, divided by the largest grip force or 1 + the
// total load, whichever is larger.
constexpr double largest_tensile_force = 1e-7;
constexpr int samples = 8;  // parts per interval at whose ends pressures are computed
// Width in l below which a part is not halved further: no point within it is deeper than its ends
// by more than this.
constexpr double least_halved_width = 1e-9;
constexpr const char* integration_failed = "the integrator failed between two nodes";

/// A rod in contact that Newton's method has closed, in its own units, with the forces of its
/// contacts.
class ClosedRod {
 public:
  ClosedRod(const Problem& problem, const ContactStart& start, const SpanEquilibrium& closed,
            double tolerance)
      : problem_(problem),
        start_(start),
        closed_(closed),
        tolerance_(tolerance),
        force_unit_(bending_unit(problem) / (problem.length * problem.length)) {}

  void add_contacts(Equilibrium& result) const {
    result.obstacles.assign(problem_.obstacles.size(), Eigen::Vector3d::Zero());
    for (const PlacedContact& placed : start_.contacts) {
      ContactPart part = placed.part;
      part.begin = problem_.length * closed_.s[placed.begin];
      part.end = problem_.length * closed_.s[placed.end];
      part.begin_force = part.end_force = part.largest_pressure = 0;
      part.force = force_at(placed.begin_force);
      if (part.kind == ContactKind::lying) {
        part.force += force_at(placed.end_force);
        part.begin_force = force_unit_ * force_magnitude_at(placed.begin_force);
        part.end_force = force_unit_ * force_magnitude_at(placed.end_force);
        part.moment =
            problem_.length *
            (position_at(placed.end) - position_at(placed.begin)).cross(force_at(placed.end_force));
        for (Eigen::Index i = placed.begin; i < placed.end; ++i) {
          add_pressure(i, position_at(placed.begin), part);
        }
      }
      result.obstacles[part.obstacle] += part.force;
      result.contacts.push_back(part);
    }
  }

  /// Returns the reason why the contacts are not confirmed; empty: they are. Sets
  /// Equilibrium::penetration unless the integrator failed.
  [[nodiscard]] std::string contact_failure(Equilibrium& result) const {
    double largest = 1 + total_load(start_.span);
    for (const Reaction& grip : result.grips) {
      largest = std::max(largest, grip.force.norm() / force_unit_);
    }
    double depth = 0;
    double least = 0;
    for (Eigen::Index i = 0; i + 1 < closed_.s.size(); ++i) {
      const Surface* surface = closed_.contacts.surface_of(i);
      const std::vector<RodState> states = along(i);
      const double width = (closed_.s[i + 1] - closed_.s[i]) / samples;
      for (std::size_t k = 0; k < states.size(); ++k) {
        if (!states[k].r.allFinite()) return integration_failed;
        if (surface != nullptr) {
          least = std::min(least, pressure(*surface, section_of(i), states[k]));
        }
        if (k == 0) continue;
        const double s = closed_.s[i] + static_cast<double>(k - 1) * width;
        depth = std::max(depth, deepest(i, {s, width, states[k - 1], states[k]}, depth));
      }
    }
    if (!std::isfinite(depth)) return integration_failed;
    for (const RodContact& contact : closed_.contacts.nodes) least = std::min(least, contact.force);
    result.penetration = problem_.length * depth;
    if (depth > confirmed_depth) {
      return "the rod penetrates by " + std::to_string(result.penetration) +
             " m an obstacle that is not among the contacts of the start";
    }
    return least < -largest_tensile_force * largest ? "a contact force would have to be tensile"
                                                    : "";
  }

 private:
  [[nodiscard]] const RodSection& section_of(Eigen::Index i) const {
    return section_at(start_.span, (closed_.s[i] + closed_.s[i + 1]) / 2);
  }

  struct Part {
    double s = 0;
    double width = 0;
    RodState begin, end;
  };

  [[nodiscard]] bool lies_on(Eigen::Index i, std::size_t body) const {
    return std::any_of(start_.contacts.begin(), start_.contacts.end(), [&](const auto& contact) {
      return contact.part.kind == ContactKind::lying && contact.part.obstacle == body &&
             contact.begin <= i && i < contact.end;
    });
  }

  /// Returns the largest depth of a part in the bodies if it exceeds `known` by more than a
  /// hundredth and confirmed_depth; otherwise `known` or a depth of one of its points, whichever is
  /// larger. Halves the part until least_clearance() shows this. NaN: the integrator failed.
  [[nodiscard]] double deepest(Eigen::Index i, const Part& part, double known) const {
    double depth = known;
    double least = 0;
    const RodSection& section = section_of(i);
    const double force = std::max(part.begin.n.norm(), part.end.n.norm());
    const double moment = std::max(part.begin.m.norm(), part.end.m.norm());
    const double curvature =
        (moment + 2 * part.width * force) / section.stiffness().head<2>().minCoeff();
    for (std::size_t k = 0; k < start_.bodies.size(); ++k) {
      const obstacle::Body& body = start_.bodies[k];
      depth = std::max({depth, -body.clearance(part.begin.r), -body.clearance(part.end.r)});
      if (!lies_on(i, k)) least = std::min(least, least_clearance(body, part, curvature));
    }
    if (!(-least > 1.01 * depth + confirmed_depth) || part.width < least_halved_width) return depth;
    const double half = part.width / 2;
    RodState middle = part.begin;
    const RodElement piece{section, start_.span.natural, part.s, half,
                           closed_.contacts.surface_of(i)};
    if (!integrate_rod(piece, tolerance_, middle)) return NAN;
    depth = deepest(i, {part.s, half, part.begin, middle}, depth);
    return std::isnan(depth) ? depth : deepest(i, {part.s + half, half, middle, part.end}, depth);
  }

  /// Returns a lower bound of the clearance d of a part. Bodies are convex, so d'' along the rod is
  /// at least minus its curvature k. Then d - k x (w - x) / 2 is convex in x from 0 to the width w,
  /// and not below its tangents at the two ends.
  [[nodiscard]] static double least_clearance(const obstacle::Body& body, const Part& part,
                                              double curvature) {
    const obstacle::Gap begin = body.gap(part.begin.r);
    const obstacle::Gap end = body.gap(part.end.r);
    const double bend = curvature * part.width / 2;
    const double begin_slope = begin.gradient.dot(part.begin.t()) - bend;
    const double end_slope = end.gradient.dot(part.end.t()) + bend;
    if (begin_slope >= 0) return begin.value;
    if (end_slope <= 0) return end.value;
    const double x = (end.value - end_slope * part.width - begin.value) / (begin_slope - end_slope);
    return begin.value + begin_slope * std::clamp(x, 0.0, part.width);
  }

  /// Returns the states at equally spaced arc lengths of interval i, both ends included. Where the
  /// rod's state jumps at an end of the interval, the limit from within the interval is returned.
  [[nodiscard]] std::vector<RodState> along(Eigen::Index i) const {
    std::vector<RodState> states = {closed_.nodes[static_cast<std::size_t>(i)]};
    const double width = (closed_.s[i + 1] - closed_.s[i]) / samples;
    for (int k = 0; k < samples; ++k) {
      RodState state = states.back();
      const RodElement piece{section_of(i), start_.span.natural, closed_.s[i] + k * width, width,
                             closed_.contacts.surface_of(i)};
      if (!integrate_rod(piece, tolerance_, state)) state.r.setConstant(NAN);
      states.push_back(state);
    }
    return states;
  }

  [[nodiscard]] double force_magnitude_at(const std::optional<std::size_t>& contact) const {
    return contact ? closed_.contacts.nodes[*contact].force : 0;
  }

  [[nodiscard]] Eigen::Vector3d force_at(const std::optional<std::size_t>& contact) const {
    if (!contact) return Eigen::Vector3d::Zero();
    const RodContact& node = closed_.contacts.nodes[*contact];
    const Eigen::Vector3d& r = closed_.nodes[static_cast<std::size_t>(node.node)].r;
    return force_unit_ * node.force * node.gap(r).gradient;
  }

  [[nodiscard]] const Eigen::Vector3d& position_at(Eigen::Index node) const {
    return closed_.nodes[static_cast<std::size_t>(node)].r;
  }

  /// Adds the pressure on an interval that lies. The force is the part of the change of n that the
  /// weight does not cause; the moment about a point is integrated by Boole's rule.
  void add_pressure(Eigen::Index i, const Eigen::Vector3d& about, ContactPart& part) const {
    constexpr std::array<double, samples + 1> boole = {7, 32, 12, 32, 14, 32, 12, 32, 7};
    const std::vector<RodState> states = along(i);
    part.force += force_unit_ *
                  (states.front().n - states.back().n -
                   section_of(i).weight_of_interval(closed_.s[i], closed_.s[i + 1] - closed_.s[i]));
    const Surface& surface = *closed_.contacts.surface_of(i);
    const double share = (closed_.s[i + 1] - closed_.s[i]) / samples * 2 / 45;
    for (std::size_t k = 0; k < states.size(); ++k) {
      const RodState& state = states[k];
      const double p = pressure(surface, section_of(i), state);
      part.largest_pressure = std::max(part.largest_pressure, force_unit_ / problem_.length * p);
      part.moment += problem_.length * force_unit_ * share * boole[k] * p *
                     (state.r - about).cross(surface.gap(state.r).gradient);
    }
  }

  const Problem& problem_;
  const ContactStart& start_;
  const SpanEquilibrium& closed_;
  double tolerance_;
  double force_unit_;
};

}  // namespace

std::optional<Equilibrium> confirm_contacts(const Problem& problem, const Equilibrium& shape,
                                            double tolerance, const Deadline& deadline) {
  const bool rigid =
      std::none_of(problem.obstacles.begin(), problem.obstacles.end(),
                   [](const Obstacle& obstacle) { return std::isfinite(obstacle.stiffness); });
  if (!rigid || !problem.natural_strains.empty() || !shape.sample ||
      shape.grips.size() != problem.grips.size()) {
    return std::nullopt;
  }
  const std::optional<ContactStart> start = start_with_contacts(problem, shape, tolerance);
  if (!start) return std::nullopt;
  SpanEquilibrium closed = close_span(start->span, start->mesh, start->states, start->frames,
                                      {.tolerance = tolerance, .deadline = deadline});
  if (!closed.converged) {
    Equilibrium failed;
    failed.evaluations = closed.integrations;
    failed.residual = closed.residual;
    failed.status = deadline.passed() ? SolveStatus::time_limit : SolveStatus::failed;
    failed.message = "Newton's method did not converge with the contacts of the start";
    return failed;
  }
  complete(start->span, tolerance, closed);
  Equilibrium result = assemble(problem, {{start->span}, {closed}}, tolerance);
  const ClosedRod rod(problem, *start, closed, tolerance);
  rod.add_contacts(result);
  const std::string contact_failure = rod.contact_failure(result);
  if (!contact_failure.empty()) {
    result.status = SolveStatus::not_verified;
    result.message = contact_failure;
  }
  return result;
}

}  // namespace dlo::energy_model
