#include "certify/piece_cuts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace dlo::energy_model {
namespace {

/// Number of points at which a shape is sampled.
constexpr Eigen::Index probes = 4096;

/// A cause of bending that is confined to a length of its own.
struct Feature {
  double at = 0;
  double length = 0;  // 0: a free end, where the rod is not bent
};

/// Returns the force that the rod carries at s, up to its sign.
Eigen::Vector3d carried_at(const SpanSolution& solution, double s) {
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
Feature kink_at(const SpanSolution& solution, double at, double sense) {
  const Span& span = solution.model->span();
  const bool free_begin = at < closest_cuts && !span.start_direction && span.anchor > 0;
  const bool held_end = !span.holds.empty() && span.holds.back().at > span.length - closest_cuts;
  const bool free_end = at > span.length - closest_cuts && !held_end && span.anchor < span.length;
  if (free_begin || free_end) return {at, 0};
  const double s = at + sense * 1e-6 * span.length;
  const double force = std::max(1.0, carried_at(solution, s).norm());
  return {at, std::sqrt(stiffness_at(span, s) / force)};
}

/// Returns the maxima of the curvature among the points up to twice 2 / curvature away, the length
/// of an elastica that turns back there, if the curvature at that distance has decreased on both
/// sides to at most `fallen` of the maximum.
std::vector<Feature> peaks_of(const SpanSolution& solution, double begin, double end) {
  constexpr double fallen = 0.6;
  constexpr double widths = 2;
  const Eigen::VectorXd at = Eigen::VectorXd::LinSpaced(probes, begin, end);
  const Eigen::VectorXd curvature = solution.model->shape(solution.x)
                                        .sample({at.data(), static_cast<std::size_t>(probes)})
                                        .curvature.colwise()
                                        .norm();
  const double h = (end - begin) / static_cast<double>(probes - 1);
  std::vector<Feature> peaks;
  for (Eigen::Index i = 1; i + 1 < probes; ++i) {
    const double length = 2 / curvature[i];
    if (!(widths * length < end - begin)) continue;
    const auto aside = static_cast<Eigen::Index>(widths * length / h) + 1;
    if (aside > i || i + aside >= probes) continue;
    if (curvature.segment(i - aside, 2 * aside + 1).maxCoeff() > curvature[i]) continue;
    if (std::max(curvature[i - aside], curvature[i + aside]) > fallen * curvature[i]) continue;
    peaks.push_back({at[i], length});
    i += aside;
  }
  return peaks;
}

/// Adds cuts on one side of a feature where it has decayed, as far as there is room.
void cut_beside(const Feature& feature, double sense, double room, std::vector<double>& cuts) {
  constexpr std::array<double, 2> depths = {6, 24};
  for (const double depth : depths) {
    const double away = depth * feature.length;
    if (away > 0 && 2.5 * away < room) cuts.push_back(feature.at + sense * away);
  }
}

}  // namespace

std::vector<double> piece_cuts(const SpanSolution& solution) {
  std::vector<double> cuts;
  const std::vector<double> kinks = kinks_of(solution.model->span());
  for (std::size_t k = 0; k + 1 < kinks.size(); ++k) {
    std::vector<Feature> features = peaks_of(solution, kinks[k], kinks[k + 1]);
    for (const Feature& peak : features) cuts.push_back(peak.at);
    features.insert(features.begin(), kink_at(solution, kinks[k], 1));
    features.push_back(kink_at(solution, kinks[k + 1], -1));
    for (std::size_t i = 0; i + 1 < features.size(); ++i) {
      const double room = features[i + 1].at - features[i].at;
      cut_beside(features[i], 1, room, cuts);
      cut_beside(features[i + 1], -1, room, cuts);
    }
  }
  std::sort(cuts.begin(), cuts.end());
  return cuts;
}

}  // namespace dlo::energy_model
