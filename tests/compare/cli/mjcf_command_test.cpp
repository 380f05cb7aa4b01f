// Tests of `dlo check` with MuJoCo models, against the positions of the bodies of chains of rigid
// segments at rest.

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "command_fixture.hpp"
#include "dlo/compare/scene_file.hpp"
#include "dlo/compare/shape.hpp"
#include "dlo/compare/solve.hpp"
#include "dlo/energy_model/polygon.hpp"

namespace dlo::compare {
namespace {

const std::vector<std::string> models = {"composite.xml", "chain.xml", "hinges.xml",
                                         "two_constraints.xml", "capsule_caps.xml"};

std::string model(const std::string& name) { return std::string(DLO_DATA) + "/mujoco/" + name; }

/// Returns the points of the model's segments at rest. The springs are linear in the angle. Half of
/// the weight of each segment acts at each of its ends, as for a uniform rigid segment. If a clamp
/// holds a body, both ends of the body are fixed.
Eigen::Matrix3Xd chain_at_rest(const Scene& scene) {
  const Eigen::Index n = scene.model->segments;
  const double h = scene.length / static_cast<double>(n);
  energy_model::PolygonProblem problem;
  problem.law = energy_model::JointLaw::linear;
  problem.rest_lengths.setConstant(n, h);
  problem.stiffness = scene.bending_stiffness();
  const Eigen::Vector3d weight = scene.mass() * scene.gravity / static_cast<double>(n);
  // Segments that stretch by no more than a millionth.
  problem.stretch_stiffness =
      1e6 * (problem.stiffness / (h * h) + static_cast<double>(n) * weight.norm());
  problem.node_forces.setZero(3, n + 1);
  problem.node_forces.leftCols(n).colwise() += weight / 2;
  problem.node_forces.rightCols(n).colwise() += weight / 2;
  for (const Gripper& gripper : scene.grippers) {
    const auto point = static_cast<Eigen::Index>(std::lround(gripper.at / h));
    problem.held.push_back({point, gripper.position});
    if (!gripper.direction) continue;
    const double way = point == 0 ? h : -h;
    problem.held.push_back({point == 0 ? 1 : n - 1, gripper.position + way * *gripper.direction});
  }
  std::vector<double> s;
  for (Eigen::Index i = 0; i <= n; ++i)
    s.push_back(std::min(scene.length, static_cast<double>(i) * h));
  const Solution rod = solve(scene, Model::energy, {}, s);
  const energy_model::PolygonResult rest =
      energy_model::solve_polygon(problem, rod.shape.points, {});
  EXPECT_TRUE(energy_model::succeeded(rest.status)) << scene.name;
  return rest.points;
}

class MjcfCommand : public Command {
 protected:
  /// Writes the positions of a model's bodies at rest, without the end of the last body.
  std::string starts(const std::string& name) {
    const Eigen::Matrix3Xd points = chain_at_rest(load_scene(model(name)));
    std::vector<std::vector<double>> rows;
    for (Eigen::Index i = 0; i + 1 < points.cols(); ++i) {
      rows.push_back({points(0, i), points(1, i), points(2, i)});
    }
    return write_table("xpos.csv", "x,y,z", rows);
  }
};

TEST_F(MjcfCommand, FiveModelsComeToTheirVerdictInOneCommand) {
  for (const std::string& name : models) {
    const json document =
        json_of(words({"check", model(name), "--shape", starts(name)}) + "--tolerance 0.1%");
    EXPECT_EQ(document.at("verdict"), "pass") << name << document.at("reason");
    EXPECT_EQ(document.at("points_m").size(),
              document.at("model").at("segments").get<std::size_t>() + 1)
        << name;
    EXPECT_EQ(document.at("notes").size(), 1U) << name;
    EXPECT_TRUE(has_all(document.at("reason").get<std::string>(), {"chain of"}))
        << name << document.at("reason");
  }
}

TEST_F(MjcfCommand, AModelWithAnotherSpringFailsWithTheCause) {
  const std::string points = starts("chain.xml");
  std::string text = read(model("chain.xml"));
  const std::size_t at = text.find("stiffness=\"");
  const std::size_t end = text.find('"', at + 11);
  text.replace(at, end - at, "stiffness=\"0.96510");  // twice as stiff
  const std::string stiff = write("stiff.xml", text);
  EXPECT_TRUE(has_all(output_of(words({"check", stiff, "--shape", points, "--tolerance 1%"}), 1),
                      {"springs of 0.5"}));
}

}  // namespace
}  // namespace dlo::compare
