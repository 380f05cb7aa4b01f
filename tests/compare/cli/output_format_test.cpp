// Tests of the output formats: no name or number breaks one.

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <regex>
#include <string>
#include <vector>

#include "base/number.hpp"
#include "base/quote.hpp"
#include "base/text.hpp"
#include "dlo/compare/material.hpp"
#include "dlo/compare/plan.hpp"
#include "dlo/compare/scene_file.hpp"
#include "dlo/compare/solve.hpp"
#include "format/json.hpp"
#include "format/result_output.hpp"
#include "output_fixture.hpp"
#include "scene_text.hpp"

namespace dlo::compare {
namespace {

const std::string held_at_both_ends =
    "name = \"both ends\"\n" + steel_rod + level_clamp +
    "[[gripper]]\nat = \"50 cm\"\nposition = [0.45, 0, 0]\ndirection = \"0 deg\"\n";

/// Returns the first word of an output that is NaN, infinite or -0, or that only a programmer of
/// dlo understands; empty if there is none.
std::string first_invalid_word(const std::string& text) {
  static const std::regex wrong(
      "Problem:|solve_(?:energy|exact|polygon)|"
      "(?:^|[^\\w.])(?:[Nn][Aa][Nn]|[Ii][Nn][Ff](?:[Ii][Nn][Ii][Tt][Yy])?|-[0.]*0[0.]*)(?![\\w.])");
  std::smatch found;
  return std::regex_search(text, found, wrong) ? found.str() : "";
}

/// Returns commands that a user may run on the scene that `dlo init` has written; some in one
/// format, which changes with the index.
std::vector<std::string> commands_for_new_scene(const std::string& folder, std::size_t index) {
  const std::string s = folder + "s.toml";
  const std::string shape = " --shape " + folder + "f.csv";
  std::vector<std::string> all;
  constexpr const char* formats[] = {"text", "json", "csv"};
  for (const std::string format : formats) all.push_back("solve " + s + " --format " + format);
  const std::string format = std::string(" --format ") + formats[(index + index / 3) % 3];
  for (const std::string& command :
       {"solve " + s + " --model chain --points 8", "compare " + s + " --points 8 --law hooke",
        "check " + s + shape + " --tolerance 1%", "modes " + s + " --points 8",
        "solve " + s + " --model force --points 8 --law hooke --max-steps 2000", "scene " + s,
        "regress " + s + " --points 8 --baseline " + folder + "b.toml"}) {
    all.push_back(command + format);
  }
  all.push_back("solve " + s + " --explain");
  all.push_back("sweep " + s + " --vary gamma=0,1");
  return all;
}

TEST_F(Output, NoNumberIsNanOrInfinity) {
  write("both.toml", held_at_both_ends);
  write("weightless.toml", "gravity = [0, 0, 0]\n" + read(steel()));
  write_scene("cable.toml");
  const std::string own = read(path("weightless.toml"));
  // A key may be given only once, so the original gravity becomes a comment.
  write("weightless.toml",
        std::regex_replace(own, std::regex("\ngravity = [^\n]*"), "\n# gravity: none"));
  ASSERT_EQ(bash("$dlo solve cable.toml --samples 21 --format csv | head -n 16 >seen.csv").status,
            0);
  ASSERT_EQ(bash("$dlo regress both.toml cable.toml --update --baseline base.toml").status, 0);
  const std::regex not_a_number("[+-]?(nan|inf|infinity)(\\([^)]*\\))?", std::regex::icase);
  int empty = 0;
  for (const std::string command :
       {"solve both.toml", "compare both.toml", "compare weightless.toml",
        "check cable.toml --shape seen.csv",
        "check weightless.toml --shape seen.csv --tolerance 99%",
        "calibrate cable.toml --shape seen.csv", "calibrate cable.toml --law hooke --target 5%",
        "stability --case unequal --stepper basic --max-steps 2000", "stability --case pulled",
        "stability --map cF-cc --columns 2 --rows 4 --map-steps 50",
        "sweep both.toml --model compare-chain --vary gamma=0,1",
        "regress both.toml cable.toml --baseline base.toml", "materials"}) {
    const RunResult csv = bash("$dlo " + command + " --format csv");
    const std::vector<test::CsvRow> rows = csv_rows(csv.out);
    ASSERT_GT(rows.size(), 1U) << command << csv.err;
    EXPECT_GT(rows.front().size(), 3U) << command << csv.err;
    for (const test::CsvRow& row : rows) {
      EXPECT_EQ(row.size(), rows.front().size()) << command << "\n" << csv.out;
      for (const std::string& field : row) {
        EXPECT_FALSE(std::regex_match(field, not_a_number)) << command << "\n" << csv.out;
        if (field.empty()) ++empty;
      }
    }
    // All commands share one writer of JSON and one of text, so the two commands with the most
    // undefined values suffice.
    if (command != "compare both.toml" && command != "stability --case pulled") continue;
    const RunResult json = bash("$dlo " + command + " --format json");
    EXPECT_FALSE(json::parse(json.out, nullptr, false).is_discarded()) << command;
    EXPECT_EQ(first_invalid_word(json.out), "") << command << "\n" << json.out;
    const RunResult text = bash("$dlo " + command);
    EXPECT_EQ(first_invalid_word(text.out + text.err), "") << command << "\n" << text.out;
  }
  EXPECT_GT(empty, 10);  // otherwise the loop has tested nothing
  // The first commands of a new user, with any material: thin rods are soft, thick ones stiff.
  std::size_t index = 0;
  for (const Material& material : materials()) {
    for (const std::string diameter : {"25mm", "6mm", "3mm"}) {
      const std::string made = " --force --material " + material.name + " --diameter " + diameter;
      succeeds("init " + path("s.toml") + made);
      succeeds("solve " + path("s.toml") + " --samples 9 -o " + path("f.csv"));
      for (const std::string& command : commands_for_new_scene(path(""), index++)) {
        const RunResult result = run(command);
        EXPECT_EQ(first_invalid_word(result.out + result.err), "") << command << made << "\n"
                                                                   << result.out << result.err;
      }
    }
  }
}

TEST(WrongWord, IsAnUndefinedNumberOrASignedZero) {
  for (const char* wrong : {"+nan %", "1/inf", "x, -nan", "[-0, 1]", "-0.000 m", "-0.00%", "INF",
                            "PolygonProblem: smallest rest length = 1"}) {
    EXPECT_NE(first_invalid_word(wrong), "") << wrong;
  }
  for (const char* right : {"information", "1e-00", "-0.01", "0", "+0", "--no-force", "nano-0.5",
                            "1e-05", "-", "a-b", "-1", "1-0"}) {
    EXPECT_EQ(first_invalid_word(right), "") << right;
  }
}

// Numbers of texts and tables go through formatted() and append().
TEST(Formatted, PrintsNoMinusZero) {
  EXPECT_EQ(formatted("{:.3f}|{:8.2f}|{:+.2g}|{}|{:.1e}", -4e-4, -1e-9, -0.0, -0.0, -0.0),
            "0.000|    0.00|+0|0|0.0e+00");
  EXPECT_EQ(formatted("{:.3f} {:g} {:{}.{}f} {}", -6e-4, -1e-30, -0.04, 5, 1, "-0"),
            "-0.001 -1e-30   0.0 -0");
  EXPECT_EQ(csv_number(-0.0), "0");
  EXPECT_EQ(cli::json_text({{"x", -0.0}}), "{\n  \"x\": 0.0\n}\n");
}

TEST(Shown, IsZeroBelowTheErrorOfTheData) {
  for (const double rounding : {-7.965e-33, 4.8e-18, -0.0, 1e-9}) {
    EXPECT_EQ(shown(rounding, 1), 0);
    EXPECT_FALSE(std::signbit(shown(rounding, 1)));
  }
  for (const double number : {1.1e-9, -2e-9, 3.0}) EXPECT_EQ(shown(number, 1), number);
  EXPECT_EQ(shown(1e-12, 1e-6), 1e-12);  // the scale of the scene is small
  EXPECT_EQ(shown(1e-12, 0), 1e-12);     // the scene has no scale
  EXPECT_TRUE(std::isnan(shown(NAN, 1)));
  EXPECT_EQ(shown(INFINITY, 1), INFINITY);
  // A taut rod's forces are large compared with its weight.
  EXPECT_EQ(cli::shown(Eigen::Vector3d(1e4, -1e-6, 1), 1), Eigen::Vector3d(1e4, 0, 1));
}

// A search without remaining time lists the shapes whose stability is not known.
TEST(EquilibriaText, OfAShapeThatIsNotJudgedHasNoEigenvalue) {
  AllSolutions all;
  all.solutions.resize(2);
  const double nan = std::nan("");
  for (Solution& solution : all.solutions) {
    solution.status = energy_model::SolveStatus::not_verified;
    solution.shape = {{0, 1}, Eigen::Matrix3Xd::Zero(3, 2)};
  }
  all.solutions[0].smallest_eigenvalue = nan;
  all.solutions[1].smallest_eigenvalue = -2.5;
  const Scene scene = load_scene(std::string(DLO_DATA) + "/scenes/spring_steel_175.toml");
  const std::string text = cli::equilibria_text(all, scene);
  EXPECT_TRUE(has_all(text, {"1           0  -       not_verified                    -  [",
                             "2           0  no      not_verified                 -2.5  ["}));
  EXPECT_EQ(first_invalid_word(text), "");
  const cli::Json document = cli::equilibria_json(all, scene, {});
  EXPECT_TRUE(document.at("equilibria")[0].at("stable").is_null());
  EXPECT_EQ(document.at("equilibria")[1].at("stable"), false);
}

// Forces, torques and energies of these scenes have parts that symmetry or balance makes zero.
TEST_F(Output, TextHasNoNumberThatIsRounding) {
  const std::regex rounding("[0-9]e-(?:1[3-9]|[2-9][0-9])");
  const std::string scenes = std::string(DLO_DATA) + "/scenes/";
  const std::string commands[] = {"solve " + scenes + "spring_steel_175.toml",
                                  "solve " + scenes + "spring_steel_175.toml --model exact",
                                  "solve " + scenes + "side_load.toml",
                                  "solve " + scenes + "twisted_wire.toml",
                                  "solve " + scenes + "spliced_cable.toml --model chain",
                                  "compare " + steel() + " --law hooke --bookkeeping consistent",
                                  "track " + scenes + "buckling_wire.toml --no-force",
                                  "track " + scenes + "corner_routing.toml --no-force"};
  for (const std::string& command : commands) {
    const std::string text = output_of(command);
    std::smatch found;
    EXPECT_FALSE(std::regex_search(text, found, rounding)) << command << "\n" << text;
  }
  // JSON documents keep the full precision.
  const std::string json = run(commands[6] + " --format json").out;
  EXPECT_TRUE(std::regex_search(json, rounding));
}

TEST(Csv, UndefinedNumbersAreEmpty) {
  EXPECT_EQ(csv_number(NAN) + csv_number(INFINITY) + csv_number(-INFINITY), "");
  EXPECT_EQ(csv_number(-0.0), "0");
  EXPECT_EQ(csv_number(1. / 3), "0.3333333333");
  EXPECT_EQ(csv_number(1. / 3, 3), "0.333");
}

TEST(Display, RepairsUtf8AndShowsNoControls) {
  const std::string good = "\xc3\xa9 \xe2\x82\xac \xf0\x9f\x98\x80 ~";
  EXPECT_EQ(valid_utf8(good), good);
  EXPECT_EQ(display(good), good);
  const std::string bad = "\xef\xbf\xbd";
  EXPECT_EQ(valid_utf8("a\xffz"), "a" + bad + "z");
  EXPECT_EQ(valid_utf8("\xc3"), bad);                                // cut off
  EXPECT_EQ(valid_utf8("\xc0\x80"), bad + bad);                      // longer than needed
  EXPECT_EQ(valid_utf8("\xed\xa0\x80"), bad + bad + bad);            // a surrogate
  EXPECT_EQ(valid_utf8("\xf4\x90\x80\x80"), bad + bad + bad + bad);  // above U+10FFFF
  EXPECT_EQ(valid_utf8("\n\x1b"), "\n\x1b");
  EXPECT_EQ(display(std::string("a\n\x1b[31m\x7f\0z", 10)), "a??[31m??z");
  EXPECT_EQ(display("\xc2\x9b"
                    "31m"),
            "?31m");  // the one-character escape of terminals
}

TEST_F(Output, NamesThatAreNoTextBreakNoFormat) {
  const std::string name = "w\xff\x1b[31mire";
  write(name + ".toml", std::regex_replace(read(steel()), std::regex("name = [^\n]*\n"), ""));
  const auto quoted = [](const std::string& file) { return "'" + file + "'"; };
  const std::string scene = quoted(name + ".toml");
  ASSERT_EQ(bash("$dlo solve " + scene + " --format csv -o " + quoted(name)).status, 0);
  for (const std::string& command :
       {"solve " + scene, "check " + scene + " --shape " + quoted(name),
        "calibrate " + scene + " --shape " + quoted(name), "compare " + scene}) {
    const RunResult json = bash("$dlo " + command + " --format json");
    EXPECT_EQ(json.status, 0) << json.err;
    EXPECT_FALSE(json::parse(json.out, nullptr, false).is_discarded()) << command;
    const std::string text = bash("$dlo " + command).out;
    EXPECT_EQ(text.find_first_of("\x1b\xff"), std::string::npos) << text;
    EXPECT_TRUE(has_all(text, {"w\xef\xbf\xbd?[31mire"}));
  }
}

TEST_F(Output, TextHoldsNoControlCharactersOfNames) {
  write("evil.toml", std::regex_replace(read(steel()), std::regex("name = [^\n]*\n"),
                                        "name = \"a\\u001b[31m\\u009b\\n  verdict  pass\"\n"));
  ASSERT_EQ(bash("$dlo solve evil.toml --samples 9 --format csv -o shape.csv").status, 0);
  for (const std::string command :
       {"solve evil.toml --explain", "compare evil.toml --explain",
        "check evil.toml --shape shape.csv", "calibrate evil.toml --shape shape.csv",
        "calibrate evil.toml", "regress evil.toml --baseline b.toml --update",
        "regress evil.toml --baseline b.toml",
        "stability evil.toml --map cF-cc --columns 1 --rows 4 --map-steps 50",
        "bench evil.toml --seconds 0.1"}) {
    const RunResult result = bash("$dlo " + command);
    EXPECT_EQ(result.status, 0) << command << result.err;
    for (const std::string& text : {result.out, result.err}) {
      EXPECT_EQ(display(std::regex_replace(text, std::regex("\n"), " ")),
                std::regex_replace(text, std::regex("\n"), " "))
          << command;
      EXPECT_TRUE(has_none(text, {"\n  verdict  pass"})) << command;
    }
    EXPECT_TRUE(has_all(result.out + result.err, {"a?[31m??"})) << command;
  }
}

}  // namespace
}  // namespace dlo::compare
