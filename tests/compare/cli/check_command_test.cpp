// The command check as a user runs it.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "base/quote.hpp"
#include "command_fixture.hpp"

namespace {

using dlo::test::says;
using dlo::test::says_none;

namespace compare = dlo::compare;
using dlo::test::Command;
using dlo::test::Outcome;
using nlohmann::json;

class CheckCommand : public Command {
 protected:
  std::string shape(const std::string& text) { return write("shape", text); }
};

TEST_F(CheckCommand, ReadsWhatSolveWrites) {
  for (const std::string format : {"csv", "json"}) {
    const std::string file = path("solved." + format);
    succeeds(words({"solve", steel(), "--model exact --samples 9 --format", format, "-o", file}));
    const json document = json_of(words({"check", steel(), "--shape", file, "--tolerance 0.01%"}));
    EXPECT_EQ(document.at("schema"), "dlo/check/1");
    EXPECT_EQ(document.at("verdict"), "pass");
    EXPECT_EQ(document.at("tolerance").at("allowed_m"), 0.5 * 0.0001);
    EXPECT_EQ(document.at("arc_lengths"), "file");
    EXPECT_LT(document.at("deviation").at("rms_m").get<double>(), 1e-9);
    EXPECT_NEAR(document.at("effective_modulus_ratio"), 1, 1e-5);
    EXPECT_EQ(document.at("points_m").size(), 9U);
  }
}

TEST_F(CheckCommand, ExitStatusIsTheVerdict) {
  const std::string file = solved_file(steel() + " --model chain");
  // The paper's law is 21 % of the length off, at most 226 mm.
  const std::string check = "check " + steel() + " --shape " + file;
  succeeds(check);
  succeeds(check + " --tolerance 22%");
  EXPECT_EQ(run(check + " --tolerance 20%").status, 1);
  succeeds(check + " --tolerance \"110 mm\"");
  EXPECT_EQ(run(check + " --tolerance \"110 mm\" --measure max").status, 1);
  const Outcome failed = run(check + " --tolerance 1% --format json");
  EXPECT_EQ(failed.status, 1);
  EXPECT_EQ(failed.err, "");
  EXPECT_EQ(json::parse(failed.out).at("verdict"), "fail");
  EXPECT_TRUE(says(run(check + " --tolerance 1%").out, {"fail: RMS 106.2 mm, allowed 5 mm"}));
}

TEST_F(CheckCommand, WithoutAToleranceTheVerdictIsOfOnePercent) {
  const std::string file = solved_file(steel() + " --model chain");
  const std::string check = "check " + steel() + " --shape " + file;
  const json by_default = json_of(check);
  const json asked = json_of(check + " --tolerance 1%", 1);
  EXPECT_EQ(by_default.at("verdict"), "fail");
  EXPECT_EQ(by_default.at("tolerance").at("default"), true);
  EXPECT_EQ(asked.at("tolerance").at("default"), false);
  EXPECT_EQ(by_default.at("tolerance").at("allowed_m"), asked.at("tolerance").at("allowed_m"));
  EXPECT_EQ(by_default.at("explanations"), asked.at("explanations"));
  EXPECT_TRUE(says(run(check).out, {"allowed 5 mm = 1 % of l, the default"}));
}

TEST_F(CheckCommand, MeasureAndTheSeenShareCountWithoutATolerance) {
  // RMS 106 mm, largest 226 mm.
  const std::string check =
      "check " + steel() + " --shape " + solved_file(steel() + " --model chain");
  const json largest = json_of(check + " --measure max");
  EXPECT_EQ(largest.at("tolerance").at("measure"), "max");
  EXPECT_EQ(largest.at("tolerance").at("default"), true);
  EXPECT_EQ(largest.at("judged_m"), largest.at("deviation").at("whole_max_m"));
  const json part = json_of(check + " --min-seen 20%");
  EXPECT_EQ(part.at("tolerance").at("part"), true);
  EXPECT_EQ(part.at("tolerance").at("least_seen_share"), 0.2);
}

TEST_F(CheckCommand, AToleranceMayBeAShareOfTheDeflection) {
  const std::string stiff = scene(R"(
[rod]
length = "4 m"
bending_stiffness = 4e4
mass_per_length = 2
[[gripper]]
at = 0
position = [0, 0, 0]
direction = "0 deg"
)");
  const std::string check = "check " + stiff + " --shape " + shape("x,y\n0,0\n2,0\n4,0\n");
  const json line = json_of(check + " --tolerance 1%");
  EXPECT_EQ(line.at("verdict"), "pass");
  EXPECT_EQ(line.at("significant"), false);
  EXPECT_TRUE(says(run(check).out, {"not significant for stiffness or weight"}));
  const json failed = json_of(check + " --tolerance \"5% of deflection\"", 1);
  EXPECT_EQ(failed.at("verdict"), "fail");
  EXPECT_TRUE(failed.at("significant").is_null());
  EXPECT_EQ(failed.at("tolerance").at("of_deflection"), true);
  const double sag = 2 * 9.81 * 256 / (8 * 4e4);  // w l^4 / (8 EI)
  EXPECT_NEAR(failed.at("deflection_m"), sag, 1e-3 * sag);
  EXPECT_DOUBLE_EQ(failed.at("tolerance").at("allowed_m"),
                   0.05 * failed.at("deflection_m").get<double>());
  for (const std::string share : {"0% of deflection", "100% of deflection", "x of deflection"}) {
    const Outcome refused = run(check + " --tolerance \"" + share + "\"");
    EXPECT_EQ(refused.status, 2);
    EXPECT_TRUE(says(refused.err, {"--tolerance = " + share + ": no share of the deflection"}));
  }
  const std::string recorded = write("markers", "time,s,x,y,z\n0,1,1,0,0\n1,1,1,0,0\n");
  const Outcome moving =
      run("check " + stiff + " --motion " + recorded + " --tolerance \"5% of deflection\"");
  EXPECT_TRUE(says(moving.err, {"a recorded motion has no single one"})) << moving.out;
}

TEST_F(CheckCommand, AFileThatDoesNotDetermineTheRodIsUndetermined) {
  const std::string heavy = scene(R"(
[rod]
length = 1
bending_stiffness = 0.01
mass_per_length = 0.1
[[gripper]]
at = 0
position = [0, 0, 0]
direction = "0 deg"
)");
  const std::string file = solved_file(heavy + " --samples 4");
  const json document = json_of("check " + heavy + " --tolerance 1% --shape " + file, 1);
  EXPECT_EQ(document.at("verdict"), "undetermined");
  EXPECT_LT(document.at("judged_m"), 1e-6);
  EXPECT_TRUE(document.at("explanations").empty());
  EXPECT_TRUE(says(document.at("reason"), {"the points do not determine the rod at s = "}));
}

// A chain's points are explained by its springs, not by another material; one line states this.
TEST_F(CheckCommand, AModulusThatIsSupersededIsNoOptimum) {
  const std::string file = solved_file(steel() + " --model chain");
  const std::string check = "check " + steel() + " --tolerance 1% --shape " + file;
  const json document = json_of(check, 1);
  ASSERT_FALSE(document.at("superseded_by").is_null()) << document.dump();
  const std::string text = run(check).out;
  EXPECT_TRUE(says(text, {"  E*/E            no measure of the material: "}));
  EXPECT_TRUE(says_none(text, {"optimum"}));
}

TEST_F(CheckCommand, APassBesideAnotherStiffnessSaysWhyBothHold) {
  const std::string rod = R"(
[[gripper]]
at = 0
position = [0, 0, 0]
direction = "0 deg"
[rod]
length = 1
mass_per_length = 0.1
bending_stiffness = )";
  const std::string stiff = scene(rod + "0.6\n");
  const std::string file = solved_file(stiff + " --samples 21");
  const std::string soft = scene(rod + "0.5\n");
  const std::string words = "E*/E = 1.2 is no contradiction: ";
  const std::string wide = run("check " + soft + " --tolerance 10% --shape " + file).out;
  EXPECT_TRUE(says(wide, {words, "verdict         pass"}));
  // Where it fails, E* is the explanation.
  const std::string narrow = run("check " + soft + " --tolerance 0.1% --shape " + file).out;
  EXPECT_TRUE(says_none(narrow, {words}));
}

TEST_F(CheckCommand, TheReportIsOnePage) {
  const std::string file = shape("x,y\n0,0\n0.3,<b>\n");
  const std::string page = path("page.html");
  const std::string check = "check " + steel() + " --report " + page + " --shape ";
  EXPECT_EQ(run(check + file).status, 2);
  EXPECT_FALSE(std::filesystem::exists(page)) << "nothing is written of what could not be read";
  const std::string solved = path("a<b>&.csv");
  succeeds("solve " + steel() + " --model chain --format csv -o " + compare::shell_word(solved));
  succeeds(check + compare::shell_word(solved));
  const std::string html = read(page);
  EXPECT_TRUE(says(html, {"<p class=\"badge fail\">", "a&lt;b&gt;&amp;.csv is 106.2"}));
  EXPECT_TRUE(says_none(html, {"a<b>"}));
  EXPECT_TRUE(says(html, {"It would be "})) << "the cause";
  EXPECT_TRUE(says_none(html, {"src=\"http", "href=\"http", "@import", "url("}));
  succeeds(check + compare::shell_word(solved) + " --tolerance 30%");
  EXPECT_TRUE(says(read(page), {"<p class=\"badge pass\">"}));
  // Over one of its inputs it is not written.
  EXPECT_EQ(run("check " + steel() + " --shape " + compare::shell_word(solved) + " --report " +
                compare::shell_word(solved))
                .status,
            2);
}

TEST_F(CheckCommand, MarkdownIsASummary) {
  const std::string file = path("a|b*.csv");
  const std::string quoted = compare::shell_word(file);
  succeeds("solve " + steel() + " --model chain --format csv -o " + quoted);
  const std::string check = "check " + steel() + " --format markdown --shape " + quoted;
  const std::string summary = run(check + " --tolerance 1%").out;
  EXPECT_TRUE(summary.starts_with("### \u274c fail: ")) << summary;
  EXPECT_TRUE(says(summary, {"RMS 106.2 mm, allowed 5 mm = 1 % of l", "a\\|b\\*.csv |\n"}));
  EXPECT_TRUE(run(check + " --tolerance 30%").out.starts_with("### \u2705 pass: "));
}

TEST_F(CheckCommand, EveryFormatHasTheSameDeviation) {
  const std::string file = solved_file(steel() + " --model chain");
  const std::string check = "check " + steel() + " --shape " + file;
  const Outcome csv = run(check + " --format csv");
  EXPECT_EQ(std::count(csv.out.begin(), csv.out.end(), '\n'), 2);
  EXPECT_TRUE(dlo::test::is_table(csv.out));
  EXPECT_TRUE(says(run(check).out, {"RMS 106.2 mm = 21.23 % of l"}));
}

TEST_F(CheckCommand, AHookPastTheTipFailsAndIsNamed) {
  const std::string data = std::string(DLO_DATA) + "/failures/";
  const Outcome result = run(words(
      {"check", data + "check_hang.toml", "--shape", data + "check_hook.csv", "--tolerance 1%"}));
  EXPECT_EQ(result.status, 1) << result.out;
  EXPECT_TRUE(
      says(result.out,
           {"longer than the rod by 509.9 mm past arc length l: the points there "
            "turn away from it",
            "tip 509.9 mm", "E*/E            not determined: the shape does not change with E"}));
}

TEST_F(CheckCommand, AStretchedOrCutRopeFailsAndIsNamed) {
  const std::string check = "check " + std::string(DLO_DATA) +
                            "/failures/check_hang.toml --no-modulus --tolerance 2% --shape ";
  const auto hanging = [&](double length) {
    std::string text = "x,y\n";
    for (int i = 0; i <= 10; ++i) text += "0," + std::to_string(-length * i / 10) + "\n";
    return shape(text);
  };
  succeeds(check + hanging(1));
  const Outcome stretched = run(check + hanging(1.1));
  EXPECT_EQ(stretched.status, 1);
  EXPECT_TRUE(
      says(stretched.out,
           {"longer than the rod by 100 mm past arc length l: stretched by 10 %", "tip 100 mm"}));
  const Outcome cut = run(check + hanging(0.8));
  EXPECT_EQ(cut.status, 1);
  EXPECT_TRUE(says(cut.out, {"shorter than the rod by 200 mm",
                             ", with s = 0.8 to 1 m, which the file does not have"}));
  EXPECT_TRUE(says(said(check + hanging(0.8) + " --min-seen 70%"), {"not judged: s = 0.8 to 1 m"}));
}

TEST_F(CheckCommand, AShapeAsLongAsTheRodIsNotCalledShorter) {
  // Straight down, half a metre as the rod that is held level.
  const std::string file = shape("x,y\n0,0\n0,-0.125\n0,-0.25\n0,-0.375\n0,-0.5\n");
  const std::string text = run("check " + steel() + " --no-modulus --shape " + file).out;
  EXPECT_TRUE(says_none(text, {"shorter than the rod"}));
  EXPECT_TRUE(says(text, {"seen            s = 0 to 0.5 m, 100 % of l; polyline 0.5 m"}));
}

TEST_F(CheckCommand, WhatIsNotThereIsEmptyOrNull) {
  // The tip is not seen, and the rod does not move.
  const std::string check = "check " + std::string(DLO_DATA) +
                            "/failures/check_hang.toml --shape " +
                            shape("x,y\n0,0\n0,-0.4\n0,-0.8\n") + " --tolerance 1% --format";
  for (const std::string modulus : {"", "--no-modulus"}) {
    const Outcome csv = run(words({check, "csv", modulus}));
    EXPECT_TRUE(says_none(csv.out, {"nan"}));
    EXPECT_TRUE(says(csv.out, {",,"}));
    const json document = json::parse(run(words({check, "json", modulus})).out);
    EXPECT_TRUE(document.at("deviation").at("tip_m").is_null());
    EXPECT_TRUE(document.at("effective_modulus_ratio").is_null());
    EXPECT_TRUE(document.at("effective_modulus_Pa").is_null());
    EXPECT_TRUE(document.at("optimum").is_null());
    EXPECT_EQ(document.at("why_no_effective_modulus"),
              modulus.empty() ? "the shape does not change with E" : "skipped");
  }
  EXPECT_TRUE(says(run(words({check, "text --no-modulus"})).out,
                   {"E*/E            not determined: skipped"}));
  // Both ends held, without gravity
  const std::string held = scene(R"(gravity = [0, 0, 0]
[rod]
length = 1
diameter = 0.006
material = "silicone"
[[gripper]]
at = 0
position = [0, 0, 0]
direction = [1, 0, 0]
[[gripper]]
at = 1
position = [0.9, 0, 0]
direction = [1, 0, 0]
)");
  const std::string compared = said("compare " + held + " --no-modulus --format csv");
  EXPECT_TRUE(says_none(compared, {"nan", "inf"}));
  EXPECT_TRUE(dlo::test::is_table(compared));
}

TEST_F(CheckCommand, AToleranceIsAShareOrALength) {
  const std::string file = solved_file(steel() + " --model chain");
  const std::string check = "check " + steel() + " --no-modulus --shape " + file;
  for (const std::string tolerance : {"22%", "0.22", "\"110 mm\"", "0.11m"}) {
    const json document = json_of(words({check, "--tolerance", tolerance}));
    EXPECT_NEAR(document.at("tolerance").at("allowed_m"), 0.11, 1e-12);
  }
}

TEST_F(CheckCommand, TheStateIsSaidOnceInWords) {
  const std::string file = solved_file(steel() + " --model exact");
  const std::string one = run("check " + steel() + " --no-modulus --shape " + file).out;
  EXPECT_TRUE(
      says(one, {"the only stable one found, -0.00293052 J; no other equilibrium found\n"}));
  EXPECT_TRUE(says_none(one, {"number"}));
}

TEST_F(CheckCommand, ChordLengthsAreOfferedWhereTheyWork) {
  EXPECT_TRUE(says(run("check --help").out, {"chord"}));
  EXPECT_TRUE(says_none(run("calibrate --help").out, {"chord"}));
  expect_error("calibrate " + steel() + " --shape x.csv --arc-lengths chord", 2,
               {"--arc-lengths", "chord", "nearest"});
}

TEST_F(CheckCommand, ShapesComeInAnyUnitAndFrame) {
  // Millimetres, without s, moved by a metre and turned by a quarter about the vertical.
  std::vector<std::vector<double>> moved = solved_points(steel() + " --model exact --samples 9");
  for (std::vector<double>& row : moved) row = {1e3 * row[0] + 1000, 1e3 * row[1], 0};
  const std::string check = "check " + steel() + " --shape " +
                            write_table("moved.csv", "z,y,x", moved) + " --tolerance 0.1%";
  succeeds(check + " --unit mm --register");
  succeeds(check + " --unit mm --register=upright");
  EXPECT_EQ(run(check + " --unit mm --register=translation").status, 1);
  EXPECT_EQ(run(check + " --unit mm").status, 1);
  EXPECT_EQ(run(check + " --unit cm --register").status, 1);
  const Outcome text = run(check + " --unit mm --register");
  EXPECT_TRUE(says(text.out, {"found (rigid): rotated by"}));
}

TEST_F(CheckCommand, AWrongUnitIsNoPass) {
  // The whole rod in metres, declared as millimetres: half a millimetre next to the gripper.
  std::vector<std::vector<double>> points = solved_points(steel() + " --model exact --samples 9");
  const std::string check =
      "check " + steel() + " --shape " + write_table("metres.csv", "x,y,z", points);
  const Outcome wrong = run(check + " --unit mm --tolerance 1%");
  EXPECT_EQ(wrong.status, 1);
  EXPECT_TRUE(says(wrong.out, {"as it was read: only 0.", "of the rod: --unit m?"}));
  EXPECT_TRUE(says_none(wrong.out, {"from arc length 0 to l"}));
  const json document = json_of(check + " --unit mm --tolerance 1%", 1);
  EXPECT_EQ(document.at("verdict"), "fail");
  EXPECT_LT(document.at("seen").at("share").get<double>(), 0.01);
  EXPECT_TRUE(says(document.at("reason").get<std::string>(), {"seen"}));
  EXPECT_TRUE(says(run(check + " --unit mm --tolerance 1% --format csv").out, {",fail,"}));
  succeeds(check + " --unit mm --tolerance 1% --min-seen 0.01%");
  succeeds(check + " --tolerance 1%");
  // Files with arc lengths say that they are too long, others fail and give a hint.
  expect_error("check " + steel() + " --shape " + shape("x,y,s\n0,0,0\n-500,0,500\n"), 2,
               {"s = 500 m", "--unit"});
  for (std::vector<double>& row : points) {
    for (double& number : row) number *= 1e3;
  }
  const std::string large =
      run("check " + steel() + " --shape " + write_table("mm.csv", "x,y,z", points)).out;
  EXPECT_TRUE(says(large, {"times the rod: --unit mm?"}));
}

TEST_F(CheckCommand, SeenRangeAndDirectionAreSaid) {
  const std::string file = shape("x,y,s\n-0.1,0,0.1\n-0.3,0,0.3\n-0.4,-0.01,0.4\n");
  const std::string check = "check " + steel() + " --shape " + file;
  EXPECT_TRUE(says(run(check).out, {"3 points, from s = 0.1 to 0.4 m"}));
  succeeds(check + " --tolerance \"1 m\" --min-seen 59%");
  EXPECT_EQ(run(check + " --tolerance \"1 m\" --min-seen 61%").status, 1);
  for (const std::string share : {"0", "100%", "x"}) {
    expect_error(words({check, "--tolerance 1% --min-seen", share}), 2, {"--min-seen"});
  }
  expect_error(check + " --register upright", 2, {"did you mean --register=upright?"});
  // The option would have no effect.
  expect_error(check + " --law hooke", 2, {"--law"});
}

TEST_F(CheckCommand, BadInputIsOneLineAndStatusTwo) {
  const std::string bad = shape("x,y,z\n0,0,0\n1,oops,0\n");
  expect_error("check " + steel() + " --shape " + bad, 2, {bad + ":3", "oops"});
  expect_error("check " + steel() + " --shape " + path("none.csv"), 2, {"none.csv", "read"});
  expect_error("check " + steel(), 2, {"--shape"});
  const std::string good = shape("0,0\n-0.2,0\n-0.4,-0.1\n");
  for (const std::string tolerance :
       {"1", "0", "0%", "-1%", "100%", "x", "\"1 kg\"", "nan%", "%"}) {
    expect_error(words({"check", steel(), "--shape", good, "--tolerance", tolerance}), 2,
                 {"--tolerance"});
  }
  expect_error("check " + steel() + " --shape " + good + " --unit inch", 2, {"inch"});
  expect_error("check " + steel() + " --shape " + good + " --arc-lengths file", 2, {"column s"});
  expect_error("check " + steel() + " --shape " + shape("0,0\n1,1\n") + " --register", 2,
               {"2 points", "3 or more"});
}

TEST_F(CheckCommand, HelpHasAnExample) {
  EXPECT_TRUE(says(said("check --help"), {"dlo check data/scenes"}));
}

}  // namespace
