#pragma once

#include <span>
#include <string>

#include "base/require.hpp"
#include "dlo/energy_model/problem.hpp"

namespace dlo::energy_model {

/// Returns samples with matrices of the right size, not yet filled and without d1, at these arc
/// lengths of a rod of this length.
/// @throws std::invalid_argument for an arc length that is not on the rod
[[nodiscard]] inline Samples sized_samples(std::span<const double> arc_lengths, double length) {
  for (const double at : arc_lengths) {
    // Checked before require(), because composing the message costs more than a sample.
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
