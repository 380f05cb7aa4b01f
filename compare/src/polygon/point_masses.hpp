#pragma once

#include <vector>

#include "dlo/compare/force_model_settings.hpp"
#include "dlo/compare/scene.hpp"

namespace dlo::compare {

/// What the points of a scene's polygon weigh, by point [kg].
struct PointMasses {
  std::vector<double> rod;      ///< of the rod
  std::vector<double> hanging;  ///< what hangs on it (PointLoad::mass), by the lever rule
};

/// @throws InputError as discretise()
[[nodiscard]] PointMasses point_masses(const Scene& scene, const ForceModelSettings& settings);

}  // namespace dlo::compare
