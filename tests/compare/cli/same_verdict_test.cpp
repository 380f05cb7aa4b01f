// Tests that the command, the library and GoogleTest's matchers give the same verdict on a shape,
// in the same sentence.

#include <nlohmann/json.hpp>
#include <random>

#include "../../sanitized.hpp"
#include "../command_fixture.hpp"
#include "../scenes.hpp"
#include "dlo/compare/check.hpp"
#include "dlo/compare/scene_file.hpp"
#include "dlo/compare/solve.hpp"

namespace dlo::test {
namespace {

using compare::Scene;
using compare::Shape;

/// Returns a shape that is right, or wrong in one of four ways.
Shape shape_of_kind(Scene scene, int kind, std::mt19937& random) {
  std::normal_distribution<double> normal;
  scene.force_model.points = 21;
  const auto model = kind == 1 ? compare::Model::chain : compare::Model::energy;
  if (kind == 2) scene.scale_density(1.5);
  // There are few points, because each is searched for along the rod for every candidate cause.
  const std::vector<double> s = compare::equal_arc_lengths(scene.length, 11);
  Shape shape = compare::solve(scene, model, {}, s).shape;
  if (kind == 3) shape.points.array() += 2e-3 * scene.length;
  if (kind == 4) {
    for (double& x : shape.points.reshaped()) x += 0.01 * scene.length * normal(random);
  }
  return shape;
}

class SameVerdict : public Command {
 protected:
  std::string write_shape(const Shape& shape) const {
    std::vector<std::vector<double>> rows;
    for (Eigen::Index i = 0; i < shape.points.cols(); ++i) {
      const Eigen::Vector3d p = shape.points.col(i);
      rows.push_back({p.x(), p.y(), p.z(), shape.arc_length[static_cast<std::size_t>(i)]});
    }
    return write_table("shape.csv", "x,y,z,s", rows);
  }
};

TEST_F(SameVerdict, OfFiftyShapesFromCommandLibraryAndMatchers) {
  std::mt19937 random(50);
  int shapes = 0;
  int passes = 0;
  const std::vector<const char*> names = {"cable", "spring_steel_175", "long_rod", "side_load",
                                          "buckling_wire"};
  const auto scenes = static_cast<std::size_t>(draws(static_cast<int>(names.size())));
  for (std::size_t k = 0; k < scenes; ++k) {
    const char* name = names[k];
    const std::string file = shipped_scene(name);
    const Scene scene = compare::load_scene(file);
    for (int kind = 0; kind < 5; ++kind) {
      const Shape shape = shape_of_kind(scene, kind, random);
      const std::string written = write_shape(shape);
      for (const bool largest : {false, true}) {
        SCOPED_TRACE(std::string(name) + ", kind " + std::to_string(kind));
        const RunResult outcome = run("check " + file + " --shape " + written +
                                      " --no-modulus --format json --tolerance 1% --measure " +
                                      (largest ? "max" : "rms"));
        ASSERT_TRUE(outcome.status == 0 || outcome.status == 1) << outcome.err;
        const json document = json::parse(outcome.out);
        const compare::CheckResult result =
            compare::check(scene, compare::load_shape(written),
                           {.tolerance = compare::ShapeTolerance{.allowed_m = 0.01 * scene.length,
                                                                 .largest = largest},
                            .shape = {.modulus = compare::ModulusSearch::no}});
        const compare::ShapeTestOutcome near =
            (largest ? compare::shape_within : compare::shape_near)(shape, scene, 0.01);
        EXPECT_EQ(document["verdict"] == "pass", result.passes());
        EXPECT_EQ(document["reason"], result.judgement.reason);
        EXPECT_EQ(near.near, result.passes());
        EXPECT_EQ(near.explanation.substr(0, near.explanation.find('\n')), result.judgement.reason);
        ++shapes;
        passes += result.passes() ? 1 : 0;
      }
    }
  }
  EXPECT_EQ(shapes, 10 * static_cast<int>(scenes));
  EXPECT_GE(passes, 3 * static_cast<int>(scenes));
  EXPECT_LE(passes, 8 * static_cast<int>(scenes));
}

/// Returns the document without the fields that depend on the tolerance.
json without_tolerance_fields(json document) {
  for (const char* key : {"tolerance", "judged_m", "verdict", "reason", "explanations",
                          "superseded_by", "significant", "deflection_m", "hint"}) {
    document.erase(key);
  }
  return document;
}

// The search for causes does not change the verdict. Neither the search nor the tolerance changes
// the fields that do not depend on the tolerance.
TEST_F(SameVerdict, HasTheSameNumbersWhateverIsAllowed) {
  const std::string file = shipped_scene("spring_steel_175");
  const Scene scene = compare::load_scene(file);
  std::mt19937 random(51);
  for (int kind = 0; kind < 5; ++kind) {
    SCOPED_TRACE(kind);
    const std::string check = "check " + file + " --shape " +
                              write_shape(shape_of_kind(scene, kind, random)) + " --format json";
    const auto document = [&](const std::string& options) {
      return json::parse(run(check + options).out);
    };
    const json judged = document(" --tolerance 1%");
    EXPECT_EQ(document(" --tolerance 1% --no-explanation")["verdict"], judged["verdict"]);
    for (const char* options : {"", " --tolerance 1% --no-explanation", " --tolerance 0.01%",
                                " --tolerance 20% --measure max"}) {
      EXPECT_EQ(without_tolerance_fields(document(options)), without_tolerance_fields(judged))
          << options;
    }
  }
}

}  // namespace
}  // namespace dlo::test
