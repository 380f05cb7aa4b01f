#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "dlo/compare/explanation.hpp"
#include "explain/chain_convergence.hpp"
#include "explain/own_polygon.hpp"

namespace dlo::compare {
namespace {

/// Deviation, in tolerances, above which the deviation of a misread file is not meaningful.
constexpr double far_beyond = 10;

/// Returns the chain that the file is nearest to, if the file is near enough to be that chain's
/// points: its polyline is as long as the rod, and enough of the rod is observed.
std::optional<OwnPolygon> chain_of_file(const Scene& scene, const ShapeCheck& check,
                                        const ShapeTolerance& tolerance) {
  const double longer = check.polyline_length_m - check.length_m;
  if (!(std::abs(longer) <= tolerance.allowed_m)) return std::nullopt;
  if (!(check.seen_share >= tolerance.least_seen_share)) return std::nullopt;
  const auto distance = [&](const OwnPolygon& chain) {
    return tolerance.largest ? chain.max_m : chain.rms_m;
  };
  std::vector<OwnPolygon> chains = own_polygons(scene, check.alignment.shape, Springs::as_the_rod);
  const auto nearest = std::ranges::min_element(chains, {}, distance);
  if (nearest == chains.end()) return std::nullopt;
  if (!(distance(*nearest) <= right_chain * tolerance.allowed_m)) return std::nullopt;
  return std::move(*nearest);
}

}  // namespace

ChainJudgement judge_as_chain(const Scene& scene, const ShapeCheck& check,
                              const ShapeTolerance& tolerance) {
  ShapeJudgement result = judge(check, tolerance);
  if (result.passes() || !energy_model::succeeded(check.rod.status)) return {result, {}};
  const std::optional<OwnPolygon> chain = chain_of_file(scene, check, tolerance);
  if (!chain) return {result, {}};
  const ChainConvergence way = chain_convergence(scene, *chain, check.rod, tolerance.largest);
  if (way.error == ChainError::another_shape) return {result, {}};
  const Eigen::Index segments = chain->rest.points.cols() - 1;
  const std::string chain_words = words_of(chain->clamp, segments) + and_springs(*chain);
  const std::string words = fmt::format("{}, {:.3g} mm away ({})", chain_words,
                                        (tolerance.largest ? chain->max_m : chain->rms_m) * 1e3,
                                        tolerance.largest ? "largest" : "RMS");
  const std::string refined =
      std::isfinite(way.fine_m)
          ? fmt::format("with {} segments {:.4g} mm", 2 * segments, way.fine_m * 1e3)
          : std::string("within the plan's bound");
  const std::string distances =
      fmt::format("that chain is {:.4g} mm = {:.3g} % of l away from the rod, {}",
                  way.coarse_m * 1e3, way.coarse_m / check.length_m * 100, refined);
  if (way.error == ChainError::discretisation) {
    result.verdict = ShapeVerdict::pass;
    result.reason = fmt::format(
        "right for {}, allowed {:.4g} mm = {:g} of the tolerance; {}: an error of discretisation",
        words, right_chain * tolerance.allowed_m * 1e3, right_chain, distances);
  } else {
    result.verdict = ShapeVerdict::undetermined;
    result.reason = fmt::format(
        "too coarse to judge: it is {}; {}, {:.3g} times less, but {} times are expected", words,
        distances, way.coarse_m / way.fine_m, 1 << way.order);
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
  const bool is_misread = judgement.judged_m > far_beyond * tolerance.allowed_m;
  if (best.kind == ExplanationKind::file && is_misread && best.rms_m <= tolerance.allowed_m) {
    judgement.reason = fmt::format("RMS {:.4g} mm if {}; as it was read: {}", best.rms_m * 1e3,
                                   best.cause, judgement.reason);
    return judgement;
  }
  judgement.reason += fmt::format(
      "; it would be {:.4g} mm (RMS) if {}", best.rms_m * 1e3,
      best.kind == ExplanationKind::discretisation ? "it were " + best.cause : best.cause);
  return judgement;
}

}  // namespace dlo::compare
