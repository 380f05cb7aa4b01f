// Tests of `dlo regress`: baselines, verdicts and JUnit reports.

#include "batch/regression.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "../../says.hpp"
#include "dlo/compare/comparison.hpp"
#include "dlo/compare/deviation.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/force_model_settings.hpp"
#include "dlo/compare/solution.hpp"
#include "scene_text.hpp"
#include "scenes.hpp"

namespace dlo::compare {
namespace {

BaselineCase entry(const std::string& scene, double error, int points = 16) {
  BaselineCase result;
  result.scene = scene;
  result.points = points;
  result.errors = {error, 2 * error, 3 * error};
  return result;
}

RegressionVerdict verdict(const BaselineCase& before, const BaselineCase& now) {
  return judge_regression({before}, {{now, ""}}, {.relative = 0.1, .absolute = 1e-3})
      .front()
      .verdict;
}

TEST(Baseline, ReadsBackWhatItWritesInAnyOrder) {
  BaselineCase strange = entry("a \"quoted\\\" name,\n\ttabbed \x7f, caf\xc3\xa9", 1.0 / 3);
  strange.errors.tip.reset();
  strange.law = BendingLaw::paper;
  strange.model = Model::chain;
  strange.bookkeeping = Bookkeeping::paper;
  const BaselineCase zero = entry("zero", 0);
  const std::string text = baseline_text({zero, strange, entry("m", 1.5e-9)});
  EXPECT_EQ(baseline_text({strange, entry("m", 1.5e-9), zero}), text);
  const std::vector<BaselineCase> back = read_baseline(text, "b.toml");
  ASSERT_EQ(back.size(), 3U);
  EXPECT_EQ(back[0].name(), strange.name());
  EXPECT_EQ(back[0].errors.rms, 0.333333);
  EXPECT_FALSE(back[0].errors.tip.has_value());
  EXPECT_EQ(back[1].errors.rms, 1.5e-9);
  EXPECT_EQ(back[2].errors.max, 0);
  EXPECT_EQ(baseline_text(back), text);
}

TEST(Baseline, MalformedOnesNameFileLineKeyAndWhatIsAllowed) {
  const std::string good = baseline_text({entry("a", 0.1)});
  const auto message = [](const std::string& text) -> std::string {
    return error_of<InputError>([&] { return read_baseline(text, "b.toml"); });
  };
  const auto changed = [&](const std::string& from, const std::string& to) {
    return message(replaced(good, from, to));
  };
  const auto expect = [](const std::string& text, const std::vector<std::string>& words) {
    EXPECT_TRUE(has_none(text, {"\n"}));
    EXPECT_TRUE(has_all(text, words));
  };
  expect(message(""), {"b.toml", "schema", "missing"});
  expect(changed("baseline/1", "baseline/2"), {"b.toml:3", "schema", "dlo/baseline/1"});
  expect(changed("[[case]]", "[case]"), {"case", "[[case]]"});
  expect(changed("\"force\"", "\"energy\""), {"case.model", "energy", "chain, force"});
  expect(changed("points = 16", "points = 3"), {"case.points", "4 to"});
  expect(changed("rms_over_length = 0.1", "rms_over_length = -0.1"), {"rms_over_length", ">= 0"});
  expect(changed("rms_over_length = 0.1", "rms_over_length = nan #"), {"finite"});
  expect(message(good + good.substr(good.find("[[case]]"))), {"b.toml:15", "second case"});
}

TEST(Regression, OneWorseErrorOutweighsBetterOnes) {
  const BaselineCase before = entry("a", 0.05);
  BaselineCase now = entry("a", 0.01);
  EXPECT_EQ(verdict(before, now), RegressionVerdict::better);
  EXPECT_EQ(verdict(before, entry("a", NAN)), RegressionVerdict::worse);
  now.errors.tip = 0.2;
  EXPECT_EQ(verdict(before, now), RegressionVerdict::worse);
  now.errors.tip.reset();
  EXPECT_EQ(verdict(before, now), RegressionVerdict::worse);
}

TEST(Regression, CasesOfOneSideOnlyFail) {
  const std::vector<RegressionResult> results =
      judge_regression({entry("a", 0.1), entry("b", 0.1), entry("c", 0.1)},
                       {{entry("b", 0.1), ""}, {entry("d", 0.1), ""}, {entry("c", 0), "stuck"}});
  ASSERT_EQ(results.size(), 4U);
  EXPECT_EQ(results[0].verdict, RegressionVerdict::not_measured);
  EXPECT_EQ(results[1].verdict, RegressionVerdict::same);
  EXPECT_EQ(results[2].verdict, RegressionVerdict::not_solved);
  EXPECT_EQ(results[2].message, "stuck");
  EXPECT_EQ(results[3].verdict, RegressionVerdict::not_in_baseline);
  for (const std::size_t i : {0U, 2U, 3U}) EXPECT_TRUE(failed(results[i].verdict)) << i;
  EXPECT_FALSE(failed(results[1].verdict));
  EXPECT_THROW((void)judge_regression({}, {{entry("a", 0.1), ""}, {entry("a", 0.1), ""}}),
               InputError);
  EXPECT_THROW((void)judge_regression({}, {}, {.relative = -1}), std::invalid_argument);
}

TEST(Regression, ACaseWithOtherSettingsIsChangedWithBothErrors) {
  const std::vector<RegressionResult> points = judge_regression(
      {entry("a", 0.1), entry("b", 0.1)}, {{entry("a", 0.1, 17), ""}, {entry("b", 0.1), ""}});
  ASSERT_EQ(points.size(), 2U);
  EXPECT_EQ(points[0].verdict, RegressionVerdict::changed);
  EXPECT_EQ(points[0].message.find("N = 17 (baseline N = 16): RMS 10 % of l (baseline 10 %)"), 0U)
      << points[0].message;
  EXPECT_EQ(points[1].verdict, RegressionVerdict::same);
  // With several candidates the replaced case is unknown.
  const std::vector<RegressionResult> several =
      judge_regression({entry("a", 0.1)}, {{entry("a", 0.1, 17), ""}, {entry("a", 0.1, 18), ""}});
  ASSERT_EQ(several.size(), 3U);
  EXPECT_EQ(several[0].verdict, RegressionVerdict::not_measured);
  EXPECT_EQ(several[1].verdict, RegressionVerdict::not_in_baseline);
  // A case that is not solved does not also count as missing.
  const std::vector<RegressionResult> unsolved =
      judge_regression({entry("a", 0.1)}, {{entry("a", 0, 17), "stuck"}});
  ASSERT_EQ(unsolved.size(), 1U);
  EXPECT_EQ(unsolved[0].verdict, RegressionVerdict::not_solved);
}

TEST(Regression, AFingerprintStandsForAllThatTheShapeDependsOn) {
  Scene scene = test::heavy_scene(5, -30);
  scene.grippers.front().frame.emplace();
  scene.obstacles.push_back({});
  const auto digits = [](const Scene& of) { return case_of(of, Model::chain).fingerprint; };
  Scene renamed = scene;
  renamed.name = renamed.file = "other.toml";
  renamed.material.name = "other";
  renamed.grippers.front().where = "other.toml:3";
  EXPECT_EQ(digits(renamed), digits(scene));
  const auto differs = [&](const auto& change) {
    Scene changed = scene;
    change(changed);
    EXPECT_NE(digits(changed), digits(scene));
  };
  differs([](auto& s) { s.gravity.z() += 1e-6; });
  differs([](auto& s) { s.length *= 1.0001; });
  differs([](auto& s) { s.diameter *= 1.0001; });
  differs([](auto& s) { s.material.youngs_modulus *= 1.0001; });
  differs([](auto& s) { s.grippers.front().at += 1e-4; });
  differs([](auto& s) { s.grippers.front().position.x() += 1e-4; });
  differs([](auto& s) { s.grippers.front().direction.reset(); });
  differs([](auto& s) { s.torsional_stiffness = 1; });
  differs([](auto& s) { s.given_bending_stiffness = 1.0001 * s.bending_stiffness(); });
  differs([](auto& s) { s.natural_strain.y() = 1e-3; });
  differs([](auto& s) { s.natural_strain.z() = 1e-3; });
  differs([](auto& s) { s.natural_variation = {{0, 1e-3}}; });
  differs([](auto& s) {
    s.sections = {{.from = 0.1, .to = 0.2, .bending_stiffness = 1, .mass_per_length = 1}};
  });
  differs([](auto& s) { s.grippers.front().frame.reset(); });
  differs([](auto& s) { s.grippers.front().frame->roll = 1; });
  differs([](auto& s) { s.grippers.front().frame->d1 = Eigen::Vector3d::UnitZ(); });
  differs([](auto& s) { s.stretch = Stretch::counted; });
  differs([](auto& s) { s.loads.push_back({.at = 0}); });
  differs([](auto& s) { s.obstacles.push_back({}); });
  differs([](auto& s) { s.obstacles.front().friction = 0.3; });
  differs([](auto& s) { s.force_model.c_c = 660; });
  differs([](auto& s) { s.force_model.l_s = 660; });
  differs([](auto& s) { s.force_model.stepper = Stepper::basic; });
}

TEST(Regression, MeasuresWhatCompareMeasures) {
  Scene scene = test::heavy_scene(5, -30);
  scene.length = 2;
  scene.force_model.law = BendingLaw::paper;
  const Comparison expected = compare(scene);
  const BaselineCase measured = measure_case(scene, Model::force);
  EXPECT_DOUBLE_EQ(measured.errors.rms, expected.deviation.rms_m / 2);
  EXPECT_DOUBLE_EQ(measured.errors.max.value(), expected.deviation.max_m / 2);
  ASSERT_TRUE(measured.errors.tip.has_value());
  EXPECT_DOUBLE_EQ(*measured.errors.tip, expected.deviation.tip_m / 2);
  EXPECT_EQ(measured.name(), "heavy (force, law paper, bookkeeping consistent, N = 16)");
}

}  // namespace
}  // namespace dlo::compare
