// Tests of the joint laws of other programs in model `chain`.

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "../../says.hpp"
#include "dlo/compare/chain.hpp"
#include "dlo/compare/comparison.hpp"
#include "dlo/compare/discretise.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/scene_file.hpp"
#include "dlo/compare/solve.hpp"
#include "rolled_chain.hpp"
#include "scenes.hpp"

namespace dlo::compare {
namespace {

using energy_model::JointLaw;

Scene hanging_rope_of_law(std::optional<JointLaw> law) {
  Scene scene = test::heavy_scene(60, 0);
  scene.force_model.points = 12;
  scene.force_model.joint_law = law;
  return scene;
}

TEST(ModelChain, HasTheLawOfOtherPrograms) {
  const Scene hooke = hanging_rope_of_law(std::nullopt);
  const Discretisation polygon = discretise(hooke, hooke.force_model);
  const Eigen::VectorXd h = polygon.rod.rest_lengths;
  const Eigen::Index n = h.size();
  const Eigen::VectorXd springs =
      2 * hooke.bending_stiffness() * (h.head(n - 1) + h.tail(n - 1)).cwiseInverse();
  const auto expect = [&](std::optional<JointLaw> law, const auto& moment) {
    // The clamp holds the middle of the first segment, which therefore begins half a segment before
    // the clamp.
    Eigen::Matrix3Xd points =
        test::chain_at_rest(h, springs, polygon.rod.loads.topRows<2>(), moment);
    points.row(0).array() -= h[0] / 2;
    Solution chain = solve(hanging_rope_of_law(law), Model::chain);
    const Shape own = polygon.shape(points);
    EXPECT_LT((chain.shape.points - own.points).cwiseAbs().maxCoeff(), 1e-9);
    return chain;
  };
  const Solution soft = expect(JointLaw::linear, test::linear_moment);
  const Solution own = expect(JointLaw::hooke, test::hooke_moment);
  const Solution stiff = expect(JointLaw::binormal, test::binormal_moment);
  expect(std::nullopt, test::hooke_moment);
  // At one spring constant a joint's moment grows from law to law.
  EXPECT_GT(stiff.shape.points(0, n), own.shape.points(0, n) + 1e-3);
  EXPECT_GT(own.shape.points(0, n), soft.shape.points(0, n) + 1e-3);
}

TEST(ModelChain, CountsTheEnergyOfItsLaw) {
  const Scene scene = hanging_rope_of_law(JointLaw::linear);
  const Solution chain = solve(scene, Model::chain);
  const Scene plain = hanging_rope_of_law(std::nullopt);
  const Discretisation polygon = discretise(plain, plain.force_model);
  const Shape& shape = chain.shape;
  const double h = polygon.parameters.segment_length;
  double sum = 0;
  for (Eigen::Index i = 1; i + 1 < shape.points.cols(); ++i) {
    const Eigen::Vector3d a = shape.points.col(i) - shape.points.col(i - 1);
    const Eigen::Vector3d b = shape.points.col(i + 1) - shape.points.col(i);
    const double angle = std::atan2(a.cross(b).norm(), a.dot(b));
    sum += scene.bending_stiffness() / h * angle * angle / 2;
  }
  EXPECT_NEAR(chain.energy.bending, sum, 1e-9 * sum);
}

TEST(ModelChain, BetweenTwoClampsTooAndInItsEnergy) {
  Scene scene = hanging_rope_of_law(JointLaw::linear);
  Gripper far = scene.grippers.front();
  far.at = scene.length;
  far.position = {0.8, 0, 0};
  scene.grippers.push_back(far);
  scene.force_model.points = 20;
  const Solution linear = solve(scene, Model::chain);
  scene.force_model.joint_law = JointLaw::hooke;
  const Solution hooke = solve(scene, Model::chain);
  scene.force_model.joint_law.reset();
  const Solution plain = solve(scene, Model::chain);
  EXPECT_EQ(plain.shape.points, hooke.shape.points);
  EXPECT_NEAR(plain.energy.bending, hooke.energy.bending, 1e-12 * plain.energy.bending);
  // For any shape the potential of the linear law is lower, so its minimum is lower too.
  EXPECT_LT(linear.energy.total(), hooke.energy.total());
  EXPECT_GT((linear.shape.points - hooke.shape.points).colwise().norm().maxCoeff(), 1e-4);
}

TEST(ModelChain, LawIsAKeyOfTheSceneThatOtherModelsRefuse) {
  const std::string text =
      "[rod]\nlength = 1\nbending_stiffness = 1\nmass_per_length = 1\n"
      "[[gripper]]\nat = 0\nposition = [0, 0, 0]\ndirection = \"0 deg\"\n[force_model]\n";
  const Scene scene = parse_scene(text + "joint_law = \"binormal\"\n", "my.toml");
  EXPECT_EQ(scene.force_model.joint_law, JointLaw::binormal);
  const std::string of_force = error_of<InputError>([&] { (void)solve(scene, Model::force); });
  EXPECT_TRUE(has_all(of_force, {"only model chain supports this key"}));
  EXPECT_EQ(error_of<InputError>([&] { (void)compare(scene); }), of_force);
  EXPECT_TRUE(has_all(error_of<InputError>([&] {
                        (void)parse_scene(text + "law = \"paper\"\njoint_law = \"linear\"\n",
                                          "my.toml");
                      }),
                      {"joint_law would have no effect"}));
  EXPECT_TRUE(has_all(
      error_of<InputError>([&] { (void)parse_scene(text + "joint_law = \"cubic\"\n", "my.toml"); }),
      {"linear"}));
}

}  // namespace
}  // namespace dlo::compare
