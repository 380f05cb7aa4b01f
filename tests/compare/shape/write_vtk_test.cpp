#include "shape/write_vtk.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "command_fixture.hpp"
#include "dlo/compare/force_model_settings.hpp"
#include "dlo/compare/scene_file.hpp"
#include "dlo/compare/shape_file.hpp"
#include "dlo/compare/solution.hpp"
#include "dlo/compare/solve.hpp"

namespace dlo::compare {
namespace {

// A heavy arch in space between two clamps, with a load.
Scene loaded_arch() {
  return parse_scene(R"(
rod = { length = 1, diameter = "4 mm", material = "nylon" }
gripper = [{ at = 0, position = [0, 0, 0], direction = "60 deg" },
           { at = 1, position = [0.5, 0.1, 0.2], direction = [1, -1, 0] }]
load = [{ at = 0.4, force = [0, -0.05, 0.02] }]
)",
                     "arch.toml");
}

std::string vtk_of(const Solution& solution, const std::string& title = "arch") {
  return vtk_polyline(
      solution.shape,
      {.curvature = solution.curvature, .tension = solution.tension, .d1 = solution.d1}, title);
}

TEST(VtkPolyline, IsReadBackExactly) {
  for (const Model model : {Model::energy, Model::chain}) {
    const Solution solution = solve(loaded_arch(), model);
    const MeasuredShape shape = parse_shape(vtk_of(solution), "arch.vtk");
    EXPECT_EQ(shape.points, solution.shape.points);
    EXPECT_EQ(shape.arc_length, solution.shape.arc_length);
    // Its numbers are metres, whatever unit other files are in.
    EXPECT_EQ(parse_shape(vtk_of(solution), "arch.vtk", 1e-3).points, shape.points);
  }
}

// The file of a curved rod in space contains its frame; that of a straight rod does not.
TEST(VtkPolyline, HasTheFrameOfACurvedRod) {
  Scene scene = loaded_arch();
  const Solution straight = solve(scene, Model::energy);
  EXPECT_TRUE(has_none(vtk_of(straight), {"d1 "}));
  scene.natural_strain = {0, 2, 0};
  scene.grippers[0].frame = FrameHold{.d1 = scene.grippers[0].direction->unitOrthogonal()};
  for (const Model model : {Model::energy, Model::exact}) {
    const Solution curved = solve(scene, model);
    const std::string text = vtk_of(curved);
    std::istringstream lines(text.substr(text.find("d1 3 101 double\n")));
    std::string header;
    std::getline(lines, header);
    for (Eigen::Index i = 0; i < 101; ++i) {
      Eigen::Vector3d d1;
      lines >> d1.x() >> d1.y() >> d1.z();
      EXPECT_NEAR(d1.norm(), 1, 1e-12);
      EXPECT_EQ(d1, curved.d1.col(i));
    }
    EXPECT_NEAR(curved.d1.col(0).dot(*scene.grippers[0].direction), 0, 1e-8);
    EXPECT_FALSE(lines.fail());
    EXPECT_EQ(parse_shape(text, "arch.vtk").arc_length, curved.shape.arc_length);
  }
}

TEST(VtkPolyline, TitleIsOneLineOfPrintableCharacters) {
  const Solution solution = solve(loaded_arch(), Model::chain);
  const std::string text = vtk_of(solution, "a\nb\xc3\xa4" + std::string(1000, 'c'));
  EXPECT_TRUE(text.starts_with("# vtk DataFile Version 3.0\na?b??ccc"));
  EXPECT_LT(text.find("\nASCII"), 256U);
}

// At both ends of the rod the tension is that of the gripper. At the first end the moment, EI times
// the curvature, is that of the gripper.
TEST(Solution, CurvatureAndTensionAreThoseOfTheGrippers) {
  const Scene scene = loaded_arch();
  for (const Model model : {Model::energy, Model::exact}) {
    const Solution solution = solve(scene, model);
    const double scale = scene.weight_per_length().norm() * scene.length;
    const Eigen::Vector3d first = *scene.grippers[0].direction;
    const Eigen::Vector3d last = *scene.grippers[1].direction;
    EXPECT_NEAR(solution.tension.front(), -solution.grippers[0].force.dot(first), 1e-6 * scale);
    EXPECT_NEAR(solution.tension.back(), solution.grippers[1].force.dot(last), 1e-6 * scale);
    const double moment = solution.grippers[0].torque.norm() / scene.bending_stiffness();
    EXPECT_NEAR(solution.curvature.front(), moment, 1e-4 * moment);
    EXPECT_EQ(solution.curvature.size(), solution.shape.arc_length.size());
  }
}

// The curvature also agrees next to the gripper, which holds half of a segment, and between the
// joints of the polygon.
TEST(Solution, AFinePolygonHasTheCurvatureOfTheRod) {
  Scene scene = loaded_arch();
  scene.force_model.points = 160;
  const Solution chain = solve(scene, Model::chain);
  const std::vector<double>& s = chain.shape.arc_length;
  const Solution energy = solve(scene, Model::energy, {}, s);
  const double largest = *std::max_element(energy.curvature.begin(), energy.curvature.end());
  for (std::size_t i = 1; i + 1 < s.size(); ++i) {
    EXPECT_NEAR(chain.curvature[i], energy.curvature[i], 0.01 * largest) << i;
  }
  const std::vector<double> samples = {0.1, 0.103, 0.55, 0.9};
  const Solution sampled = solve(scene, Model::chain, {}, samples);
  const Solution expected = solve(scene, Model::energy, {}, samples);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    EXPECT_NEAR(sampled.curvature[i], expected.curvature[i], 0.01 * largest) << i;
  }
}

TEST_F(Command, SolveWritesVtkThatCheckReadsBack) {
  const std::string file = path("shape.vtk");
  succeeds("solve " + steel() + " --format vtk -o " + file);
  const auto check = json_of("check " + steel() + " --shape " + file);
  EXPECT_EQ(check.at("arc_lengths"), "file");
  // `check` solves the scene again from another start; the last step of the energy model is at most
  // 1e-11 l.
  EXPECT_LT(check.at("deviation").at("max_m").get<double>(), 1e-11);
}

}  // namespace
}  // namespace dlo::compare
