// Tests of the command `dlo regress`, by hand and in a CI.

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "command_fixture.hpp"
#include "dlo/compare/deviation.hpp"
#include "scene_text.hpp"

namespace dlo::compare {
namespace {

class RegressCommand : public Command {
 protected:
  void SetUp() override {
    Command::SetUp();
    arguments_ = "regress --model chain --baseline " + path("b.toml") + " ";
    succeeds(arguments_ + steel() + " --update");
  }

  /// Replaces the number behind the first occurrence of a key in the baseline.
  void set(const std::string& key, const std::string& number) const {
    std::string text = read(path("b.toml"));
    const std::size_t begin = text.find(key + " = ") + key.size() + 3;
    text.replace(begin, text.find('\n', begin) - begin, number);
    std::ofstream(path("b.toml")) << text;
  }

  /// Returns the value of an XPath expression on the JUnit file, by libxml2's reader.
  [[nodiscard]] std::string junit(const std::string& expression) const {
    const std::string line =
        "xmllint --xpath '" + expression + "' " + path("j.xml") + " >" + path("value") + " 2>&1";
    EXPECT_EQ(std::system(line.c_str()), 0) << read(path("value"));
    return read(path("value"));
  }

  std::string arguments_;
  const std::string other = shipped_scene("spring_steel_135");
};

TEST_F(RegressCommand, MayTolerateAShareOfTheDeflection) {
  const std::string check = "check " + steel() + " --tolerance '1% of deflection' --shape " +
                            solved_file(steel() + " --samples 21");
  // Divided by the length.
  const double deflection = json_of(check).at("deflection_m").get<double>() / 0.5;
  const double tip =
      json_of(arguments_ + steel()).at("cases")[0].at("measured").at("tip_over_length");
  const auto failures_at = [&](double shares_of_deflection) {
    set("tip_over_length", std::to_string(tip - shares_of_deflection * deflection));
    return run(arguments_ + steel() + " --relative 0 --tolerance '5% of deflection'").status;
  };
  EXPECT_EQ(failures_at(0.049), 0);
  EXPECT_EQ(failures_at(0.051), 1);
  expect_output(arguments_ + steel() + " --tolerance '2 mm'", 2,
                {"2 mm: no share of the length", "5% of deflection"});
  EXPECT_EQ(run(arguments_ + steel() + " --tolerance 1% --absolute 1%").status, 2);
}

// A change by another process in the meantime is preserved, so one of two concurrent updates is
// refused.
TEST_F(RegressCommand, UpdateLeavesABaselineThatHasChangedSinceItWasRead) {
  const std::string dlo = DLO_COMMAND;
  std::ofstream(path("meanwhile.sh"))
      << dlo << " " << arguments_ << other << " --update >/dev/null\n"
      << dlo << " solve " << steel() << " --model chain --format csv -o \"$1\"\n";
  expect_output(
      arguments_ + steel() + " --with \"m=sh " + path("meanwhile.sh") + " {shape}\" --update", 5,
      {"b.toml: left as it is: another process"});
  EXPECT_EQ(run(arguments_ + other).out.substr(0, 5), "same ");
}

TEST_F(RegressCommand, AProgramThatIsNotGivenIsAskedFor) {
  const std::string with = " --with mine='" + std::string(DLO_COMMAND) + " solve " + steel() +
                           " --format csv -o {shape}'";
  succeeds(arguments_ + steel() + with + " --update");
  expect_output(arguments_ + steel(), 1,
                {"in the baseline, of a program: --with mine='COMMAND' runs it"});
  succeeds(arguments_ + steel() + with);
}

TEST_F(RegressCommand, AnEndThatIsAppendedToAProgramsPointsIsStatedHereAndByBench) {
  write("starts.sh",
        "for i in 0 0625 125 1875 25 3125 375 4375; do echo \"0.$i,0,0\"; done >\"$1\"\n");
  const std::string file = scene("gravity = [0, -9.81, 0]\n" + steel_rod + level_clamp);
  const std::string with = file + " --with \"mine=sh " + path("starts.sh") + " {shape}\"";
  const std::string note = "8 points are the start points of the segments; the end of the last";
  expect_output(arguments_ + with, 1, {"not in the baseline (--update adds it); its " + note});
  expect_output("bench --seconds 1 --repeats 1 " + with, 0, {": mine: its " + note});
}

TEST_F(RegressCommand, UpdateSaysWhatItDid) {
  EXPECT_EQ(run(arguments_ + steel() + " --update").out.substr(0, 5), "same ");
  const std::string both = run(arguments_ + steel() + " " + other + " --update").out;
  EXPECT_TRUE(has_none(both, {"--update adds it"}));
  EXPECT_TRUE(has_all(both, {"added "}));
  const std::string removed = run(arguments_ + steel() + " --update").out;
  EXPECT_TRUE(has_all(removed, {"removed "}));
  set("rms_over_length", "0.3");
  EXPECT_EQ(run(arguments_ + steel() + " --update").out.substr(0, 8), "changed ");
}

TEST_F(RegressCommand, AWorseErrorFailsAndABetterOneIsReported) {
  set("rms_over_length", "0.2");
  EXPECT_TRUE(has_all(output_of(arguments_ + steel(), 1), {"(baseline 20 %) worse"}));
  succeeds(arguments_ + steel() + " --relative 0.1");
  succeeds(arguments_ + steel() + " --absolute 0.02");
  set("rms_over_length", "0.3");
  EXPECT_TRUE(has_all(output_of(arguments_ + steel()), {"1 better"}));
}

TEST_F(RegressCommand, AMissingBaselineOrCaseOnEitherSideFails) {
  expect_error(
      "regress --baseline " + path("none.toml") + " " + steel(), 2,
      {"none.toml: cannot be read (No such file or directory); --update writes a first baseline"});
  expect_output(arguments_ + steel() + " " + other, 1, {"1 not in the baseline"});
  EXPECT_TRUE(has_all(output_of(arguments_ + steel() + " --points 20", 1),
                      {"N = 20 (baseline N = 16): RMS", "\n1 changed\n"}));
}

TEST_F(RegressCommand, AnotherSceneOfTheSameNameIsChanged) {
  const std::string loaded =
      replaced(read(steel()), "\n[rod]", "\n[[load]]\nat = 0.5\nforce = [0, 1e-9, 0]\n[rod]");
  const std::string out = output_of(arguments_ + scene(loaded), 1);
  EXPECT_TRUE(out.starts_with("changed ")) << out;
  EXPECT_TRUE(has_all(out, {"another than the baseline's: RMS"}));
  // A scene does not change if its length is written in another unit.
  succeeds(arguments_ + scene(replaced(read(steel()), "\"50 cm\"", "0.5")));
}

TEST_F(RegressCommand, TakesPercentAndSharesAlikeAndOnePercentByDefault) {
  const double rms =
      json_of(arguments_ + steel()).at("cases")[0].at("measured").at("rms_over_length");
  const auto status = [&](double before, const std::string& options) {
    set("rms_over_length", std::to_string(before));
    return run(arguments_ + steel() + options).status;
  };
  // std::to_string has six decimals, 1e-5 of an error of a tenth.
  EXPECT_EQ(status(rms / 1.0099, ""), 0);
  EXPECT_EQ(status(rms / 1.0102, ""), 1);
  for (const std::string five : {" --relative 5%", " --relative 0.05"}) {
    EXPECT_EQ(status(rms / 1.049, five), 0) << five;
    EXPECT_EQ(status(rms / 1.051, five), 1) << five;
  }
  EXPECT_EQ(status(rms - 0.01, " --relative 0 --absolute 2%"), 0);
  expect_error(arguments_ + steel() + " --relative nan", 2, {"--relative", "nan", "1% or 0.01"});
  expect_error(arguments_ + steel() + " --absolute x", 2, {"--absolute", "x", "1% or 0.01"});
}

TEST_F(RegressCommand, WhatIsNotSolvedIsStatusThreeAndUpdatesNothing) {
  const std::string before = read(path("b.toml"));
  for (const std::string update : {"", " --update"}) {
    expect_output(arguments_ + steel() + " --max-evaluations 1" + update, 3, {"did not converge"});
    EXPECT_EQ(read(path("b.toml")), before);
  }
}

TEST_F(RegressCommand, BadInputIsOneLineAndStatusTwo) {
  expect_error(arguments_ + path("none.toml"), 2, {"none.toml"});
  expect_error(arguments_ + steel() + " " + steel(), 2, {"two scenes have this case"});
  expect_error(arguments_ + steel() + " --relative -1", 2, {"--relative"});
  expect_error("regress " + steel(), 2, {"--baseline"});
  set("rms_over_length", "-1");
  expect_error(arguments_ + steel(), 2, {"b.toml:11", "rms_over_length = -1", ">= 0"});
  expect_error(arguments_ + steel() + " --update", 2, {"b.toml:11"});
  std::ofstream(path("b.toml")) << "rubbish";
  expect_error(arguments_ + steel(), 2, {"b.toml:1", "not valid TOML"});
}

TEST_F(RegressCommand, WritesJunitThatAnXmlReaderTakes) {
  set("tip_over_length", "0.1");
  const std::string strange =
      scene("name = \"<&>'\\\" \\u0001 caf\\u00e9\"\n" + steel_rod + level_clamp);
  EXPECT_EQ(run(arguments_ + steel() + " " + strange + " --junit " + path("j.xml")).status, 1);
  EXPECT_EQ(junit("string(/testsuites/testsuite/@tests)"), "2\n");
  EXPECT_EQ(junit("string(/testsuites/testsuite/@failures)"), "2\n");
  EXPECT_EQ(junit("count(//testcase/failure)"), "2\n");
  EXPECT_EQ(junit("string(//testcase[failure/@type=\"not in the baseline\"]/@name)"),
            "<&>'\"   caf\xc3\xa9 (chain, law hooke, bookkeeping consistent, N = 16)\n");
  EXPECT_TRUE(has_all(junit("string(//failure[@type=\"worse\"]/@message)"), {"tip"}));
}

}  // namespace
}  // namespace dlo::compare
