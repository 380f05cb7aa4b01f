#pragma once

#include <span>
#include <string>

#include "base/require.hpp"
#include "dlo/energy_model/problem.hpp"

namespace dlo::energy_model {

/// Samples at these arc lengths of a rod of this length, still to be filled, without d1.
/// @throws std::invalid_argument for an arc length that is not on the rod
[[nodiscard]] inline Samples sized_samples(std::span<const double> arc_lengths, double length) {
  for (const double at : arc_lengths) {
    // Asked first, because the text costs more than what is sampled.
    if (at >= 0 && at <= length) continue;
    require(false, "sample", "arc length", at, "in [0, " + std::to_string(length) + "]");
  }
  const auto count = static_cast<Eigen::Index>(arc_lengths.size());
  Samples samples;
  samples.arc_length.assign(arc_lengths.begin(), arc_lengths.end());
  samples.points.resize(3, count);
  samples.tangents.resize(3, count);
  samples.curvature.resize(3, count);
  return samples;
}

}  // namespace dlo::energy_model
