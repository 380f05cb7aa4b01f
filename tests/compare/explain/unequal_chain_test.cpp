// Tests of chains of hinges with unequal segments, against an independent chain.

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "dlo/compare/scene.hpp"
#include "explain/own_polygon.hpp"
#include "rolled_chain.hpp"

namespace dlo::compare {
namespace {

constexpr double chain_weight = 30;  // weight [N/m] of 1 m with EI = 1 N m^2

Scene unequal_scene() {
  Scene scene;
  scene.file = "u.toml";
  scene.gravity = {0, -10, 0};
  scene.length = 1;
  scene.given_bending_stiffness = 1;
  scene.given_mass_per_length = chain_weight / 10;
  scene.grippers = {
      {.at = 0, .position = Eigen::Vector3d::Zero(), .direction = Eigen::Vector3d(1, 0, 0)}};
  return scene;
}

/// Returns the lengths of 20 segments that add up to 1 m; the longest is up to three times the
/// shortest.
Eigen::VectorXd unequal_segments() {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> length(0.5, 1.5);
  Eigen::VectorXd segments(20);
  for (double& h : segments) h = length(random);
  return segments / segments.sum();
}

Eigen::Matrix2Xd weights_of(const Eigen::VectorXd& h) {
  const Eigen::Index n = h.size();
  Eigen::Matrix2Xd forces = Eigen::Matrix2Xd::Zero(2, n + 1);
  forces.row(1).head(n) -= chain_weight * h.transpose() / 2;
  forces.row(1).tail(n) -= chain_weight * h.transpose() / 2;
  return forces;
}

/// Returns the points at rest of a chain with unequal segments whose springs are `factor` times EI
/// divided by the mean length of the two adjacent segments.
template <typename Moment>
Shape unequal_chain(const Moment& moment, double factor,
                    std::optional<Eigen::Matrix2Xd> acting = std::nullopt) {
  const Eigen::VectorXd h = unequal_segments();
  const Eigen::Index n = h.size();
  const Eigen::Matrix2Xd forces = acting.value_or(weights_of(h));
  const Eigen::VectorXd springs = 2 * factor * (h.head(n - 1) + h.tail(n - 1)).cwiseInverse();
  Shape shape;
  shape.points = test::chain_at_rest(h, springs, forces, moment);
  shape.arc_length = {0};
  for (const double part : h) shape.arc_length.push_back(shape.arc_length.back() + part);
  return shape;
}

const CandidateChain& welded(const std::vector<CandidateChain>& chains) {
  return *std::find_if(chains.begin(), chains.end(), [](const CandidateChain& chain) {
    return chain.clamp == ChainClamp::welded;
  });
}

TEST(UnequalChain, EachJointHasHalfOfBothItsSegments) {
  const Scene scene = unequal_scene();
  const auto expect = [&](const Shape& shape, energy_model::JointLaw law) {
    const std::vector<CandidateChain> chains =
        candidate_chains(scene, shape, Springs::rod_stiffness);
    ASSERT_FALSE(chains.empty());
    EXPECT_LT(welded(chains).rms_m, 1e-6);
    EXPECT_EQ(welded(chains).law, law);
    EXPECT_TRUE(welded(chains).is_law_identified);
    const std::vector<CandidateChain> fitted = candidate_chains(scene, shape, Springs::fitted);
    EXPECT_NEAR(welded(fitted).stiffness, 1, 1e-4);
  };
  expect(unequal_chain(test::linear_moment, 1), energy_model::JointLaw::linear);
  expect(unequal_chain(test::hooke_moment, 1), energy_model::JointLaw::hooke);
  expect(unequal_chain(test::binormal_moment, 1), energy_model::JointLaw::binormal);
}

TEST(UnequalChain, WrongSpringsAreNamedWithTheirFactor) {
  const Scene scene = unequal_scene();
  for (const double factor : {0.7, 1.4}) {
    const Shape shape = unequal_chain(test::linear_moment, factor);
    EXPECT_GT(welded(candidate_chains(scene, shape, Springs::rod_stiffness)).rms_m, 1e-3);
    const CandidateChain found = welded(candidate_chains(scene, shape, Springs::fitted));
    EXPECT_NEAR(found.stiffness, factor, 1e-4 * factor);
    EXPECT_LT(found.rms_m, 1e-6);
  }
}

// A floor pushes each point in proportion to its depth and to the mean length of its segments.
TEST(UnequalChain, AYieldingFloorPushesEachSegmentInProportionToItsLength) {
  constexpr double floor = 30;  // force per depth and length [N/m^2]
  Scene scene = unequal_scene();
  scene.obstacles = {
      {obstacle::Body::half_space(Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitY()), floor}};
  const Eigen::VectorXd h = unequal_segments();
  const Eigen::Index n = h.size();
  Eigen::RowVectorXd stiffness(n + 1);
  stiffness << h[0], (h.head(n - 1) + h.tail(n - 1)).transpose() / 2, h[n - 1];
  stiffness *= floor;
  Eigen::Matrix2Xd forces = weights_of(h);
  Shape shape;
  double change = 1;
  for (int i = 0; i < 400 && change > 1e-10; ++i) {
    shape = unequal_chain(test::linear_moment, 1, forces);
    Eigen::Matrix2Xd next = weights_of(h);
    next.row(1) += stiffness.cwiseProduct((-shape.points.row(1)).cwiseMax(0));
    change = (next - forces).norm();
    forces += 0.2 * (next - forces);
  }
  ASSERT_LT(change, 1e-10);
  ASSERT_LT(shape.points.row(1).minCoeff(), -0.1);
  EXPECT_LT(welded(candidate_chains(scene, shape, Springs::rod_stiffness)).rms_m, 1e-6);
}

}  // namespace
}  // namespace dlo::compare
