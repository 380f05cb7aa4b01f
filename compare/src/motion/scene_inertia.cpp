#include "motion/scene_inertia.hpp"

namespace dlo::compare {

energy_model::Inertia scene_inertia(const Scene& scene) {
  energy_model::Inertia inertia;
  inertia.mass_per_length = scene.mass_per_length();
  for (const Section& section : scene.sections) {
    inertia.of_sections.push_back(section.mass_per_length);
  }
  for (const PointLoad& load : scene.loads) {
    if (load.mass > 0) inertia.point_masses.push_back({load.at, load.mass});
  }
  return inertia;
}

}  // namespace dlo::compare
