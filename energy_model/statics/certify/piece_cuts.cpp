#include "certify/piece_cuts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace dlo::energy_model {
namespace {

/// Number of points at which a shape is sampled between two kinks.
constexpr Eigen::Index shape_samples = 4096;

/// A cause of bending that is confined to a length of its own.
struct BendingFeature {
  double at = 0;
  double length = 0;  // 0: a free end, where the rod is not bent
};

/// Returns the force of weight, loads and grips that the rod carries at s, up to its sign.
Eigen::Vector3d internal_force_at(const SpanSolution& solution, double s) {
  const Span& span = solution.model->span();
  const Eigen::Index axes = span.planar ? 2 : 3;
  const bool after = s > span.anchor;
  Eigen::Vector3d n = after ? span.weight_between(s, span.length) : span.weight_between(0, s);
  for (const Span::Load& load : span.loads) {
    if (after == (load.at > s)) n += load.force;
  }
  for (std::size_t j = 0; j < span.holds.size(); ++j) {
    if (after != (span.holds[j].at > s)) continue;
    n.head(axes) += solution.multipliers.segment(static_cast<Eigen::Index>(j) * axes, axes);
  }
  return n;
}

double stiffness_at(const Span& span, double s) {
  for (const Span::Part& part : span.parts) {
    if (s > part.begin && s < part.end) return part.stiffness.head<2>().minCoeff();
  }
  return span.stiffness.head<2>().minCoeff();
}

/// Returns the boundary layer at a kink, on one side of it, with the length (EI / force)^(1/2).
BendingFeature boundary_layer_at(const SpanSolution& solution, double at, double sense) {
  const Span& span = solution.model->span();
  const bool free_begin = at < closest_cuts && !span.start_direction && span.anchor > 0;
  const bool gripped_end = !span.holds.empty() && span.holds.back().at > span.length - closest_cuts;
  const bool free_end =
      at > span.length - closest_cuts && !gripped_end && span.anchor < span.length;
  if (free_begin || free_end) return {at, 0};
  const double s = at + sense * 1e-6 * span.length;
  const double force = std::max(1.0, internal_force_at(solution, s).norm());
  return {at, std::sqrt(stiffness_at(span, s) / force)};
}

/// Returns the maxima of the curvature among the points up to twice 2 / curvature away, the length
/// of an elastica that turns back there, if the curvature at that distance has decreased on both
/// sides to at most `peak_share` of the maximum.
std::vector<BendingFeature> curvature_peaks(const SpanSolution& solution, double begin,
                                            double end) {
  constexpr double peak_share = 0.6;
  constexpr double widths = 2;
  const Eigen::VectorXd at = Eigen::VectorXd::LinSpaced(shape_samples, begin, end);
  const Eigen::VectorXd curvature =
      solution.model->shape(solution.x)
          .sample({at.data(), static_cast<std::size_t>(shape_samples)})
          .curvature.colwise()
          .norm();
  const double h = (end - begin) / static_cast<double>(shape_samples - 1);
  std::vector<BendingFeature> peaks;
  for (Eigen::Index i = 1; i + 1 < shape_samples; ++i) {
    const double length = 2 / curvature[i];
    if (!(widths * length < end - begin)) continue;
    const auto half_window = static_cast<Eigen::Index>(widths * length / h) + 1;
    if (half_window > i || i + half_window >= shape_samples) continue;
    if (curvature.segment(i - half_window, 2 * half_window + 1).maxCoeff() > curvature[i]) continue;
    if (std::max(curvature[i - half_window], curvature[i + half_window]) >
        peak_share * curvature[i])
      continue;
    peaks.push_back({at[i], length});
    i += half_window;
  }
  return peaks;
}

/// Number of intervals at whose ends a shape is sampled first.
constexpr Eigen::Index first_intervals = 400;

/// Distance, divided by the rod length, below which two ends count as one.
constexpr double closest_contact_ends = 1e-7;

/// Number of parts into which a bracket is divided repeatedly, and its final width, divided by the
/// span's length.
constexpr int bracket_parts = 32;
constexpr double shortest_bracket = 1e-13;

/// Smallest jump of the unit gradient of the depth that counts as a ridge; where a face meets a
/// round edge the gradient is continuous.
constexpr double least_jump = 1e-3;

/// Distance from the core of a cylinder, divided by the span's length, below which its force
/// changes its direction too fast for the nodes of a whole element.
constexpr double near_core_distance = 0.05;

/// An interval in which the contact state of the rod changes; of zero width beside a thin core.
struct Bracket {
  std::size_t obstacle = 0;
  double begin = 0;
  double end = 0;
};

constexpr int outside_body = -1;

/// Returns the face, edge or corner into which a point presses; `outside_body` if it is outside the
/// body.
int pressed_feature(const obstacle::Body& body, const Eigen::Vector3d& point) {
  return body.clearance(point) < 0 ? body.feature(point) : outside_body;
}

/// Appends equally spaced points from `begin` to `end`, both included.
void append_divided(double begin, double end, std::vector<double>& s) {
  for (int i = 0; i <= bracket_parts; ++i) s.push_back(begin + (end - begin) * i / bracket_parts);
}

/// Whether a body is a cylinder, a capsule or a ball, in which the force changes its direction at
/// the core.
bool has_thin_core(const obstacle::Body& body) {
  return ((body.upper() - body.lower()).array() == 0).count() >= 2;
}

/// Returns the brackets of all obstacles, found on equally spaced arc lengths. It also finds dips
/// between two of these that reach into an obstacle. It adds brackets of zero width where the rod
/// comes so close to a thin core that forces change their direction within a short distance, which
/// requires close nodes.
std::vector<Bracket> brackets_of(const std::vector<Span::SoftObstacle>& obstacles,
                                 const SpanShape& shape, double length) {
  const std::vector<double> s = equal_arc_lengths(length, first_intervals + 1);
  const Eigen::Matrix3Xd points = shape.sample(s).points;
  const double spacing = length / static_cast<double>(first_intervals);
  std::vector<Bracket> brackets;
  std::vector<Bracket> dips;
  for (std::size_t o = 0; o < obstacles.size(); ++o) {
    const obstacle::Body& body = obstacles[o].body;
    const Eigen::VectorXd clearance = body.clearances(points);
    int before = pressed_feature(body, points.col(0));
    for (Eigen::Index i = 1; i < points.cols(); ++i) {
      const auto at = static_cast<std::size_t>(i);
      const int here = pressed_feature(body, points.col(i));
      if (here != before) brackets.push_back({o, s[at - 1], s[at]});
      before = here;
      const bool dip = i + 1 < points.cols() && clearance[i] >= 0 && clearance[i] < spacing &&
                       clearance[i] <= clearance[i - 1] && clearance[i] <= clearance[i + 1];
      if (dip) dips.push_back({o, s[at - 1], s[at + 1]});
      const bool passes_core = i + 1 < points.cols() && clearance[i] < 0 && has_thin_core(body) &&
                               clearance[i] + body.radius() < near_core_distance * length &&
                               clearance[i] < clearance[i - 1] && clearance[i] <= clearance[i + 1];
      if (passes_core) brackets.push_back({o, s[at], s[at]});
    }
  }
  for (const Bracket& dip : dips) {
    std::vector<double> fine;
    append_divided(dip.begin, dip.end, fine);
    const Eigen::VectorXd clearance =
        obstacles[dip.obstacle].body.clearances(shape.sample(fine).points);
    for (std::size_t i = 1; i < fine.size(); ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      if ((clearance[k - 1] < 0) != (clearance[k] < 0)) {
        brackets.push_back({dip.obstacle, fine[i - 1], fine[i]});
      }
    }
  }
  return brackets;
}

/// Narrows each bracket to the changes within it; to the first one if the others would be closer
/// than closest_contact_ends.
std::vector<Bracket> narrow_brackets(const std::vector<Span::SoftObstacle>& obstacles,
                                     const SpanShape& shape, const std::vector<Bracket>& brackets) {
  std::vector<double> s;
  for (const Bracket& bracket : brackets) append_divided(bracket.begin, bracket.end, s);
  const Eigen::Matrix3Xd points = shape.sample(s).points;
  std::vector<Bracket> result;
  std::size_t first = 0;
  for (const Bracket& bracket : brackets) {
    const obstacle::Body& body = obstacles[bracket.obstacle].body;
    const bool all = bracket.end - bracket.begin > closest_contact_ends;
    int before = pressed_feature(body, points.col(static_cast<Eigen::Index>(first)));
    const std::size_t already = result.size();
    for (std::size_t i = first + 1; i <= first + bracket_parts; ++i) {
      const int here = pressed_feature(body, points.col(static_cast<Eigen::Index>(i)));
      if (here != before) result.push_back({bracket.obstacle, s[i - 1], s[i]});
      if (here != before && !all) break;
      before = here;
    }
    // A change that rounding has moved out of the bracket is taken to be at its end.
    if (result.size() == already) {
      result.push_back({bracket.obstacle, s[first + bracket_parts - 1], s[first + bracket_parts]});
    }
    first += bracket_parts + 1;
  }
  return result;
}

std::vector<Bracket> shortest_brackets(const Span& span, const SpanShape& shape) {
  std::vector<Bracket> brackets = brackets_of(span.soft_obstacles, shape, span.length);
  for (double width = span.length / first_intervals;
       !brackets.empty() && width > shortest_bracket * span.length; width /= bracket_parts) {
    brackets = narrow_brackets(span.soft_obstacles, shape, brackets);
  }
  return brackets;
}

/// Whether a rod meets the core of a body within a bracket, to rounding.
bool meets_core(const obstacle::Body& body, const SpanShape& shape, Bracket bracket,
                double length) {
  constexpr double rounding = 1e-9;
  while (bracket.end - bracket.begin > rounding * length) {
    std::vector<double> s;
    append_divided(bracket.begin, bracket.end, s);
    Eigen::Index nearest = 0;
    body.clearances(shape.sample(s).points).minCoeff(&nearest);
    const auto at = static_cast<std::size_t>(nearest);
    bracket = {bracket.obstacle, s[at == 0 ? 0 : at - 1],
               s[std::min<std::size_t>(at + 1, bracket_parts)]};
  }
  const Samples middle = shape.sample(std::array{(bracket.begin + bracket.end) / 2});
  return body.clearances(middle.points)[0] + body.radius() < 2 * rounding * length;
}

}  // namespace

std::vector<double> element_cuts(const SpanSolution& solution) {
  std::vector<double> cuts;
  const std::vector<double> kinks = kink_positions(solution.model->span());
  for (std::size_t k = 0; k + 1 < kinks.size(); ++k) {
    std::vector<BendingFeature> features = curvature_peaks(solution, kinks[k], kinks[k + 1]);
    for (const BendingFeature& peak : features) cuts.push_back(peak.at);
    features.insert(features.begin(), boundary_layer_at(solution, kinks[k], 1));
    features.push_back(boundary_layer_at(solution, kinks[k + 1], -1));
    for (std::size_t i = 0; i + 1 < features.size(); ++i) {
      const double spacing = features[i + 1].at - features[i].at;
      add_cut_beside(features[i].at, 1, features[i].length, spacing, cuts);
      add_cut_beside(features[i + 1].at, -1, features[i + 1].length, spacing, cuts);
    }
  }
  std::sort(cuts.begin(), cuts.end());
  return cuts;
}

int first_terms(double load, double longest_element) {
  const double own_load = load * longest_element * longest_element;
  return static_cast<int>(std::ceil(9 * std::pow(std::clamp(own_load, 0.7, 1000.0), 0.24)));
}

int terms_needed(const SpanEnergy& model, const Eigen::VectorXd& x, double tolerance, int least) {
  int terms = model.terms();
  while (terms > least &&
         model.truncation(x, terms - 1) < allowed_truncation(tolerance, terms - 1)) {
    --terms;
  }
  return terms;
}

int terms_for_buckling_modes(const SpanSolution& solution) {
  const SpanEnergy& model = *solution.model;
  const double torque = model.twisting_torque(solution.x, solution.multipliers);
  return first_terms(torque * torque, longest_element(elements_of(model.span())));
}

std::vector<double> contact_ends(const SpanSolution& solution) {
  const Span& span = solution.model->span();
  std::vector<double> ends;
  if (span.soft_obstacles.empty()) return ends;
  for (const Bracket& bracket : shortest_brackets(span, solution.model->shape(solution.x))) {
    ends.push_back((bracket.begin + bracket.end) / 2);
  }
  std::sort(ends.begin(), ends.end());
  const auto close = [](double a, double b) { return b - a < closest_contact_ends; };
  ends.erase(std::unique(ends.begin(), ends.end(), close), ends.end());
  return ends;
}

std::vector<RidgeCrossing> ridge_crossings(const SpanSolution& solution) {
  const Span& span = solution.model->span();
  std::vector<RidgeCrossing> crossings;
  if (span.soft_obstacles.empty()) return crossings;
  const SpanShape shape = solution.model->shape(solution.x);
  for (const Bracket& bracket : shortest_brackets(span, shape)) {
    const Span::SoftObstacle& obstacle = span.soft_obstacles[bracket.obstacle];
    const double s = (bracket.begin + bracket.end) / 2;
    const double offset = closest_contact_ends * span.length;
    if (!(s > offset && s < span.length - offset) || has_thin_core(obstacle.body)) continue;
    const Samples samples = shape.sample(std::array{s - offset, s + offset});
    const obstacle::Gap before = obstacle.body.gap(samples.points.col(0));
    const obstacle::Gap after = obstacle.body.gap(samples.points.col(1));
    const Eigen::Vector3d jump = after.gradient - before.gradient;
    if (!(before.value < 0 && after.value < 0 && jump.norm() > least_jump)) continue;
    const double crossed = std::abs(jump.dot(samples.tangents.col(0)));
    crossings.push_back({s, std::sqrt(-obstacle.stiffness * after.value / crossed) * jump});
  }
  std::ranges::sort(crossings, {}, &RidgeCrossing::s);
  return crossings;
}

MiddlePassage classify_middle_passage(const SpanSolution& solution) {
  const Span& span = solution.model->span();
  if (span.soft_obstacles.empty()) return MiddlePassage::none;
  const SpanShape shape = solution.model->shape(solution.x);
  const std::vector<double> s = equal_arc_lengths(span.length, first_intervals + 1);
  const Eigen::Matrix3Xd points = shape.sample(s).points;
  constexpr double sampled_decay_lengths = 4;
  const double visible_distance = sampled_decay_lengths * span.length / first_intervals;
  MiddlePassage passed = MiddlePassage::none;
  for (const Span::SoftObstacle& obstacle : span.soft_obstacles) {
    const obstacle::Body& body = obstacle.body;
    // Near a thin core the force changes its direction within the distance from the core, which
    // nodes have to resolve.
    const bool thin = has_thin_core(body);
    const Eigen::VectorXd clearance = body.clearances(points);
    for (Eigen::Index i = 1; i < points.cols(); ++i) {
      if (clearance[i - 1] >= 0 || clearance[i] >= 0) continue;
      const obstacle::Gap gap = body.gap(points.col(i));
      if (span.planar && is_on_ridge(gap)) return MiddlePassage::on_ridge;
      const bool turns = body.gap(points.col(i - 1)).gradient.dot(gap.gradient) < 0;
      const auto at = static_cast<std::size_t>(i);
      if (turns && thin && meets_core(body, shape, {0, s[at - 1], s[at]}, span.length)) {
        return MiddlePassage::through_line;
      }
      if (thin && (turns || clearance[i] + body.radius() < visible_distance))
        passed = MiddlePassage::near;
    }
  }
  return passed;
}

double misplaced_contact_error(const SpanSolution& solution) {
  const Span& span = solution.model->span();
  double stiffest = 0;
  for (const Span::SoftObstacle& obstacle : span.soft_obstacles) {
    stiffest = std::max(stiffest, obstacle.stiffness);
  }
  const std::vector<double> ends = contact_ends(solution);
  if (ends.empty()) return 0;
  const std::vector<Element> elements = elements_of(span);
  double force = 0;
  for (const double end : ends) {
    double distance = std::numeric_limits<double>::infinity();
    for (const Element& element : elements) {
      distance = std::min({distance, std::abs(end - element.begin), std::abs(end - element.end())});
    }
    force += stiffest * distance * distance;
  }
  return force;
}

}  // namespace dlo::energy_model
