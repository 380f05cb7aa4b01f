// The command check as a user runs it.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "base/quote.hpp"
#include "batch/read_sweep.hpp"
#include "command_fixture.hpp"

namespace {

namespace compare = dlo::compare;
using dlo::test::Command;
using dlo::test::Outcome;
using nlohmann::json;

class CheckCommand : public Command {
 protected:
  std::string shape(const std::string& text) {
    std::ofstream(path("shape")) << text;
    return path("shape");
  }
};

TEST_F(CheckCommand, ReadsWhatSolveWrites) {
  for (const std::string format : {"csv", "json"}) {
    const std::string file = path("solved." + format);
    ASSERT_EQ(
        run(words({"solve", steel(), "--model exact --samples 9 --format", format, "-o", file}))
            .status,
        0);
    const Outcome result =
        run(words({"check", steel(), "--shape", file, "--tolerance 0.01% --format json"}));
    ASSERT_EQ(result.status, 0) << result.err;
    const json document = json::parse(result.out);
    EXPECT_EQ(document.at("schema"), "dlo/check/1");
    EXPECT_EQ(document.at("verdict"), "pass");
    EXPECT_EQ(document.at("tolerance").at("allowed_m"), 0.5 * 0.0001);
    EXPECT_EQ(document.at("arc_lengths"), "file");
    EXPECT_LT(document.at("deviation").at("rms_m").get<double>(), 1e-9);
    EXPECT_NEAR(document.at("effective_modulus_ratio").get<double>(), 1, 1e-5);
    EXPECT_EQ(document.at("points_m").size(), 9U);
  }
}

TEST_F(CheckCommand, ExitStatusIsTheVerdict) {
  const std::string file = path("chain.csv");
  ASSERT_EQ(run("solve " + steel() + " --model chain --format csv -o " + file).status, 0);
  // The paper's law is 21 % of the length off, at most 226 mm.
  const std::string check = "check " + steel() + " --shape " + file;
  EXPECT_EQ(run(check).status, 0);
  EXPECT_EQ(run(check + " --tolerance 22%").status, 0);
  EXPECT_EQ(run(check + " --tolerance 20%").status, 1);
  EXPECT_EQ(run(check + " --tolerance \"110 mm\"").status, 0);
  EXPECT_EQ(run(check + " --tolerance \"110 mm\" --measure max").status, 1);
  const Outcome failed = run(check + " --tolerance 1% --format json");
  EXPECT_EQ(failed.status, 1);
  EXPECT_EQ(failed.err, "");
  EXPECT_EQ(json::parse(failed.out).at("verdict"), "fail");
  EXPECT_NE(run(check + " --tolerance 1%").out.find("fail: RMS 106.2 mm, allowed 5 mm"),
            std::string::npos);
}

TEST_F(CheckCommand, WithoutAToleranceTheVerdictIsOfOnePercent) {
  const std::string file = path("chain.csv");
  ASSERT_EQ(run("solve " + steel() + " --model chain --format csv -o " + file).status, 0);
  const std::string check = "check " + steel() + " --shape " + file;
  const json by_default = json::parse(run(check + " --format json").out);
  const json asked = json::parse(run(check + " --tolerance 1% --format json").out);
  EXPECT_EQ(by_default.at("verdict"), "fail");
  EXPECT_EQ(by_default.at("tolerance").at("default"), true);
  EXPECT_EQ(asked.at("tolerance").at("default"), false);
  EXPECT_EQ(by_default.at("tolerance").at("allowed_m"), asked.at("tolerance").at("allowed_m"));
  EXPECT_EQ(by_default.at("explanations"), asked.at("explanations"));
  EXPECT_NE(run(check).out.find("allowed 5 mm = 1 % of l, the default"), std::string::npos);
}

// A chain's points are explained by its springs, not by another material: one line says so.
TEST_F(CheckCommand, AModulusThatIsSupersededIsNoOptimum) {
  const std::string file = path("chain.csv");
  ASSERT_EQ(run("solve " + steel() + " --model chain --format csv -o " + file).status, 0);
  const std::string check = "check " + steel() + " --tolerance 1% --shape " + file;
  const json document = json::parse(run(check + " --format json").out);
  ASSERT_FALSE(document.at("superseded_by").is_null()) << document.dump();
  const std::string text = run(check).out;
  EXPECT_NE(text.find("  E*/E            no measure of the material: "), std::string::npos) << text;
  EXPECT_EQ(text.find("optimum"), std::string::npos) << text;
}

TEST_F(CheckCommand, APassBesideAnotherStiffnessSaysWhyBothHold) {
  const std::string file = path("stiffer.csv");
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
  ASSERT_EQ(run("solve " + stiff + " --samples 21 --format csv -o " + file).status, 0);
  const std::string soft = scene(rod + "0.5\n");
  const std::string words = "E*/E = 1.2 is no contradiction: ";
  const std::string wide = run("check " + soft + " --tolerance 10% --shape " + file).out;
  EXPECT_NE(wide.find(words), std::string::npos) << wide;
  EXPECT_NE(wide.find("verdict         pass"), std::string::npos) << wide;
  // Where it fails, E* is the explanation.
  const std::string narrow = run("check " + soft + " --tolerance 0.1% --shape " + file).out;
  EXPECT_EQ(narrow.find(words), std::string::npos) << narrow;
}

TEST_F(CheckCommand, TheReportIsOnePage) {
  const std::string file = shape("x,y\n0,0\n0.3,<b>\n");
  const std::string page = path("page.html");
  const std::string check = "check " + steel() + " --report " + page + " --shape ";
  EXPECT_EQ(run(check + file).status, 2);
  EXPECT_FALSE(std::filesystem::exists(page)) << "nothing is written of what could not be read";
  const std::string solved = path("a<b>&.csv");
  ASSERT_EQ(
      run("solve " + steel() + " --model chain --format csv -o " + compare::shell_word(solved))
          .status,
      0);
  ASSERT_EQ(run(check + compare::shell_word(solved)).status, 0);
  const std::string html = read(page);
  EXPECT_NE(html.find("<p class=\"badge fail\">"), std::string::npos);
  EXPECT_NE(html.find("a&lt;b&gt;&amp;.csv is 106.2"), std::string::npos);
  EXPECT_EQ(html.find("a<b>"), std::string::npos);
  EXPECT_NE(html.find("It would be "), std::string::npos) << "the cause";
  for (const char* network : {"src=\"http", "href=\"http", "@import", "url("}) {
    EXPECT_EQ(html.find(network), std::string::npos) << network;
  }
  ASSERT_EQ(run(check + compare::shell_word(solved) + " --tolerance 30%").status, 0);
  EXPECT_NE(read(page).find("<p class=\"badge pass\">"), std::string::npos);
  // Over one of its inputs it is not written.
  EXPECT_EQ(run("check " + steel() + " --shape " + compare::shell_word(solved) + " --report " +
                compare::shell_word(solved))
                .status,
            2);
}

TEST_F(CheckCommand, MarkdownIsASummary) {
  const std::string file = path("a|b*.csv");
  const std::string quoted = compare::shell_word(file);
  ASSERT_EQ(run("solve " + steel() + " --model chain --format csv -o " + quoted).status, 0);
  const std::string check = "check " + steel() + " --format markdown --shape " + quoted;
  const std::string summary = run(check + " --tolerance 1%").out;
  EXPECT_TRUE(summary.starts_with("### \u274c fail: ")) << summary;
  EXPECT_NE(summary.find("RMS 106.2 mm, allowed 5 mm = 1 % of l"), std::string::npos) << summary;
  EXPECT_NE(summary.find("a\\|b\\*.csv |\n"), std::string::npos) << summary;
  EXPECT_TRUE(run(check + " --tolerance 30%").out.starts_with("### \u2705 pass: "));
}

TEST_F(CheckCommand, EveryFormatHasTheSameDeviation) {
  const std::string file = path("chain.csv");
  ASSERT_EQ(run("solve " + steel() + " --model chain --format csv -o " + file).status, 0);
  const std::string check = "check " + steel() + " --shape " + file;
  const Outcome csv = run(check + " --format csv");
  EXPECT_EQ(std::count(csv.out.begin(), csv.out.end(), '\n'), 2);
  const std::string header = csv.out.substr(0, csv.out.find('\n'));
  const std::string row = csv.out.substr(csv.out.find('\n') + 1);
  EXPECT_EQ(compare::fields_of(header), compare::fields_of(row));
  EXPECT_NE(run(check).out.find("RMS 106.2 mm = 21.23 % of l"), std::string::npos);
}

TEST_F(CheckCommand, AHookPastTheTipFailsAndIsNamed) {
  const std::string data = std::string(DLO_DATA) + "/failures/";
  const Outcome result = run(words(
      {"check", data + "check_hang.toml", "--shape", data + "check_hook.csv", "--tolerance 1%"}));
  EXPECT_EQ(result.status, 1) << result.out;
  EXPECT_NE(result.out.find("longer than the rod by 509.9 mm past arc length l: the points there "
                            "turn away from it"),
            std::string::npos)
      << result.out;
  EXPECT_NE(result.out.find("tip 509.9 mm"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("E*/E            not determined: the shape does not change with E"),
            std::string::npos)
      << result.out;
}

TEST_F(CheckCommand, AStretchedOrCutRopeFailsAndIsNamed) {
  const std::string check = "check " + std::string(DLO_DATA) +
                            "/failures/check_hang.toml --no-modulus --tolerance 2% --shape ";
  const auto hanging = [&](double length) {
    std::string text = "x,y\n";
    for (int i = 0; i <= 10; ++i) text += "0," + std::to_string(-length * i / 10) + "\n";
    return shape(text);
  };
  EXPECT_EQ(run(check + hanging(1)).status, 0);
  const Outcome stretched = run(check + hanging(1.1));
  EXPECT_EQ(stretched.status, 1);
  EXPECT_NE(
      stretched.out.find("longer than the rod by 100 mm past arc length l: stretched by 10 %"),
      std::string::npos)
      << stretched.out;
  EXPECT_NE(stretched.out.find("tip 100 mm"), std::string::npos) << stretched.out;
  const Outcome cut = run(check + hanging(0.8));
  EXPECT_EQ(cut.status, 1);
  EXPECT_NE(cut.out.find("shorter than the rod by 200 mm"), std::string::npos) << cut.out;
  EXPECT_NE(cut.out.find(", with s = 0.8 to 1 m, which the file does not have"), std::string::npos)
      << cut.out;
  const Outcome part = run(check + hanging(0.8) + " --min-seen 70%");
  EXPECT_EQ(part.status, 0) << part.out;
  EXPECT_NE(part.out.find("not judged: s = 0.8 to 1 m"), std::string::npos) << part.out;
}

TEST_F(CheckCommand, AShapeAsLongAsTheRodIsNotCalledShorter) {
  // Straight down, half a metre as the rod that is held level.
  const std::string file = shape("x,y\n0,0\n0,-0.125\n0,-0.25\n0,-0.375\n0,-0.5\n");
  const std::string text = run("check " + steel() + " --no-modulus --shape " + file).out;
  EXPECT_EQ(text.find("shorter than the rod"), std::string::npos) << text;
  EXPECT_NE(text.find("(as long as the rod, but "), std::string::npos) << text;
}

TEST_F(CheckCommand, WhatIsNotThereIsEmptyOrNull) {
  // The tip is not seen, and the rod does not move.
  const std::string check = "check " + std::string(DLO_DATA) +
                            "/failures/check_hang.toml --shape " +
                            shape("x,y\n0,0\n0,-0.4\n0,-0.8\n") + " --tolerance 1% --format";
  for (const std::string modulus : {"", "--no-modulus"}) {
    const Outcome csv = run(words({check, "csv", modulus}));
    EXPECT_EQ(csv.out.find("nan"), std::string::npos) << csv.out;
    EXPECT_NE(csv.out.find(",,"), std::string::npos);
    const json document = json::parse(run(words({check, "json", modulus})).out);
    EXPECT_TRUE(document.at("deviation").at("tip_m").is_null());
    EXPECT_TRUE(document.at("effective_modulus_ratio").is_null());
    EXPECT_TRUE(document.at("effective_modulus_Pa").is_null());
    EXPECT_TRUE(document.at("optimum").is_null());
    EXPECT_EQ(document.at("why_no_effective_modulus"),
              modulus.empty() ? "the shape does not change with E" : "skipped");
  }
  EXPECT_NE(
      run(words({check, "text --no-modulus"})).out.find("E*/E            not determined: skipped"),
      std::string::npos);
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
  const Outcome compared = run("compare " + held + " --no-modulus --format csv");
  EXPECT_EQ(compared.status, 0) << compared.err;
  EXPECT_EQ(compared.out.find("nan"), std::string::npos) << compared.out;
  EXPECT_EQ(compared.out.find("inf"), std::string::npos) << compared.out;
  const std::string row = compared.out.substr(compared.out.find('\n') + 1);
  EXPECT_EQ(std::count(row.begin(), row.end(), ','),
            std::count(compared.out.begin(),
                       compared.out.begin() + static_cast<long>(compared.out.find('\n')), ','));
}

TEST_F(CheckCommand, AToleranceIsAShareOrALength) {
  const std::string file = path("chain.csv");
  ASSERT_EQ(run("solve " + steel() + " --model chain --format csv -o " + file).status, 0);
  const std::string check = "check " + steel() + " --no-modulus --format json --shape " + file;
  for (const std::string tolerance : {"22%", "0.22", "\"110 mm\"", "0.11m"}) {
    const Outcome result = run(words({check, "--tolerance", tolerance}));
    EXPECT_EQ(result.status, 0) << tolerance << result.err;
    EXPECT_NEAR(json::parse(result.out).at("tolerance").at("allowed_m").get<double>(), 0.11, 1e-12);
  }
}

TEST_F(CheckCommand, TheStateIsSaidOnceInWords) {
  const std::string file = path("solved.csv");
  ASSERT_EQ(run("solve " + steel() + " --model exact --format csv -o " + file).status, 0);
  const std::string one = run("check " + steel() + " --no-modulus --shape " + file).out;
  EXPECT_NE(one.find("the only stable one found, -0.00293052 J; no other equilibrium found\n"),
            std::string::npos)
      << one;
  EXPECT_EQ(one.find("number"), std::string::npos) << one;
}

TEST_F(CheckCommand, ChordLengthsAreOfferedWhereTheyWork) {
  EXPECT_NE(run("check --help").out.find("chord"), std::string::npos);
  EXPECT_EQ(run("calibrate --help").out.find("chord"), std::string::npos);
  expect_error("calibrate " + steel() + " --shape x.csv --arc-lengths chord", 2,
               {"--arc-lengths", "chord", "nearest"});
}

TEST_F(CheckCommand, ShapesComeInAnyUnitAndFrame) {
  const std::string file = path("solved.csv");
  ASSERT_EQ(run("solve " + steel() + " --model exact --samples 9 --format csv -o " + file).status,
            0);
  // Millimetres, without s, moved by a metre and turned by a quarter about the vertical.
  std::ifstream stream(file);
  std::string line;
  std::getline(stream, line);
  std::string moved = "z,y,x\n";
  while (std::getline(stream, line)) {
    double x = 0;
    double y = 0;
    ASSERT_EQ(std::sscanf(line.c_str(), "%lf,%lf", &x, &y), 2);
    moved += std::to_string(1e3 * x + 1000) + "," + std::to_string(1e3 * y) + ",0\n";
  }
  const std::string check = "check " + steel() + " --shape " + shape(moved) + " --tolerance 0.1%";
  EXPECT_EQ(run(check + " --unit mm --register").status, 0);
  EXPECT_EQ(run(check + " --unit mm --register=upright").status, 0);
  EXPECT_EQ(run(check + " --unit mm --register=translation").status, 1);
  EXPECT_EQ(run(check + " --unit mm").status, 1);
  EXPECT_EQ(run(check + " --unit cm --register").status, 1);
  const Outcome text = run(check + " --unit mm --register");
  EXPECT_NE(text.out.find("found (rigid): rotated by"), std::string::npos) << text.out;
}

TEST_F(CheckCommand, AWrongUnitIsNoPass) {
  // The whole rod in metres, said to be in millimetres: half a millimetre beside the gripper.
  const std::string file = path("solved.csv");
  ASSERT_EQ(run("solve " + steel() + " --model exact --samples 9 --format csv -o " + file).status,
            0);
  std::string points;
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) {
    points += line.substr(0, line.rfind(',')) + "\n";
  }
  const std::string check = "check " + steel() + " --shape " + shape(points);
  const Outcome wrong = run(check + " --unit mm --tolerance 1%");
  EXPECT_EQ(wrong.status, 1);
  EXPECT_NE(wrong.out.find("as it was read: only 0."), std::string::npos) << wrong.out;
  EXPECT_NE(wrong.out.find("of the rod: --unit m?"), std::string::npos) << wrong.out;
  EXPECT_EQ(wrong.out.find("from arc length 0 to l"), std::string::npos) << wrong.out;
  const json document = json::parse(run(check + " --unit mm --tolerance 1% --format json").out);
  EXPECT_EQ(document.at("verdict"), "fail");
  EXPECT_LT(document.at("seen").at("share").get<double>(), 0.01);
  EXPECT_NE(document.at("reason").get<std::string>().find("seen"), std::string::npos);
  EXPECT_NE(run(check + " --unit mm --tolerance 1% --format csv").out.find(",fail,"),
            std::string::npos);
  EXPECT_EQ(run(check + " --unit mm --tolerance 1% --min-seen 0.01%").status, 0);
  EXPECT_EQ(run(check + " --tolerance 1%").status, 0);
  // Files with arc lengths say that they are too long, others fail and give a hint.
  expect_error("check " + steel() + " --shape " + shape("x,y,s\n0,0,0\n-500,0,500\n"), 2,
               {"s = 500 m", "--unit"});
  std::string millimetres;
  std::istringstream lines(points);
  std::getline(lines, millimetres);
  millimetres += "\n";
  for (double x = 0, y = 0, z = 0; std::getline(lines, points);) {
    ASSERT_EQ(std::sscanf(points.c_str(), "%lf,%lf,%lf", &x, &y, &z), 3);
    millimetres += std::to_string(1e3 * x) + "," + std::to_string(1e3 * y) + ",0\n";
  }
  const Outcome large = run("check " + steel() + " --shape " + shape(millimetres));
  EXPECT_NE(large.out.find("times the rod: --unit mm?"), std::string::npos) << large.out;
}

TEST_F(CheckCommand, SeenRangeAndDirectionAreSaid) {
  const std::string file = shape("x,y,s\n-0.1,0,0.1\n-0.3,0,0.3\n-0.4,-0.01,0.4\n");
  const std::string check = "check " + steel() + " --shape " + file;
  EXPECT_NE(run(check).out.find("3 points, from s = 0.1 to 0.4 m"), std::string::npos);
  EXPECT_EQ(run(check + " --tolerance \"1 m\" --min-seen 59%").status, 0);
  EXPECT_EQ(run(check + " --tolerance \"1 m\" --min-seen 61%").status, 1);
  for (const std::string share : {"0", "100%", "x"}) {
    expect_error(words({check, "--tolerance 1% --min-seen", share}), 2, {"--min-seen"});
  }
  expect_error(check + " --register upright", 2, {"did you mean --register=upright?"});
  // It would change nothing.
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
  const Outcome help = run("check --help");
  EXPECT_EQ(help.status, 0);
  EXPECT_NE(help.out.find("dlo check data/scenes"), std::string::npos);
}

}  // namespace
