// Tests of the command `dlo modes`.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "command_fixture.hpp"

namespace dlo::compare {
namespace {

struct ModesCommand : Command {
  static std::string cable() { return shipped_scene("cable"); }
};

TEST_F(ModesCommand, TellsFrequencies) {
  const std::string modes = words({"modes", cable(), "--count 3"});
  const json document = json_of(modes + " --samples 11");
  EXPECT_EQ(document.at("schema"), "dlo/modes/1");
  ASSERT_EQ(document.at("modes").size(), 3U);
  const json& first = document.at("modes")[0];
  EXPECT_EQ(first.at("plane"), "out");
  EXPECT_LT(first.at("relative_error").get<double>(), 1e-8);
  EXPECT_EQ(first.at("shape_m").size(), 11U);
  EXPECT_TRUE(first.at("stepped").is_null());
  const json stepped = json_of(modes + " --stepper dynamic").at("modes")[0];
  EXPECT_EQ(stepped.at("stepped").at("damping_ratio").get<double>(), 1);
}

TEST_F(ModesCommand, BadInputIsOneLineAndItsStatus) {
  expect_error("modes", 2, {"SCENE"});
  expect_error(words({"modes", cable(), "--count 0"}), 2, {"--count"});
  expect_error(words({"modes", cable(), "--rate 0"}), 2, {"--rate"});
  expect_error(words({"modes", cable(), "--damping 2"}), 2, {"--damping"});
  for (const std::string value : {"nan", "inf", "-inf"}) {
    expect_error(words({"modes", cable(), "--rate", value}), 2, {"--rate", "1e-06 to 1e+09"});
    expect_error(words({"modes", cable(), "--tension=" + value}), 2, {"--tension", "1e+12"});
  }
}

}  // namespace
}  // namespace dlo::compare
