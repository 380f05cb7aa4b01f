#include "output.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "dlo/compare/error.hpp"

namespace dlo::cli {

const std::vector<std::string>& format_names() {
  static const std::vector<std::string> names = {"text", "json", "csv"};
  return names;
}

Format OutputOptions::kind() const {
  const auto& names = format_names();
  return static_cast<Format>(std::find(names.begin(), names.end(), format) - names.begin());
}

void write_output(const OutputOptions& options, const std::string& content) {
  if (options.file.empty()) {
    std::fwrite(content.data(), 1, content.size(), stdout);
    if (std::fflush(stdout) != 0) {
      throw compare::InputError(
          fmt::format("standard output: cannot be written ({})", std::strerror(errno)));
    }
    return;
  }
  const std::string temporary = fmt::format("{}.{}.tmp", options.file, ::getpid());
  const auto fail = [&](const std::string& why) {
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
    throw compare::InputError(fmt::format("{}: cannot be written ({})", options.file, why));
  };
  errno = 0;
  std::ofstream stream(temporary, std::ios::binary);
  stream << content;
  stream.close();
  if (!stream) fail(std::strerror(errno));
  std::error_code error;
  std::filesystem::rename(temporary, options.file, error);
  if (error) fail(error.message());
}

}  // namespace dlo::cli
