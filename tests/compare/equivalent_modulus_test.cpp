// What the paper's cubic law stands for: closed forms against the chain model and the shipped map.

#include "dlo/compare/equivalent_modulus.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "dlo/compare/discretise.hpp"
#include "dlo/compare/effective_modulus.hpp"
#include "dlo/compare/solve.hpp"
#include "dlo/compare/sweep.hpp"
#include "dlo/energy_model/chain.hpp"
#include "scenes.hpp"

namespace {

using dlo::compare::BendingRule;
using dlo::compare::equivalent_bending_stiffness;
using dlo::compare::paper_bending_stiffness;
using dlo::compare::paper_joint_angle;
using dlo::compare::paper_joint_moment;

TEST(EquivalentModulus, IsThePhysicalOneWhereTheRuleSaysSo) {
  const double EI = 0.165;
  const double k = 5;
  const double L = 1.0 / 30;
  const double formula_21 = paper_bending_stiffness(BendingRule::formula_21, EI, k, L);
  const double matched = paper_bending_stiffness(BendingRule::moment_matched, EI, k, L);
  EXPECT_NEAR(equivalent_bending_stiffness(formula_21, L, k * L), EI * k * L, 1e-15);
  EXPECT_NEAR(equivalent_bending_stiffness(matched, L, k * L), EI, 1e-14);
  // (3) at another angle
  const double alpha = 0.4;
  const double ratio =
      k * L * k * L / alpha * std::pow(std::sin(alpha / 2) / std::sin(k * L / 2), 3);
  EXPECT_NEAR(equivalent_bending_stiffness(formula_21, L, alpha), EI * ratio, 1e-14);
}

TEST(EquivalentModulus, MomentIsTheDerivativeOfThePotential) {
  const double c_b = 3;
  const double L = 0.2;
  const auto potential = [&](double alpha) {
    const double half = std::cos(alpha / 2);
    return c_b * L * (8.0 / 3 - 4 * half + 4.0 / 3 * half * half * half);
  };
  for (const double alpha : {0.01, 0.5, 1.5, 3.0}) {
    const double h = 1e-4;
    EXPECT_NEAR(paper_joint_moment(c_b, L, alpha),
                (potential(alpha + h) - potential(alpha - h)) / (2 * h), 1e-8);
    EXPECT_NEAR(paper_joint_angle(c_b, L, paper_joint_moment(c_b, L, alpha)), alpha, 1e-12);
  }
  EXPECT_NEAR(equivalent_bending_stiffness(c_b, L, 1e-3) / (c_b * L * L * 1e-6 / 4), 1, 1e-6);
  EXPECT_EQ(equivalent_bending_stiffness(c_b, L, 0), 0);
}

TEST(EquivalentModulus, RefusesWhatIsNoJoint) {
  EXPECT_THROW((void)paper_joint_moment(0, 1, 1), std::invalid_argument);
  EXPECT_THROW((void)paper_joint_moment(1, NAN, 1), std::invalid_argument);
  EXPECT_THROW((void)paper_joint_moment(1, 1, 3.2), std::invalid_argument);
  EXPECT_THROW((void)paper_joint_angle(1, 1, 2.1), std::invalid_argument);
  EXPECT_THROW((void)paper_joint_angle(1, 1, -1), std::invalid_argument);
  EXPECT_THROW((void)equivalent_bending_stiffness(1, 1, NAN), std::invalid_argument);
}

TEST(EquivalentModulus, AChainUnderAnEndCoupleTurnsAtEveryJointAsARodOfThatModulusDoes) {
  // The couple is a pair of forces across the last segment; its moment reaches every joint. Less
  // than a quarter turn in all, or the same forces bend the rod the other way.
  const Eigen::Index segments = 4;
  const double L = 0.1;
  const double c_b = 40;
  for (const double alpha : {0.05, 0.2, 0.4}) {
    const double curvature = alpha / L;
    const double moment = equivalent_bending_stiffness(c_b, L, alpha) * curvature;
    const double last = alpha * static_cast<double>(segments - 1);
    dlo::energy_model::ChainProblem problem;
    problem.segment_lengths = Eigen::VectorXd::Constant(segments, L);
    problem.law = dlo::energy_model::JointLaw::paper;
    problem.stiffness = c_b;
    problem.node_forces.setZero(2, segments + 1);
    const Eigen::Vector2d across(-std::sin(last), std::cos(last));
    problem.node_forces.col(segments) = moment / L * across;
    problem.node_forces.col(segments - 1) = -moment / L * across;
    const dlo::energy_model::ChainResult result = dlo::energy_model::solve_chain(problem);
    ASSERT_TRUE(dlo::energy_model::succeeded(result.status)) << result.message;
    for (Eigen::Index i = 1; i < segments; ++i) {
      const Eigen::Vector2d u = result.points.col(i) - result.points.col(i - 1);
      const Eigen::Vector2d v = result.points.col(i + 1) - result.points.col(i);
      EXPECT_NEAR(std::atan2(u.x() * v.y() - u.y() * v.x(), u.dot(v)), alpha, 1e-6) << i;
    }
  }
}

TEST(EquivalentModulus, PredictsTheBestFitOfACantileverUnderLittleWeight) {
  const double factor = 23023.0 / 32346;
  for (const int points : {16, 64}) {
    for (const double gamma : {1e-4, 1e-3}) {
      dlo::compare::Scene scene = dlo::test::heavy_scene(gamma, 0);
      scene.force_model.law = dlo::compare::Law::paper;
      scene.force_model.points = points;
      scene.force_model.design_curvature = 2.5;
      const dlo::compare::Solution chain = dlo::compare::solve(scene, dlo::compare::Model::chain);
      const double c_b = chain.parameters.c_b;
      const double L = chain.parameters.segment_length;
      const double moment = scene.weight_per_length().norm() / 2;
      const double predicted =
          factor * equivalent_bending_stiffness(c_b, L, paper_joint_angle(c_b, L, moment)) /
          scene.bending_stiffness();
      const dlo::compare::EffectiveModulus fitted =
          dlo::compare::fit_effective_modulus(scene, chain.shape);
      // Slopes are not quite small (up to 0.2 rad), and 16 points are few.
      EXPECT_NEAR(fitted.ratio / predicted, 1, 0.02) << points << " " << gamma;
    }
  }
}

/// The grid of data/effective_modulus.csv, as the README's command has it.
dlo::compare::Sweep shipped_map() {
  std::vector<dlo::compare::Axis> axes;
  for (const char* text :
       {"force_model.bookkeeping=consistent", "force_model.law=paper,hooke",
        "force_model.points=8,16,32,64", "gripper.0.direction=-60 deg,-30 deg,0 deg,30 deg,60 deg",
        "gamma=log:0.03:30:13"}) {
    axes.push_back(dlo::compare::parse_axis(text));
  }
  return {
      dlo::compare::load_scene_template(std::string(DLO_DATA) + "/scenes/spring_steel_175.toml"),
      dlo::compare::Grid(axes), dlo::compare::SweepModel::compare_chain};
}

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> fields(1);
  for (const char c : line) {
    if (c == ',') {
      fields.emplace_back();
    } else {
      fields.back() += c;
    }
  }
  return fields;
}

std::vector<std::string> map_lines() {
  std::ifstream stream(std::string(DLO_DATA) + "/effective_modulus.csv");
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

TEST(EffectiveModulusMap, IsWhatItsCommandWrites) {
  const dlo::compare::Sweep sweep = shipped_map();
  const std::vector<std::string> lines = map_lines();
  ASSERT_EQ(static_cast<std::int64_t>(lines.size()), sweep.grid().size() + 1);
  EXPECT_EQ(lines[0] + "\n", sweep.header());
  const std::vector<std::string> columns = split(lines[0]);
  for (std::int64_t row = 3; row < sweep.grid().size(); row += 47) {
    const std::vector<std::string> shipped = split(lines[static_cast<std::size_t>(row) + 1]);
    const std::vector<std::string> fresh = split(sweep.row(row));
    ASSERT_EQ(fresh.size(), shipped.size());
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const bool result = columns[i].find("_over_length") != std::string::npos ||
                          columns[i] == "effective_modulus_ratio";
      if (i < 6) {
        EXPECT_EQ(fresh[i], shipped[i]);
      }
      // Shapes are minimised to about 1e-10 of the length, the fit to 1e-7 of the modulus.
      if (result) {
        EXPECT_NEAR(std::stod(fresh[i]), std::stod(shipped[i]), 1e-6) << columns[i];
      }
    }
  }
}

TEST(EffectiveModulusMap, HookeIsNearOneAndThePaperLawIsNot) {
  const std::vector<std::string> lines = map_lines();
  const std::vector<std::string> columns = split(lines.at(0));
  const auto column = [&](const std::string& name) {
    return static_cast<std::size_t>(std::find(columns.begin(), columns.end(), name) -
                                    columns.begin());
  };
  int rows = 0;
  int near_one = 0;
  int far_off = 0;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const std::vector<std::string> fields = split(lines[i]);
    ASSERT_EQ(fields.at(column("status")), "ok") << lines[i];
    const double ratio = std::stod(fields.at(column("effective_modulus_ratio")));
    if (fields.at(column("force_model.law")) == "hooke") {
      const double n = std::stod(fields.at(column("force_model.points"))) - 1.5;
      EXPECT_NEAR(ratio, 1, 10 / (n * n)) << lines[i];
    } else {
      // A cubic law is right at one load at most: few rows are near it, and others far off.
      near_one += std::abs(std::log(ratio)) < std::log(1.1) ? 1 : 0;
      far_off += ratio < 0.1 ? 1 : 0;
    }
    ++rows;
  }
  EXPECT_EQ(rows, 520);
  EXPECT_LE(near_one, 5);
  EXPECT_GE(far_off, 50);
}

}  // namespace
