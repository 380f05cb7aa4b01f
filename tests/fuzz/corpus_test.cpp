// Tests each reader with its seeds, and with every input that once broke it.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "readers.hpp"

namespace {

void expect_promises_kept(const char* reader, void (*read)(const std::string&)) {
  int files = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(DLO_FUZZ_CORPUS "/" + std::string(reader))) {
    std::ifstream stream(entry.path(), std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(stream), {}};
    ASSERT_TRUE(stream.good() || stream.eof()) << entry.path();
    EXPECT_NO_THROW(read(text)) << entry.path();
    ++files;
  }
  EXPECT_GT(files, 0) << reader;
}

TEST(FuzzCorpus, EveryReaderKeepsItsPromises) {
  expect_promises_kept("scene", dlo::fuzz::scene);
  expect_promises_kept("model", dlo::fuzz::model);
  expect_promises_kept("parameters", dlo::fuzz::parameters);
  expect_promises_kept("baseline", dlo::fuzz::baseline);
  expect_promises_kept("shape", dlo::fuzz::shape);
  expect_promises_kept("vary", dlo::fuzz::vary);
}

}  // namespace
