// MuJoCo's models as a user checks them, against the positions of the bodies of chains of rigid
// segments at rest.

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "command_fixture.hpp"
#include "dlo/compare/scene_file.hpp"
#include "dlo/compare/shape.hpp"
#include "dlo/compare/solve.hpp"
#include "dlo/energy_model/polygon.hpp"

namespace {

using dlo::test::says;

namespace energy = dlo::energy_model;
using dlo::test::Command;
using dlo::test::Outcome;
using nlohmann::json;

const std::vector<std::string> models = {"composite.xml", "chain.xml", "hinges.xml",
                                         "two_constraints.xml", "capsule_caps.xml"};

std::string model(const std::string& name) { return std::string(DLO_DATA) + "/mujoco/" + name; }

std::string model_text(const std::string& name) {
  std::ifstream stream(model(name));
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// The model's segments at rest: springs linear in the angle, each segment's weight half at each of
/// its ends, as a rigid segment's is that is uniform; where a clamp holds a body, both its ends
/// are.
Eigen::Matrix3Xd chain_at_rest(const dlo::compare::Scene& scene) {
  const Eigen::Index n = scene.model->segments;
  const double h = scene.length / static_cast<double>(n);
  energy::PolygonProblem problem;
  problem.law = energy::JointLaw::linear;
  problem.rest_lengths.setConstant(n, h);
  problem.stiffness = scene.bending_stiffness();
  const Eigen::Vector3d weight = scene.mass() * scene.gravity / static_cast<double>(n);
  // Segments that stretch by no more than a millionth.
  problem.stretch_stiffness =
      1e6 * (problem.stiffness / (h * h) + static_cast<double>(n) * weight.norm());
  problem.node_forces.setZero(3, n + 1);
  problem.node_forces.leftCols(n).colwise() += weight / 2;
  problem.node_forces.rightCols(n).colwise() += weight / 2;
  for (const dlo::compare::Gripper& gripper : scene.grippers) {
    const auto point = static_cast<Eigen::Index>(std::lround(gripper.at / h));
    problem.held.push_back({point, gripper.position});
    if (!gripper.direction) continue;
    const double way = point == 0 ? h : -h;
    problem.held.push_back({point == 0 ? 1 : n - 1, gripper.position + way * *gripper.direction});
  }
  std::vector<double> s;
  for (Eigen::Index i = 0; i <= n; ++i)
    s.push_back(std::min(scene.length, static_cast<double>(i) * h));
  const dlo::compare::Solution rod = dlo::compare::solve(scene, dlo::compare::Model::energy, {}, s);
  const energy::PolygonResult rest = energy::solve_polygon(problem, rod.shape.points, {});
  EXPECT_TRUE(energy::succeeded(rest.status)) << scene.name;
  return rest.points;
}

class MjcfCommand : public Command {
 protected:
  /// The places of a model's bodies at rest, without the end of the last.
  std::string starts(const std::string& name) {
    const Eigen::Matrix3Xd points = chain_at_rest(dlo::compare::load_scene(model(name)));
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
    EXPECT_TRUE(says(document.at("reason").get<std::string>(), {"chain of"}))
        << name << document.at("reason");
  }
}

TEST_F(MjcfCommand, AModelWithAnotherSpringFailsWithTheCause) {
  const std::string points = starts("chain.xml");
  std::string text = model_text("chain.xml");
  const std::size_t at = text.find("stiffness=\"");
  const std::size_t end = text.find('"', at + 11);
  text.replace(at, end - at, "stiffness=\"0.96510");  // twice as stiff
  std::ofstream(path("stiff.xml")) << text;
  const Outcome result =
      run(words({"check", path("stiff.xml"), "--shape", points}) + "--tolerance 1%");
  EXPECT_EQ(result.status, 1);
  EXPECT_TRUE(says(result.out, {"springs of 0.5"}));
}

TEST_F(MjcfCommand, TheModelIsToldWithItsNumbers) {
  const Outcome result =
      run(words({"check", model("composite.xml"), "--shape", starts("composite.xml")}));
  EXPECT_TRUE(
      says(result.out, {"MJCF, a composite cable\n", " 20\n", " 0.06397 kg\n", " 0.02413 N m^2\n",
                        " 0.0185 N m^2\n", "its 20 points are where the segments begin"}));
}

TEST_F(MjcfCommand, OtherCommandsTakeModelsToo) {
  const std::string solved = said("solve " + model("chain.xml") + " --format json");
  EXPECT_EQ(json::parse(solved).at("scene"), "chain of 20 bodies");
  succeeds("scene " + model("two_constraints.xml"));
}

/// A text with some piece of it gone, doubled, exchanged or of another character.
std::string mutated(std::string text, std::mt19937& random) {
  const auto below = [&random](std::size_t most) {
    return std::uniform_int_distribution<std::size_t>(0, most - 1)(random);
  };
  const std::size_t at = below(text.size());
  const std::size_t length = std::min(text.size() - at, 1 + below(40));
  switch (below(5)) {
    case 0:
      text.erase(at, length);
      break;
    case 1:
      text.insert(at, text.substr(at, length));
      break;
    case 2:
      text[at] = static_cast<char>(below(256));
      break;
    case 3: {
      constexpr const char* hostile[] = {"nan", "-1e999", "<body>", "\"", "&x;", "]]>", "<!--"};
      text.insert(at, hostile[below(std::size(hostile))]);
      break;
    }
    default:
      text.resize(at);
  }
  return text;
}

TEST_F(MjcfCommand, FiftyMalformedModelsEndInOneLine) {
  std::mt19937 random(20260101);  // NOLINT(cert-msc32-c, cert-msc51-cpp): the same every time
  std::ofstream(path("two.csv")) << "0,0\n1,0\n";
  int refused = 0;
  for (int i = 0; refused < 50 && i < 1000; ++i) {
    const std::string text =
        mutated(model_text(models[static_cast<std::size_t>(i) % models.size()]), random);
    try {
      (void)dlo::compare::parse_scene(text, "a.xml");
      continue;  // such as a mutated remark
    } catch (const std::exception&) {
      ++refused;
    }
    std::ofstream(path("mutated.xml"), std::ios::binary) << text;
    for (const std::string& command :
         {"check --shape " + path("two.csv") + " ", std::string("solve ")}) {
      const Outcome result = run(command + path("mutated.xml"));
      EXPECT_EQ(result.status, 2) << text;
      EXPECT_EQ(result.out, "");
      EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
      EXPECT_TRUE(says(result.err, {"mutated.xml"}));
    }
  }
  EXPECT_EQ(refused, 50);
}

}  // namespace
