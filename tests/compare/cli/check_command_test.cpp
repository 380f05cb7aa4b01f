// Tests of the command `dlo check`.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/quote.hpp"
#include "command_fixture.hpp"
#include "scene_text.hpp"

namespace dlo::compare {
namespace {

class CheckCommand : public Command {
 protected:
  std::string shape(const std::string& text) { return write("shape", text); }
  /// Writes the scene of a rod whose first end is clamped level, and returns its path.
  std::string level_rod(double length, double stiffness, double mass_per_length) {
    return scene(fmt::format("[rod]\nlength = {}\nbending_stiffness = {}\nmass_per_length = {}\n",
                             length, stiffness, mass_per_length) +
                 level_clamp);
  }
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
  // The shape of the paper's law has an RMS deviation of 21 % of the length, and a largest
  // deviation of 226 mm.
  const std::string check = "check " + steel() + " --shape " + file;
  succeeds(check);
  for (const std::string share : {"22%", "0.22"}) succeeds(check + " --tolerance " + share);
  EXPECT_EQ(run(check + " --tolerance 20%").status, 1);
  succeeds(check + " --tolerance \"110 mm\"");
  EXPECT_EQ(run(check + " --tolerance \"110 mm\" --measure max").status, 1);
  EXPECT_EQ(json_of(check + " --tolerance 1%", 1).at("verdict"), "fail");
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
  expect_output(check, 0, {"allowed 5 mm = 1 % of l, the default"});
}

TEST_F(CheckCommand, AToleranceMayBeAShareOfTheDeflection) {
  const std::string stiff = level_rod(4, 4e4, 2);
  const std::string check = "check " + stiff + " --shape " + shape("x,y\n0,0\n2,0\n4,0\n");
  const std::string line = output_of(check + " --tolerance 1%");
  EXPECT_TRUE(has_all(line, {"pass: ", "not significant for stiffness or weight"}));
  const json failed = json_of(check + " --tolerance \"5% of deflection\"", 1);
  EXPECT_EQ(failed.at("verdict"), "fail");
  EXPECT_EQ(failed.at("tolerance").at("of_deflection"), true);
  const double sag = 2 * 9.81 * 256 / (8 * 4e4);  // w l^4 / (8 EI)
  EXPECT_NEAR(failed.at("deflection_m"), sag, 1e-3 * sag);
  EXPECT_DOUBLE_EQ(failed.at("tolerance").at("allowed_m"),
                   0.05 * failed.at("deflection_m").get<double>());
  for (const std::string share : {"0% of deflection", "100% of deflection", "x of deflection"}) {
    expect_output(check + " --tolerance \"" + share + "\"", 2,
                  {"--tolerance = " + share + ": no share of the deflection"});
  }
}

TEST_F(CheckCommand, AFileThatDoesNotDetermineTheRodIsUndetermined) {
  const std::string heavy = level_rod(1, 0.01, 0.1);
  const std::string file = solved_file(heavy + " --samples 4");
  const json document = json_of("check " + heavy + " --tolerance 1% --shape " + file, 1);
  EXPECT_EQ(document.at("verdict"), "undetermined");
  EXPECT_LT(document.at("judged_m"), 1e-6);
  EXPECT_TRUE(document.at("explanations").empty());
  EXPECT_TRUE(has_all(document.at("reason"), {"the points do not determine the rod at s = "}));
}

TEST_F(CheckCommand, APassBesideAnotherStiffnessSaysWhyBothHold) {
  const std::string file = solved_file(level_rod(1, 0.6, 0.1) + " --samples 21");
  const std::string soft = level_rod(1, 0.5, 0.1);
  const std::string words = "E*/E = 1.2 does not contradict the verdict: ";
  expect_output("check " + soft + " --tolerance 10% --shape " + file, 0, {"pass: ", words});
  // If the shape fails, E* is among the explanations, and the hint is not printed.
  const std::string narrow = run("check " + soft + " --tolerance 0.1% --shape " + file).out;
  EXPECT_TRUE(has_none(narrow, {words}));
}

TEST_F(CheckCommand, TheReportIsOnePage) {
  const std::string file = shape("x,y\n0,0\n0.3,<b>\n");
  const std::string page = path("page.html");
  const std::string check = "check " + steel() + " --report " + page + " --shape ";
  EXPECT_EQ(run(check + file).status, 2);
  EXPECT_FALSE(std::filesystem::exists(page)) << "nothing is written of what could not be read";
  const std::string solved = path("a<b>&.csv");
  succeeds("solve " + steel() + " --model chain --format csv -o " + shell_word(solved));
  succeeds(check + shell_word(solved));
  const std::string html = read(page);
  EXPECT_TRUE(has_all(
      html, {"<p class=\"badge fail\">", "a&lt;b&gt;&amp;.csv\n", "explained by", "106.2 mm"}));
  EXPECT_TRUE(has_none(html, {"a<b>", "src=\"http", "href=\"http", "@import", "url("}));
  succeeds(check + shell_word(solved) + " --tolerance 30%");
  EXPECT_TRUE(has_all(read(page), {"<p class=\"badge pass\">"}));
  // The report must not overwrite an input file.
  expect_error(check + page, 2, {"is read too"});
}

TEST_F(CheckCommand, MarkdownIsASummary) {
  const std::string file = path("a|b*.csv");
  const std::string quoted = shell_word(file);
  succeeds("solve " + steel() + " --model chain --format csv -o " + quoted);
  const std::string check = "check " + steel() + " --format markdown --shape " + quoted;
  const std::string summary = run(check + " --tolerance 1%").out;
  EXPECT_TRUE(summary.starts_with("### \u274c fail: ")) << summary;
  EXPECT_TRUE(has_all(summary, {"RMS 106.2 mm, allowed 5 mm = 1 % of l", "a|b*.csv\n"}));
  EXPECT_TRUE(run(check + " --tolerance 30%").out.starts_with("### \u2705 pass: "));
}

TEST_F(CheckCommand, AHookPastTheTipFailsAndIsNamed) {
  const std::string data = std::string(DLO_DATA) + "/failures/";
  expect_output(
      words({"check", data + "check_hang.toml --tolerance 1% --shape", data + "check_hook.csv"}), 1,
      {"longer than the rod by 509.9 mm past arc length l: the points there do not "
       "continue in the rod's direction",
       "E*/E            not determined: the shape does not change with E"});
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
  expect_output(check + hanging(1.1), 1,
                {"longer than the rod by 100 mm past arc length l: stretched by 10 %"});
  expect_output(
      check + hanging(0.8), 1,
      {"shorter than the rod by 200 mm", ", with s = 0.8 to 1 m, which the file does not have"});
  EXPECT_TRUE(
      has_all(output_of(check + hanging(0.8) + " --min-seen 70%"), {"not judged: s = 0.8 to 1 m"}));
}

TEST_F(CheckCommand, WhatIsNotThereIsEmptyOrNull) {
  // The file does not contain the tip, and gravity does not deflect the rod.
  const std::string check = "check " + std::string(DLO_DATA) +
                            "/failures/check_hang.toml --shape " +
                            shape("x,y\n0,0\n0,-0.4\n0,-0.8\n") + " --tolerance 1% --format";
  for (const std::string modulus : {"", "--no-modulus"}) {
    EXPECT_TRUE(has_all(run(words({check, "csv", modulus})).out, {",,"}));
    const json document = json::parse(run(words({check, "json", modulus})).out);
    EXPECT_TRUE(document.at("deviation").at("tip_m").is_null());
    EXPECT_TRUE(document.at("effective_modulus_ratio").is_null());
    EXPECT_TRUE(document.at("effective_modulus_Pa").is_null());
    EXPECT_TRUE(document.at("optimum").is_null());
    EXPECT_EQ(document.at("why_no_effective_modulus"),
              modulus.empty() ? "the shape does not change with E" : "skipped");
  }
}

TEST_F(CheckCommand, TextBeginsWithTheVerdictAndThreeNumbers) {
  const std::string text =
      output_of("check " + steel() + " --shape " + solved_file(steel() + " --model exact"));
  EXPECT_EQ(text.substr(0, 10), "pass: RMS ");
  const std::size_t rms = text.find("\n  deviation       RMS ");
  const std::size_t largest = text.find("\n                  largest ");
  const std::size_t modulus = text.find("\n  E*/E            1.0000");
  EXPECT_LT(rms, largest);
  EXPECT_LT(largest, modulus);
  EXPECT_LT(modulus, text.find("\n\nscene "));
}

TEST_F(CheckCommand, CalibrateTakesNoChordLengths) {
  expect_error("calibrate " + steel() + " --shape x.csv --arc-lengths chord", 2,
               {"--arc-lengths", "chord", "nearest"});
}

TEST_F(CheckCommand, ShapesComeInAnyUnitAndFrame) {
  // The points are in millimetres, have no s, and are translated by a metre and rotated by 90
  // degrees about the vertical.
  std::vector<std::vector<double>> moved = solved_points(steel() + " --model exact --samples 9");
  for (std::vector<double>& row : moved) row = {1e3 * row[0] + 1000, 1e3 * row[1], 0};
  const std::string check = "check " + steel() + " --shape " +
                            write_table("moved.csv", "z,y,x", moved) + " --tolerance 0.1%";
  expect_output(check + " --unit mm --register", 0, {"found (rigid): rotated by"});
  succeeds(check + " --unit mm --register=upright");
  EXPECT_EQ(run(check + " --unit mm --register=translation").status, 1);
  EXPECT_EQ(run(check + " --unit mm").status, 1);
  EXPECT_EQ(run(check + " --unit cm --register").status, 1);
}

TEST_F(CheckCommand, AWrongUnitIsNoPass) {
  // The file contains the whole rod in metres. Read as millimetres it is half a millimetre of
  // polyline at the gripper.
  std::vector<std::vector<double>> points = solved_points(steel() + " --model exact --samples 9");
  const std::string check =
      "check " + steel() + " --shape " + write_table("metres.csv", "x,y,z", points);
  expect_output(check + " --unit mm --tolerance 1%", 1,
                {"as it was read: only 0.", "of the rod: --unit m?"});
  const json document = json_of(check + " --unit mm --tolerance 1%", 1);
  EXPECT_EQ(document.at("verdict"), "fail");
  EXPECT_LT(document.at("seen").at("share").get<double>(), 0.01);
  succeeds(check + " --unit mm --tolerance 1% --min-seen 0.01%");
  succeeds(check + " --tolerance 1%");
  // A file with arc lengths beyond the rod is refused. A file without arc lengths gets a hint; the
  // exit status is 0 because no tolerance is given.
  expect_error("check " + steel() + " --shape " + shape("x,y,s\n0,0,0\n-500,0,500\n"), 2,
               {"s = 500 m", "--unit"});
  for (std::vector<double>& row : points) {
    for (double& number : row) number *= 1e3;
  }
  expect_output("check " + steel() + " --shape " + write_table("mm.csv", "x,y,z", points), 0,
                {"times the rod: --unit mm?"});
}

TEST_F(CheckCommand, SeenRangeAndDirectionAreSaid) {
  const std::string file = shape("x,y,s\n-0.1,0,0.1\n-0.3,0,0.3\n-0.4,-0.01,0.4\n");
  const std::string check = "check " + steel() + " --shape " + file;
  EXPECT_NEAR(json_of(check).at("seen").at("from_m"), 0.1, 1e-12);
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

}  // namespace
}  // namespace dlo::compare
