#include "explain/chain_convergence.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "dlo/compare/deviation.hpp"
#include "dlo/compare/explanation.hpp"
#include "explain/own_polygon.hpp"
#include "polygon/polygon_response.hpp"

namespace dlo::compare {
namespace {

/// Deviation, in tolerances, above which the deviation of a misread file is not meaningful.
constexpr double largest_meaningful_deviation = 10;

/// Returns the chain that the file is nearest to. Returns std::nullopt unless the file's polyline
/// is as long as the rod within the tolerance, enough of the rod is observed, and the file is
/// within `chain_match_tolerance` of the tolerance from the chain.
std::optional<CandidateChain> chain_matching_file(const Scene& scene, const ShapeCheck& check,
                                                  const ShapeTolerance& tolerance) {
  const double longer = check.polyline_length_m - check.length_m;
  if (!(std::abs(longer) <= tolerance.allowed_m)) return std::nullopt;
  if (!(check.observed_share >= tolerance.least_observed_share)) return std::nullopt;
  const auto distance = [&](const CandidateChain& chain) {
    return tolerance.largest ? chain.max_m : chain.rms_m;
  };
  std::vector<CandidateChain> chains =
      candidate_chains(scene, check.alignment.shape, Springs::rod_stiffness);
  const auto nearest = std::ranges::min_element(chains, {}, distance);
  if (nearest == chains.end()) return std::nullopt;
  if (!(distance(*nearest) <= chain_match_tolerance * tolerance.allowed_m)) return std::nullopt;
  return std::move(*nearest);
}

/// Largest relative difference between d(N) / d(2N) and 2^p of a discretisation error.
constexpr double ratio_tolerance = 0.3;
/// Number of bisections of its segments after which the distance of a chain must be halved;
/// otherwise the chain does not converge to the rod. A discretisation error of first order is an
/// eighth then.
constexpr int most_bisections = 3;

/// Returns the gripper at an arc length; null if there is none.
const Gripper* gripper_at(const Scene& scene, double s) {
  const auto found = std::ranges::find_if(scene.grippers, [&](const Gripper& gripper) {
    return std::abs(gripper.at - s) < 1e-6 * scene.length;
  });
  return found == scene.grippers.end() ? nullptr : &*found;
}

/// Returns the arc lengths of the points of a chain with twice as many segments between any two
/// grippers. A segment that a clamp holds in its middle is bisected as a whole, of which a half
/// belongs to the span on either side: the new segments of that span are as long as if 2N - 1/2 of
/// them made up the N - 1/2 old ones.
std::vector<double> refined_arc_lengths(const Scene& scene, const CandidateChain& chain) {
  std::vector<double> s = chain.rest.arc_length;
  std::vector<double> middles;  // clamps between the points
  for (const Gripper& gripper : scene.grippers) {
    const bool is_at_point = std::ranges::any_of(
        s, [&](double at) { return std::abs(gripper.at - at) < 1e-6 * scene.length; });
    if (gripper.direction && !is_at_point) middles.push_back(gripper.at);
  }
  for (const double at : middles) s.insert(std::ranges::upper_bound(s, at), at);
  const std::size_t n = s.size() - 1;
  const auto is_half = [&](std::size_t i) {
    const Gripper* const held = gripper_at(scene, s[i]);
    return chain.clamp == ChainClamp::middle && held != nullptr && held->direction;
  };
  std::vector<double> result = {0};
  for (std::size_t begin = 0, end = 1; begin < n; begin = end++) {
    while (end < n && gripper_at(scene, s[end]) == nullptr) ++end;
    const double first = is_half(begin) ? 0.5 : 0;
    const double last = is_half(end) ? 0.5 : 0;
    // Segments are counted from the start of the first whole one.
    std::vector<double> count;
    for (std::size_t i = begin; i <= end; ++i) count.push_back(static_cast<double>(i - begin));
    count.front() += first;
    count.back() -= last;
    const std::vector<double> at(s.begin() + static_cast<long>(begin),
                                 s.begin() + static_cast<long>(end) + 1);
    const double segments = 2 * static_cast<double>(end - begin);
    const double step = (count.back() - count.front()) / (segments - first - last);
    std::vector<double> fine;
    for (double i = 1; i < segments; ++i) fine.push_back(count.front() + step * (i - first));
    const std::vector<double> inner = interpolated(at, count, fine);
    result.insert(result.end(), inner.begin(), inner.end());
    result.push_back(s[end]);
  }
  for (const double at : middles) std::erase(result, at);
  return result;
}

double distance_from(const Shape& chain, const energy_model::Equilibrium& rod, bool largest) {
  const Eigen::Matrix3Xd gaps = chain.points - rod.sample(chain.arc_length).points;
  return largest ? std::sqrt(gaps.colwise().squaredNorm().maxCoeff()) : rms(chain.arc_length, gaps);
}

/// Whether the distance [m] is within the bound of make_plan() for a polygon with the chain's
/// points, if clamps hold the middles of its segments and the rod touches nothing.
bool is_within_bound(const Scene& scene, const CandidateChain& chain,
                     const energy_model::Equilibrium& rod, double distance_m) {
  if (touches_obstacle(rod) || chain.clamp != ChainClamp::middle) return false;
  Scene held_in_middle = scene;
  held_in_middle.force_model = {};
  const std::vector<double>& s = chain.rest.arc_length;
  const std::optional<Discretisation> polygon =
      hooke_polygon(held_in_middle, static_cast<int>(s.size()));
  if (!polygon) return false;
  constexpr double relative_tolerance = 0.01;  // divided by a segment
  const double tolerance = relative_tolerance * scene.length / static_cast<double>(s.size());
  for (std::size_t i = 1; i + 1 < s.size(); ++i) {
    if (std::abs(polygon->arc_length[i] - s[i]) > tolerance) return false;
  }
  const double bound = polygon_bound(scene, *polygon, rod);
  return std::isfinite(bound) && distance_m <= bound;
}

}  // namespace

ChainJudgement judge_as_chain(const Scene& scene, const ShapeCheck& check,
                              const ShapeTolerance& tolerance) {
  ShapeJudgement result = judge(check, tolerance);
  if (result.passes() || !energy_model::succeeded(check.rod.status)) return {result, {}};
  const std::optional<CandidateChain> chain = chain_matching_file(scene, check, tolerance);
  if (!chain) return {result, {}};
  const ChainConvergence convergence =
      chain_convergence(scene, *chain, check.rod, tolerance.largest);
  if (convergence.error == ChainError::different_shape) return {result, {}};
  const Eigen::Index segments = chain->rest.points.cols() - 1;
  const std::string chain_words = words_of(chain->clamp, segments) + springs_clause(*chain);
  const std::string words = fmt::format("{}, {:.3g} mm away ({})", chain_words,
                                        (tolerance.largest ? chain->max_m : chain->rms_m) * 1e3,
                                        tolerance.largest ? "largest" : "RMS");
  const std::string refined =
      std::isfinite(convergence.fine_m)
          ? fmt::format("with {} segments {:.4g} mm", 2 * segments, convergence.fine_m * 1e3)
          : std::string("within the plan's bound");
  const std::string distances =
      fmt::format("that chain is {:.4g} mm = {:.3g} % of l away from the rod, {}",
                  convergence.coarse_m * 1e3, convergence.coarse_m / check.length_m * 100, refined);
  if (convergence.error == ChainError::discretisation) {
    result.verdict = ShapeVerdict::pass;
    result.reason = fmt::format(
        "right for {}, allowed {:.4g} mm = {:g} of the tolerance; {}: an error of discretisation",
        words, chain_match_tolerance * tolerance.allowed_m * 1e3, chain_match_tolerance, distances);
  } else {
    result.verdict = ShapeVerdict::undetermined;
    result.reason = fmt::format(
        "too coarse to judge: it is {}; {}, {:.3g} times less, but {} times are expected", words,
        distances, convergence.coarse_m / convergence.fine_m, 1 << convergence.order);
  }
  return {result, Explanation{.cause = chain_words,
                              .rms_m = chain->rms_m,
                              .kind = ExplanationKind::discretisation,
                              .max_m = chain->max_m}};
}

ShapeJudgement with_explanation(ShapeJudgement judgement,
                                const std::vector<Explanation>& explanations,
                                const ShapeTolerance& tolerance) {
  if (judgement.passes() || explanations.empty()) return judgement;
  const Explanation& best = explanations.front();
  const bool is_wrong_file =
      judgement.judged_m > largest_meaningful_deviation * tolerance.allowed_m;
  if (best.kind == ExplanationKind::file && is_wrong_file && best.rms_m <= tolerance.allowed_m) {
    judgement.reason = fmt::format("RMS {:.4g} mm if {}; as it was read: {}", best.rms_m * 1e3,
                                   best.cause, judgement.reason);
    return judgement;
  }
  judgement.reason += fmt::format(
      "; it would be {:.4g} mm (RMS) if {}", best.rms_m * 1e3,
      best.kind == ExplanationKind::discretisation ? "it were " + best.cause : best.cause);
  return judgement;
}

ChainConvergence chain_convergence(const Scene& scene, const CandidateChain& chain,
                                   const energy_model::Equilibrium& rod, bool largest) {
  ChainConvergence result;
  const bool is_clamped = std::ranges::any_of(
      scene.grippers, [](const Gripper& gripper) { return gripper.direction.has_value(); });
  result.order = is_clamped && chain.clamp != ChainClamp::middle ? 1 : 2;
  result.coarse_m = distance_from(chain.rest, rod, largest);
  result.fine_m = std::numeric_limits<double>::quiet_NaN();
  double finest_m = result.fine_m;
  CandidateChain fine = chain;
  for (int bisections = 1; bisections <= most_bisections; ++bisections) {
    const Shape start = resample(fine.rest, refined_arc_lengths(scene, fine));
    std::optional<Shape> rest = chain_at_rest(scene, start, fine);
    if (!rest) break;
    fine.rest = std::move(*rest);
    finest_m = distance_from(fine.rest, rod, largest);
    if (bisections > 1) continue;
    result.fine_m = finest_m;
    const double ratio = result.coarse_m / result.fine_m;
    if (std::abs(ratio / std::exp2(result.order) - 1) > ratio_tolerance) continue;
    result.error = ChainError::discretisation;
    return result;
  }
  if (is_within_bound(scene, chain, rod, result.coarse_m)) {
    result.error = ChainError::discretisation;
  } else if (finest_m <= result.coarse_m / 2 && result.fine_m > 0) {
    result.error = ChainError::too_coarse;
  }
  return result;
}

}  // namespace dlo::compare
