#include <fmt/format.h>

#include <string_view>

#include "base/quote.hpp"
#include "dlo/compare/error.hpp"
#include "foreign/child_process.hpp"

namespace dlo::compare {
namespace {

class Splitter {
 public:
  Splitter(const std::string& command, const std::string& what) : command_(command), what_(what) {}

  std::vector<std::string> words() {
    constexpr std::string_view blanks = " \t\n";
    while (at_ < command_.size()) {
      const char c = command_[at_++];
      if (blanks.find(c) != std::string_view::npos) {
        end_word();
        continue;
      }
      open_ = true;
      if (c == '\'') {
        take_single_quoted();
      } else if (c == '"') {
        take_double_quoted();
      } else {
        word_ += c == '\\' ? next("ends with a backslash") : c;
      }
    }
    end_word();
    if (words_.empty()) fail("is empty");
    return words_;
  }

 private:
  char next(const char* problem) {
    if (at_ == command_.size()) fail(problem);
    return command_[at_++];
  }

  void take_single_quoted() {
    while (true) {
      const char c = next("has a ' that is not closed");
      if (c == '\'') return;
      word_ += c;
    }
  }

  void take_double_quoted() {
    constexpr const char* unclosed = "has a \" that is not closed";
    constexpr std::string_view escaped = "\"\\$`";
    while (true) {
      const char c = next(unclosed);
      if (c == '"') return;
      if (c == '\\') {
        const char after = next(unclosed);
        if (escaped.find(after) == std::string_view::npos) word_ += c;
        word_ += after;
      } else {
        word_ += c;
      }
    }
  }

  void end_word() {
    if (open_) words_.push_back(word_);
    open_ = false;
    word_.clear();
  }

  [[noreturn]] void fail(const char* problem) const {
    throw InputError(fmt::format(
        "{}: the command {} {} (allowed: words as a shell takes them, blanks in quotes)", what_,
        quoted_piece(command_), problem));
  }

  const std::string& command_;
  const std::string& what_;
  std::size_t at_ = 0;
  bool open_ = false;  // inside a word, which may be empty: ''
  std::string word_;
  std::vector<std::string> words_;
};

}  // namespace

std::vector<std::string> command_words(const std::string& command, const std::string& what) {
  return Splitter(command, what).words();
}

}  // namespace dlo::compare
