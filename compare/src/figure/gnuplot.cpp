#include "figure/gnuplot.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "base/quote.hpp"

namespace dlo::compare {
namespace {

/// A child process's end.
struct Child {
  int error = 0;   ///< of starting it, as errno; 0: it ran
  int status = 0;  ///< as waitpid gives it

  [[nodiscard]] bool good() const { return error == 0 && status == 0; }
};

/// Runs gnuplot in a folder, with its output and messages going to files. Its start-up files, which
/// are the user's, are not read.
Child run_gnuplot(const std::filesystem::path& folder, const std::string& argument,
                  const std::string& out, const std::string& err) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
  constexpr int flags = O_WRONLY | O_CREAT | O_TRUNC;
  constexpr mode_t mode = 0644;
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, out.c_str(), flags, mode);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, err.c_str(), flags, mode);
  std::string words[] = {"gnuplot", "--default-settings", argument};
  char* arguments[] = {words[0].data(), words[1].data(), words[2].data(), nullptr};
  pid_t child = 0;
  Child result;
  result.error = ::posix_spawnp(&child, "gnuplot", &actions, nullptr, arguments, environ);
  posix_spawn_file_actions_destroy(&actions);
  while (result.error == 0 && ::waitpid(child, &result.status, 0) < 0) {
    if (errno != EINTR) result.error = errno;
  }
  return result;
}

std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

std::string joined_lines(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < ' '; }, ' ');
  const std::size_t first = text.find_first_not_of(' ');
  if (first == std::string::npos) return {};
  return text.substr(first, text.find_last_not_of(' ') - first + 1);
}

void replace_all(std::string& text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos;
       at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
}

}  // namespace

std::string gnuplot_version(const std::filesystem::path& folder) {
  const std::string out = "gnuplot_version.out";
  const Child child = run_gnuplot(folder, "--version", out, "/dev/null");
  std::string version = child.good() ? joined_lines(text_of(folder / out)) : "";
  std::error_code ignored;
  std::filesystem::remove(folder / out, ignored);
  return version;
}

std::string run_script(const std::string& script, const std::string& output,
                       const std::filesystem::path& folder) {
  const std::string messages = script + ".err";
  const Child child = run_gnuplot(folder, script, "/dev/null", messages);
  const std::string message = joined_lines(text_of(folder / messages));
  std::error_code ignored;
  std::filesystem::remove(folder / messages, ignored);
  if (child.error != 0) {
    return fmt::format("gnuplot cannot be started ({})", std::strerror(child.error));
  }
  const std::string drawn = text_of(folder / output);
  const bool whole =
      output.ends_with(".svg") ? drawn.find("</svg>") != std::string::npos : !drawn.empty();
  if (child.status == 0 && whole) return {};
  std::filesystem::remove(folder / output, ignored);
  return "gnuplot failed: " + (message.empty() ? "it does not say why" : message);
}

std::string inline_svg(const std::string& svg, const Figure& figure) {
  const std::size_t element = svg.find("<svg");
  const std::size_t end = svg.rfind("</svg>");
  if (element == std::string::npos || end == std::string::npos) {
    throw std::invalid_argument(fmt::format("inline_svg: {}: no svg element", figure.name));
  }
  std::string body = svg.substr(element + 4, end - element - 4);
  for (const char* tag : {"title", "desc"}) {
    const std::size_t from = body.find(fmt::format("<{}>", tag));
    const std::string close = fmt::format("</{}>", tag);
    const std::size_t to = body.find(close);
    if (from < to && to != std::string::npos) body.erase(from, to + close.size() - from);
  }
  for (const char quote : {'\'', '"'}) {
    replace_all(body, fmt::format(" id={}", quote), fmt::format(" id={}{}-", quote, figure.name));
    replace_all(body, fmt::format("href={}#", quote),
                fmt::format("href={}#{}-", quote, figure.name));
  }
  const std::size_t attributes = body.find('>');
  const std::string head =
      fmt::format(">\n<title id=\"{0}-title\">{1}</title>\n<desc id=\"{0}-desc\">{2}</desc>",
                  figure.name, escape_markup(figure.title), escape_markup(figure.description));
  body.replace(attributes, 1, head);
  return fmt::format(
      "<svg role=\"img\" aria-labelledby=\"{0}-title\" aria-describedby=\"{0}-desc\"{1}</svg>\n",
      figure.name, body);
}

}  // namespace dlo::compare
