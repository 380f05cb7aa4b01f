#include "dlo/force_model/instruction_set.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <stdexcept>
#include <string>
#include <vector>

#include "../says.hpp"

namespace dlo::force_model {
namespace {

TEST(InstructionSet, IsFoundByItsName) {
  const std::vector<InstructionSet> sets = available_instruction_sets();
  const char* const names[] = {"baseline", "avx2", "avx512"};
  for (std::size_t i = 0; i < sets.size(); ++i) EXPECT_EQ(instruction_set_named(names[i]), sets[i]);
}

TEST(InstructionSet, ThatIsUnknownIsNamedWithThoseThatThereAre) {
  for (const std::string name : {"sse9", "AVX2", ""}) {
    const std::string error =
        test::error_of<std::invalid_argument>([&] { return instruction_set_named(name); });
    EXPECT_TRUE(error.starts_with("instruction_set_named: DLO_INSTRUCTION_SET = " + name +
                                  ", must be one that this machine has (baseline"))
        << error;
  }
}

// CMakeLists.txt runs it, as all tests but RigidFloor, with each name.
TEST(InstructionSet, IsThatOfTheEnvironmentVariableElseTheFastest) {
  const char* name = std::getenv("DLO_INSTRUCTION_SET");
  EXPECT_EQ(fastest_instruction_set(), name != nullptr && *name != '\0'
                                           ? instruction_set_named(name)
                                           : available_instruction_sets().back());
}

}  // namespace
}  // namespace dlo::force_model
