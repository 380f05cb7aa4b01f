#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "../../says.hpp"
#include "dlo/compare/error.hpp"
#include "foreign/child_process.hpp"

namespace dlo::compare {
namespace {

using test::error_of;
using testing::ElementsAre;
using testing::HasSubstr;

std::vector<std::string> words_of(const std::string& command) {
  return command_words(command, "--with x");
}

TEST(CommandWords, AreThoseOfAShell) {
  EXPECT_THAT(words_of("  sim  a\tb\n"), ElementsAre("sim", "a", "b"));
  EXPECT_THAT(words_of("'my sim' \"a b\"c\\ d '' x\"\""), ElementsAre("my sim", "a bc d", "", "x"));
  EXPECT_THAT(words_of(R"("a\"b\\c\$d\e" 'a\b"')"), ElementsAre(R"(a"b\c$d\e)", R"(a\b")"));
}

TEST(CommandWords, NothingIsExpanded) {
  EXPECT_THAT(words_of("sim $HOME ~ *.csv a|b >c; `d` # e"),
              ElementsAre("sim", "$HOME", "~", "*.csv", "a|b", ">c;", "`d`", "#", "e"));
}

TEST(CommandWords, WhatIsNotClosedIsRefused) {
  for (const char* command : {"sim 'a", "sim \"a", "sim \"a\\", "sim a\\", "", "  \n"}) {
    EXPECT_THAT(error_of<InputError>([&] { return words_of(command); }),
                HasSubstr("--with x: the command "))
        << command;
  }
}

}  // namespace
}  // namespace dlo::compare
