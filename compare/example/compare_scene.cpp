// Prints the distance between the shapes of the force model and the energy model for a scene file,
// and the effective modulus of the force model.

#include <cstdio>
#include <exception>

#include "dlo/compare/comparison.hpp"
#include "dlo/compare/deviation.hpp"
#include "dlo/compare/scene_file.hpp"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: compare_scene SCENE.toml\n");
    return 2;
  }
  try {
    const dlo::compare::Comparison result =
        dlo::compare::compare(dlo::compare::load_scene(argv[1]));
    std::printf("%s\n", result.scene.c_str());
    std::printf("RMS      %.3f %% of the length\n", result.deviation.rms_over_length * 100);
    std::printf("largest  %.4f m at s = %.4f m\n", result.deviation.max_m,
                result.deviation.max_at_m);
    std::printf("E*/E     %.4f\n", result.effective_modulus.ratio);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
  return 0;
}
