// Baselines, verdicts, JUnit.

#include "dlo/compare/regression.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "dlo/compare/comparison.hpp"
#include "dlo/compare/error.hpp"
#include "scenes.hpp"

namespace {

using dlo::compare::baseline_text;
using dlo::compare::BaselineCase;
using dlo::compare::InputError;
using dlo::compare::judge_regression;
using dlo::compare::read_baseline;
using dlo::compare::RegressionResult;
using dlo::compare::RegressionVerdict;

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
  strange.law = dlo::compare::Law::paper;
  strange.model = dlo::compare::Model::chain;
  strange.bookkeeping = dlo::compare::Bookkeeping::paper;
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
    try {
      (void)read_baseline(text, "b.toml");
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  };
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    text.replace(text.find(from), from.size(), to);
    return message(text);
  };
  const auto expect = [](const std::string& text, const std::vector<std::string>& words) {
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
    for (const std::string& word : words) {
      EXPECT_NE(text.find(word), std::string::npos) << "no " << word << " in " << text;
    }
  };
  expect(message(""), {"b.toml", "schema", "missing"});
  expect(message(std::string(40, '\0')), {"b.toml", "not valid TOML"});
  expect(message("case"), {"b.toml:1", "not valid TOML"});
  expect(changed("baseline/1", "baseline/2"), {"b.toml:3", "schema", "dlo/baseline/1"});
  expect(changed("[[case]]", "[case]"), {"case", "[[case]]"});
  expect(changed("[[case]]", "[[cases]]"), {"cases", "unknown key"});
  expect(changed("scene = \"a\"", "scene = 3"), {"case.scene", "must be a string"});
  expect(changed("scene = \"a\"\n", ""), {"case.scene", "missing"});
  expect(changed("\"force\"", "\"energy\""), {"case.model", "energy", "chain, force"});
  expect(changed("\"hooke\"", "\"hook\""), {"case.law", "hook", "paper, hooke"});
  expect(changed("\"consistent\"", "\"\""), {"case.bookkeeping", "paper, consistent"});
  expect(changed("points = 16", "points = 16.5"), {"case.points", "16.5", "whole number"});
  expect(changed("points = 16", "points = 3"), {"case.points", "4 to"});
  expect(changed("rms_over_length = 0.1", "rms_over_length = -0.1"), {"rms_over_length", ">= 0"});
  expect(changed("rms_over_length = 0.1", "rms_over_length = nan #"), {"finite"});
  expect(changed("max_over_length = 0.2", "max_over_length = inf #"), {"finite"});
  expect(changed("max_over_length = 0.2", "max_over_length = \"2 mm\" #"), {"max_over_length"});
  expect(changed("tip_over_length", "top_over_length"), {"top_over_length", "unknown key"});
  expect(message(good + good.substr(good.find("[[case]]"))), {"b.toml:15", "second case"});
}

TEST(Regression, ToleratesAShareOfTheErrorAndAShareOfTheRod) {
  const BaselineCase before = entry("a", 0.05);
  EXPECT_EQ(verdict(before, before), RegressionVerdict::same);
  // RMS 0.05: margin 0.001 + 0.005; tip 0.15: margin 0.016
  EXPECT_EQ(verdict(before, entry("a", 0.0552)), RegressionVerdict::same);
  EXPECT_EQ(verdict(before, entry("a", 0.0448)), RegressionVerdict::same);
  EXPECT_EQ(verdict(before, entry("a", 0.0562)), RegressionVerdict::worse);
  EXPECT_EQ(verdict(before, entry("a", 0.0438)), RegressionVerdict::better);
  EXPECT_EQ(verdict(entry("a", 0), entry("a", 3e-4)), RegressionVerdict::same);
  EXPECT_EQ(verdict(before, entry("a", NAN)), RegressionVerdict::worse);
}

TEST(Regression, OneWorseErrorOutweighsBetterOnes) {
  const BaselineCase before = entry("a", 0.05);
  BaselineCase now = entry("a", 0.01);
  EXPECT_EQ(verdict(before, now), RegressionVerdict::better);
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
  // Other points are another case.
  EXPECT_EQ(judge_regression({entry("a", 0.1)}, {{entry("a", 0.1, 17), ""}}).size(), 2U);
  EXPECT_THROW((void)judge_regression({}, {{entry("a", 0.1), ""}, {entry("a", 0.1), ""}}),
               InputError);
  EXPECT_THROW((void)judge_regression({}, {}, {.relative = -1}), std::invalid_argument);
}

TEST(Regression, MeasuresWhatCompareMeasures) {
  dlo::compare::Scene scene = dlo::test::heavy_scene(5, -30);
  scene.length = 2;
  scene.force_model.law = dlo::compare::Law::paper;
  const dlo::compare::Comparison expected = dlo::compare::compare(scene);
  const BaselineCase measured = dlo::compare::measure_case(scene, dlo::compare::Model::force);
  EXPECT_DOUBLE_EQ(measured.errors.rms, expected.deviation.rms_m / 2);
  EXPECT_DOUBLE_EQ(measured.errors.max, expected.deviation.max_m / 2);
  ASSERT_TRUE(measured.errors.tip.has_value());
  EXPECT_DOUBLE_EQ(*measured.errors.tip, expected.deviation.tip_m / 2);
  EXPECT_EQ(measured.name(), "heavy (force, law paper, bookkeeping consistent, N = 16)");
}

TEST(Regression, JunitCountsAndEscapes) {
  const std::string xml = dlo::compare::junit_xml(
      judge_regression({entry("a<b> & \"c\"\x01", 0.1), entry("e", 0.1)},
                       {{entry("e", 0.2), ""}, {entry("f", 0), "no <rest>\nhere"}}));
  EXPECT_NE(xml.find("tests=\"3\" failures=\"2\" errors=\"1\""), std::string::npos) << xml;
  EXPECT_NE(xml.find("a&lt;b&gt; &amp; &quot;c&quot;  (force"), std::string::npos) << xml;
  EXPECT_NE(xml.find("<error type=\"not solved\" message=\"no &lt;rest&gt; here\"/>"),
            std::string::npos)
      << xml;
}

}  // namespace
