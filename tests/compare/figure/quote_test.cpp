#include "base/quote.hpp"

#include <gtest/gtest.h>

namespace dlo::compare {
namespace {

TEST(Quote, MarkupHasOnlyCharactersThatXmlHas) {
  EXPECT_EQ(escape_markup("a\xef\xbf\xbe\xef\xbf\xbf"), "a\xef\xbf\xbd\xef\xbf\xbd");
  EXPECT_EQ(escape_markup("\x1b]]>\x7f'"), " ]]&gt; &#39;");
  EXPECT_EQ(escape_markup("\xef\xbf\xbc\xff"), "\xef\xbf\xbc\xef\xbf\xbd");
}

TEST(Quote, NoFieldOfCsvSteersATerminal) {
  EXPECT_EQ(csv_field("\x1b[31mred"), "?[31mred");
  EXPECT_EQ(csv_field("\xc2\x9b"
                      "7m"),
            "?7m");
  EXPECT_EQ(csv_field("a\x07,b\n\"c\"\t"), "\"a?,b\n\"\"c\"\"\t\"");
  EXPECT_EQ(csv_field("plain\tK\xc3\xb6rper"), "plain\tK\xc3\xb6rper");
  EXPECT_EQ(csv_field(""), "");
}

TEST(Quote, NoTextOfTomlSteersATerminal) {
  EXPECT_EQ(toml_string("\x1b\xc2\x9b\xc2\xa0\"\\"), "\"\\u001b\\u009b\xc2\xa0\\\"\\\\\"");
  EXPECT_EQ(toml_string("\xff"), "\"\xef\xbf\xbd\"");
}

TEST(Quote, WordsOfAShellArePrintable) {
  EXPECT_EQ(shell_word("it's"), "'it'\\''s'");
  EXPECT_EQ(shell_word("a\x1b[1m'\\\xff"), "'a?[1m'\\''\\\xef\xbf\xbd'");
}

}  // namespace
}  // namespace dlo::compare
