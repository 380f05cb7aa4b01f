#include "option/terminal.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdlib>
#include <string_view>
#include <utility>

#include "base/text.hpp"
#include "option/output.hpp"

namespace dlo::cli {
namespace {

/// Returns the value of an environment variable, empty if it is not set.
std::string_view environment(const char* name) {
  const char* value = std::getenv(name);
  return value != nullptr ? value : "";
}

bool is_redirected() { return RedirectedOutput::current() != nullptr; }

bool is_terminal(int file) {
  return !is_redirected() && ::isatty(file) == 1 && environment("TERM") != "dumb";
}

std::size_t columns_of_terminal(int file) {
  winsize size{};
  constexpr std::size_t default_width = 80;
  const bool known = !is_redirected() && ::ioctl(file, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
  return known ? size.ws_col : default_width;
}

}  // namespace

ProgressBar::ProgressBar(std::string what)
    : what_(std::move(what)), visible_(is_terminal(STDERR_FILENO)) {
  stage("");
}

ProgressBar::~ProgressBar() {
  if (visible_) write_standard_error("\r\x1b[K");
}

void ProgressBar::show(std::int64_t done, std::int64_t total) {
  if (!visible_ || total <= 0) return;
  constexpr std::int64_t width = 30;
  const auto filled = static_cast<std::size_t>(width * done / total);
  draw(fmt::format("{} [{:#>{}}{:.>{}}] {:>3} %, {} of {}", what_, "", filled, "",
                   static_cast<std::size_t>(width) - filled, 100 * done / total, done, total));
}

void ProgressBar::stage(const std::string& text) {
  if (visible_)
    draw(text.empty() ? what_ + " ..." : fmt::format("{}: {} ...", what_, compare::display(text)));
}

void ProgressBar::draw(const std::string& line) {
  // A wrapped line could not be erased.
  std::string shown = compare::valid_utf8(line.substr(0, columns_of_terminal(STDERR_FILENO) - 1));
  if (shown == drawn_) return;
  drawn_ = std::move(shown);
  write_standard_error(fmt::format("\r{}\x1b[K", drawn_));
}

std::string verdict_word(const std::string& word, bool good, const std::string& file) {
  const bool colours =
      file.empty() && is_terminal(STDOUT_FILENO) && environment("NO_COLOR").empty();
  return colours ? fmt::format("\x1b[{}m{}\x1b[0m", good ? 32 : 31, word) : word;
}

}  // namespace dlo::cli
