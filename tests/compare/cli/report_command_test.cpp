#include <gmock/gmock.h>

#include <filesystem>
#include <regex>
#include <set>

#include "command_fixture.hpp"

namespace dlo::test {
namespace {

using testing::HasSubstr;

const char* const cable = "/scenes/cable.toml";  // hooke, consistent, N = 16: 1.05 % of l

TEST_F(Command, ReportMakesAPage) {
  const std::string folder = path("report");
  const std::string result =
      said(words({"report", std::string(DLO_DATA) + cable, "--quick -o", folder}));
  EXPECT_THAT(result, HasSubstr("Law hooke, bookkeeping consistent: 0 of 1 shapes are right"));
  EXPECT_THAT(result, HasSubstr("report/index.html"));
  const std::string page = read(folder + "/index.html");
  EXPECT_LT(page.size(), 3'000'000U);
  for (const char* id : {"verdict", "shapes", "deviation", "budget", "modulus", "speed",
                         "stability", "hard-cases", "provenance"}) {
    EXPECT_THAT(page, HasSubstr("<section id=\"" + std::string(id) + "\">"));
  }
  EXPECT_THAT(page, HasSubstr("They were left out"));
  EXPECT_EQ(read(folder + "/scenes/cable.toml"), read(std::string(DLO_DATA) + cable));

  // Every command that the page prints exists, with its options, and takes the folder's scenes.
  const std::regex printed("<code>dlo ([a-z]+)([^<]*)</code>");
  std::set<std::string> commands;
  for (std::sregex_iterator it(page.begin(), page.end(), printed), end; it != end; ++it) {
    const std::string name = (*it)[1];
    const std::string arguments = (*it)[2];
    commands.insert(name);
    const std::string help = run(name + " --help").out;
    const std::regex option("--[a-z-]+");
    for (std::sregex_iterator o(arguments.begin(), arguments.end(), option); o != end; ++o) {
      EXPECT_THAT(help, HasSubstr(o->str())) << it->str();
    }
    const std::regex scene("scenes/[A-Za-z0-9._-]+");
    for (std::sregex_iterator s(arguments.begin(), arguments.end(), scene); s != end; ++s) {
      EXPECT_TRUE(std::filesystem::exists(folder + "/" + s->str())) << it->str();
    }
  }
  EXPECT_EQ(commands, (std::set<std::string>{"bench", "compare", "report", "stability"}));
}

TEST_F(Command, ReportTakesACoordinateThatOnlyASubnormalNumberHolds) {
  const std::string file = scene(
      "[rod]\nlength = 0.3\ndiameter = \"1 mm\"\nmaterial = \"copper\"\n"
      "[[gripper]]\nat = 0\nposition = [0, -3e-312, 0]\ndirection = 0\n");
  const std::string result = said(words({"report", file, "--quick -o", path("subnormal")}));
  EXPECT_THAT(read(path("subnormal") + "/index.html"), HasSubstr("<section id=\"shapes\">"));
}

TEST_F(Command, ReportRefusesWhatIsNotAReport) {
  std::filesystem::create_directory(path("mine"));
  std::ofstream(path("mine") + "/diary.txt") << "dear diary";
  expect_error(words({"report", steel(), "--quick -o", path("mine")}), 2,
               {"mine", "diary.txt", "allowed"});
  EXPECT_EQ(read(path("mine") + "/diary.txt"), "dear diary");
  expect_error("report " + steel(), 2, {"--output"});
  expect_error(words({"report nowhere.toml -o", path("new")}), 2, {"nowhere.toml"});
  EXPECT_FALSE(std::filesystem::exists(path("new")));
}

}  // namespace
}  // namespace dlo::test
