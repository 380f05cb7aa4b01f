#pragma once

#include <cmath>
#include <utility>

#include "dlo/compare/scene.hpp"

namespace dlo::compare {

/// Logarithms of the factors on the scenes' modulus and density.
struct MaterialPoint {
  double log_modulus = 0;
  double log_density = 0;
  bool operator==(const MaterialPoint& other) const {
    return log_modulus == other.log_modulus && log_density == other.log_density;
  }
  bool operator<(const MaterialPoint& other) const {
    return std::pair(log_modulus, log_density) < std::pair(other.log_modulus, other.log_density);
  }
};

/// Returns the scene with its modulus and density scaled.
[[nodiscard]] inline Scene of_material(Scene scene, const MaterialPoint& material) {
  scene.scale_modulus(std::exp(material.log_modulus));
  scene.scale_density(std::exp(material.log_density));
  return scene;
}

}  // namespace dlo::compare
