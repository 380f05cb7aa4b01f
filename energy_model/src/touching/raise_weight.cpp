#include "touching/raise_weight.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "base/sized_samples.hpp"
#include "dlo/energy_model/natural_frame.hpp"
#include "problem/rod_law.hpp"
#include "touching/confirm_contacts.hpp"

namespace dlo::energy_model {
namespace {

constexpr double first_gamma = 1e-3;     // straight but for 1e-4 l
constexpr double smallest_ratio = 1e-4;  // of a step of ln(weight)
constexpr double way_tolerance = 1e-10;  // of the integrator, but for the last shape
constexpr double allowed_depth = 1e-9;   // of the tip, in l; a tenth of a converged shape's
constexpr Eigen::Index sampled = 129;    // points of a shape, to see where it is deepest
constexpr Eigen::Index compared = 17;    // points of two shapes
constexpr int most_changes = 4;
constexpr double longest_tangent_change = 0.3;  // of tangents: further away there is another branch

double gamma_of(const Problem& problem) {
  const double l = problem.length;
  double force = l * problem.weight_per_length.norm();
  for (const Load& load : problem.loads) force += load.force.norm();
  for (const LineLoad& load : problem.line_loads) force += load.between(0, l).norm();
  return force * l * l / bending_unit(problem);
}

Problem with_share(Problem problem, double share) {
  problem.weight_per_length *= share;
  for (Load& load : problem.loads) load.force *= share;
  for (LineLoad& load : problem.line_loads) {
    load.at_begin *= share;
    load.at_end *= share;
  }
  return problem;
}

Equilibrium straight(const Problem& problem) {
  Equilibrium shape;
  shape.grips.resize(1);
  const bool directors = has_material_directors(problem);
  const Eigen::Vector3d d1 =
      directors ? Eigen::Vector3d(first_frame(problem).col(0)) : Eigen::Vector3d::Zero();
  shape.sample = [clamp = problem.grips.front(), length = problem.length, directors,
                  d1](std::span<const double> arc_lengths) {
    Samples samples = sized_samples(arc_lengths, length);
    if (directors) samples.d1 = d1.replicate(1, samples.points.cols());
    const Eigen::Vector3d t = clamp.direction->normalized();
    for (std::size_t i = 0; i < arc_lengths.size(); ++i) {
      const auto column = static_cast<Eigen::Index>(i);
      samples.points.col(column) = clamp.position + arc_lengths[i] * t;
      samples.tangents.col(column) = t;
      samples.curvature.col(column).setZero();
    }
    return samples;
  };
  return shape;
}

/// As a start under a load that is larger by a factor.
Equilibrium scaled(Equilibrium shape, double factor) {
  for (Reaction& grip : shape.grips) grip.force *= factor;
  for (ContactPart& contact : shape.contacts) {
    contact.force *= factor;
    contact.begin_force *= factor;
    contact.end_force *= factor;
  }
  return shape;
}

/// What the signs of gap, force and slope ask of the end's contact, or nothing where they are as
/// they have to be.
std::optional<std::vector<ContactPart>> other_contacts(const Problem& problem,
                                                       const Equilibrium& shape) {
  const double l = problem.length;
  const Samples tip = shape.sample(std::vector<double>{l});
  if (shape.contacts.empty()) {
    double lowest = -allowed_depth * l;
    std::vector<ContactPart> touched;
    for (std::size_t k = 0; k < problem.obstacles.size(); ++k) {
      const double gap = problem.obstacles[k].body.clearance(tip.points.col(0));
      if (gap >= lowest) continue;
      lowest = gap;
      touched = {{.obstacle = k, .kind = ContactKind::tip, .begin = l, .end = l}};
    }
    if (touched.empty()) return std::nullopt;
    return touched;
  }
  ContactPart contact = shape.contacts.front();
  if (contact.kind != ContactKind::tip) return std::nullopt;
  const Eigen::Vector3d normal = problem.obstacles[contact.obstacle].body.normal();
  if (contact.force.dot(normal) < 0) return std::vector<ContactPart>();
  if (tip.tangents.col(0).dot(normal) <= 1e-12) return std::nullopt;
  // It has come up from within the obstacle: what lies begins about where it is deepest.
  const Samples along = shape.sample(equal_arc_lengths(l, sampled));
  Eigen::Index deepest = sampled - 2;
  while (deepest > 1 && along.tangents.col(deepest).dot(normal) > 0) --deepest;
  contact.kind = ContactKind::lying;
  contact.begin = along.arc_length[static_cast<std::size_t>(deepest)];
  contact.begin_force = contact.force.norm();
  return std::vector<ContactPart>{contact};
}

/// With the contact that its signs ask for. @return nothing if the shots could not be closed
std::optional<Equilibrium> solve_from(const Problem& problem, Equilibrium start,
                                      const Deadline& deadline) {
  for (int changes = 0; changes < most_changes; ++changes) {
    std::optional<Equilibrium> found = close_contacts(problem, start, way_tolerance, deadline);
    if (!found) return std::nullopt;
    if (!found->sample) {
      // What lay may have come to an end: then only the tip touches.
      if (start.contacts.empty() || start.contacts.front().kind != ContactKind::lying) {
        return std::nullopt;
      }
      start.contacts.front().kind = ContactKind::tip;
      start.contacts.front().begin = problem.length;
      continue;
    }
    found->evaluations += start.evaluations;
    std::optional<std::vector<ContactPart>> other = other_contacts(problem, *found);
    if (!other) return found;
    start = *std::move(found);
    start.contacts = *std::move(other);
  }
  return std::nullopt;
}

bool is_next(const Equilibrium& before, const Equilibrium& after, double length) {
  const std::vector<double> at = equal_arc_lengths(length, compared);
  const Eigen::Matrix3Xd change = after.sample(at).tangents - before.sample(at).tangents;
  return change.colwise().norm().maxCoeff() < longest_tangent_change;
}

bool is_one_clamp_over_planes(const Problem& problem) {
  const Grip& grip = problem.grips.front();
  const bool clamped = problem.grips.size() == 1 && grip.at == 0 && grip.direction;
  return clamped && can_confirm(problem) && gamma_of(problem) > first_gamma &&
         std::ranges::all_of(problem.obstacles, [](const Obstacle& obstacle) {
           return obstacle.body.is_half_space();
         });
}

}  // namespace

std::optional<Equilibrium> raise_weight(const Problem& problem, double tolerance,
                                        const Deadline& deadline) {
  check(problem);
  if (!is_one_clamp_over_planes(problem)) return std::nullopt;
  double share = first_gamma / gamma_of(problem);
  double ratio = 0.3;
  std::optional<Equilibrium> shape =
      solve_from(with_share(problem, share), straight(problem), deadline);
  if (!shape) share = 0;
  while (shape && share < 1 && ratio > smallest_ratio && !deadline.passed()) {
    const double next = std::min(1.0, share * std::exp(ratio));
    std::optional<Equilibrium> trial =
        solve_from(with_share(problem, next), scaled(*shape, next / share), deadline);
    if (!trial || !is_next(*shape, *trial, problem.length)) {
      ratio /= 2;
      continue;
    }
    shape = std::move(trial);
    share = next;
    ratio = std::min(0.5, 1.5 * ratio);
  }
  if (share == 1) {
    std::optional<Equilibrium> result = confirm_contacts(problem, *shape, tolerance, deadline);
    if (result) result->evaluations += shape->evaluations;
    return result;
  }
  Equilibrium result;
  result.status = deadline.passed() ? SolveStatus::time_limit : SolveStatus::failed;
  if (shape) result.evaluations = shape->evaluations;
  result.message = "the end's contact could be followed up to " + std::to_string(share) +
                   " of weight and loads: beyond it folds or another part of the rod touches";
  return result;
}

}  // namespace dlo::energy_model
