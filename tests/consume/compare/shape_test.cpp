// A program with all three libraries: it reads a scene, solves it, compares, and tests shapes.

#include <dlo/compare.hpp>
#include <dlo/compare/gtest.hpp>

namespace {

using namespace dlo::compare;

Scene installed_scene() {
  Scene scene = load_scene(DLO_DATA_DIR "/scenes/spring_steel_175.toml");
  scene.force_model = {
      .points = 32, .law = BendingLaw::hooke, .bookkeeping = Bookkeeping::consistent};
  return scene;
}

TEST(InstalledDlo, BothModelsGiveTheShapeOfAScene) {
  const Scene scene = installed_scene();
  EXPECT_SHAPE_NEAR(solve(scene, Model::exact).shape, scene, 1e-4);
  EXPECT_SHAPE_NEAR(solve(scene, Model::force).shape, scene, 1e-4);
}

TEST(InstalledDlo, ComparesTheModels) {
  const Comparison comparison = compare(installed_scene());
  EXPECT_GT(comparison.deviation.rms_over_length, 1e-6);
  EXPECT_LT(comparison.deviation.rms_over_length, 1e-4);
  EXPECT_NEAR(comparison.effective_modulus.ratio, 1, 1e-2);
}

}  // namespace
