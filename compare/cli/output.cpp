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

std::string format_of_file(const std::string& file, const std::vector<std::string>& formats) {
  const std::string extension = std::filesystem::path(file).extension().string();
  for (const std::string& format : formats) {
    if (extension == "." + format) return format;
  }
  return {};
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
  namespace fs = std::filesystem;
  std::error_code error;
  // A link stays a link, and a device or pipe is written to, not replaced.
  fs::path target = options.file;
  for (int links = 0; links < 40 && fs::is_symlink(target, error); ++links) {
    target = target.parent_path() / fs::read_symlink(target, error);
  }
  const fs::file_status existing = fs::status(target, error);
  const bool replace = !fs::exists(existing) || fs::is_regular_file(existing);
  const fs::path written =
      replace ? fs::path(fmt::format("{}.{}.tmp", target.string(), ::getpid())) : target;
  const auto fail = [&](const std::string& why) {
    std::error_code ignored;
    if (replace) fs::remove(written, ignored);
    throw compare::InputError(fmt::format("{}: cannot be written ({})", options.file, why));
  };
  if (fs::is_directory(existing)) fail("it is a directory");
  errno = 0;
  std::ofstream stream(written, std::ios::binary);
  stream << content;
  stream.close();
  if (!stream) fail(std::strerror(errno));
  if (!replace) return;
  if (fs::exists(existing)) fs::permissions(written, existing.permissions(), error);
  fs::rename(written, target, error);
  if (error) fail(error.message());
}

}  // namespace dlo::cli
