#include "base/input_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <mutex>
#include <system_error>
#include <utility>
#include <vector>

#include "dlo/compare/error.hpp"

namespace dlo::compare {
namespace {

[[noreturn]] void refuse_file(const std::string& name, int error, const std::string& more) {
  throw InputError(fmt::format("{}: cannot be read ({}{})", name.empty() ? "\"\"" : name,
                               std::generic_category().message(error), more));
}

std::string kind_of(mode_t mode) {
  if (S_ISDIR(mode)) return "a folder";
  if (S_ISFIFO(mode)) return "a named pipe";
  if (S_ISSOCK(mode)) return "a socket";
  return "a device";
}

void require_regular(const struct stat& status, const std::string& name) {
  if (S_ISREG(status.st_mode)) return;
  throw InputError(fmt::format("{}: {} (allowed: a regular file)", name, kind_of(status.st_mode)));
}

/// Returns a hint if the file exists with the extension .toml, which users often omit; else "".
std::string toml_extension_hint(const std::string& path, int error) {
  std::error_code unknown;
  const bool exists = error == ENOENT && std::filesystem::is_regular_file(path + ".toml", unknown);
  return exists ? fmt::format(", but {}.toml is there", path) : "";
}

[[noreturn]] void refuse_input(const std::string& output, const std::string& name,
                               const std::string& input) {
  throw InputError(fmt::format("{}: is read too{} (allowed: another file)", name,
                               output == input ? "" : fmt::format(", as {}", input)));
}

/// Files of one command. Paths are compared when they are used, because the numbers (inodes) of
/// removed files are given to new files.
struct KnownFiles {
  struct Output {
    std::string file;
    std::string name;  // in messages
    IsWritten is_written;
  };
  std::mutex guard;
  int commands = 0;  // number of InputsKept
  std::vector<std::string> inputs;
  std::vector<Output> outputs;
};

KnownFiles& known_files() {
  static KnownFiles files;
  return files;
}

/// Records a regular file that is about to be read, if InputsKept exists.
/// @throws InputError if it is a declared output
void record_input(const std::string& path) {
  KnownFiles& known = known_files();
  const std::lock_guard lock(known.guard);
  std::error_code unknown;
  if (known.commands == 0 || !std::filesystem::is_regular_file(path, unknown)) return;
  // A file whose reading is refused is an input too: the caller may continue without it.
  if (std::ranges::find(known.inputs, path) == known.inputs.end()) known.inputs.push_back(path);
  for (const auto& [output, name, is_written] : known.outputs) {
    if (is_written(path, output)) refuse_input(output, name, path);
  }
}

}  // namespace

InputsKept::InputsKept() {
  const std::lock_guard lock(known_files().guard);
  ++known_files().commands;
}

InputsKept::~InputsKept() {
  const std::lock_guard lock(known_files().guard);
  if (--known_files().commands > 0) return;
  known_files().inputs.clear();
  known_files().outputs.clear();
}

void declare_output(const std::string& file, const std::string& name, IsWritten is_written) {
  const std::lock_guard lock(known_files().guard);
  if (known_files().commands > 0) known_files().outputs.push_back({file, name, is_written});
}

void require_not_read(const std::string& file, const std::string& name) {
  KnownFiles& known = known_files();
  const std::lock_guard lock(known.guard);
  for (const std::string& input : known.inputs) {
    if (same_file(file, input)) refuse_input(file, name, input);
  }
}

InputFile::InputFile(std::string path) : name_(std::move(path)) {
  record_input(name_);
  do {
    descriptor_ = ::open(name_.c_str(), O_RDONLY | O_CLOEXEC | O_NOCTTY);
  } while (descriptor_ < 0 && errno == EINTR);
  const int error = errno;
  if (descriptor_ < 0) refuse_file(name_, error, toml_extension_hint(name_, error));
}

InputFile::InputFile(int descriptor, std::string name)
    : name_(std::move(name)), descriptor_(descriptor) {}

InputFile::~InputFile() { ::close(descriptor_); }

bool InputFile::read_block(std::string& text, std::size_t most) {
  constexpr std::size_t read_block_size = 1 << 16;
  const std::size_t before = text.size();
  text.resize(before + std::min(read_block_size, most));
  ssize_t count = 0;
  do {
    count = ::read(descriptor_, text.data() + before, text.size() - before);
  } while (count < 0 && errno == EINTR);
  const int error = errno;
  text.resize(before + static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
  if (count < 0) {
    refuse_file(name_, error, bytes_ > 0 ? fmt::format(", after {} bytes", bytes_) : "");
  }
  bytes_ += static_cast<std::size_t>(count);
  return count > 0;
}

std::string InputFile::read_all(std::size_t largest) {
  std::string text;
  while (read_block(text, largest + 1 - text.size())) {
    if (text.size() <= largest) continue;
    throw InputError(
        fmt::format("{}: too large (allowed: files of up to {} bytes)", name_, largest));
  }
  return text;
}

std::string read_file(const std::string& path) { return InputFile(path).read_all(); }

std::string read_regular_file(const std::string& path, const std::string& name) {
  struct stat status {};
  // The status is read before the file is opened, too, because opening alone triggers some devices.
  if (::stat(path.c_str(), &status) != 0) refuse_file(name, errno, "");
  require_regular(status, name);
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOCTTY | O_NONBLOCK);
  if (descriptor < 0) refuse_file(name, errno, "");
  InputFile file(descriptor, name);
  if (::fstat(descriptor, &status) != 0) refuse_file(name, errno, "");
  require_regular(status, name);
  return file.read_all();
}

std::string_view after_byte_order_mark(std::string_view text) {
  constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
  return text.starts_with(byte_order_mark) ? text.substr(byte_order_mark.size()) : text;
}

}  // namespace dlo::compare
