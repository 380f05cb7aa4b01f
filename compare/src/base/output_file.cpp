#include "base/output_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <optional>
#include <system_error>

#include "base/input_file.hpp"
#include "base/number.hpp"
#include "base/temporary_path.hpp"
#include "dlo/compare/error.hpp"

namespace dlo::compare {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse_output(const std::string& file, const std::string& why) {
  throw InputError(fmt::format("{}: cannot be written ({})", file, why));
}

[[noreturn]] void fail_to_write_output(const std::string& file, int error) {
  throw OutputError(fmt::format("{}: cannot be written ({})", file, std::strerror(error)));
}

std::optional<struct stat> status_of(const std::string& path) {
  struct stat result {};
  if (::stat(path.c_str(), &result) != 0) return std::nullopt;
  return result;
}

bool same(const struct stat& a, const struct stat& b) {
  return a.st_dev == b.st_dev && a.st_ino == b.st_ino;
}

/// Returns N if a folder without links is this process's list of descriptors and the name in it is
/// N >= 0; else std::nullopt.
std::optional<int> descriptor_named(const fs::path& folder, const std::string& name) {
  if (folder != fmt::format("/proc/{}/fd", ::getpid())) return std::nullopt;
  const std::optional<int> number = as_number<int>(name);
  return number && *number >= 0 ? number : std::nullopt;
}

fs::path folder_of(const fs::path& path, const std::string& file) {
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  std::error_code error;
  fs::path real = fs::canonical(folder, error);
  if (error == std::errc::no_such_file_or_directory) {
    refuse_output(file, fmt::format("there is no folder {}", folder.string()));
  }
  if (error) refuse_output(file, fmt::format("{}: {}", folder.string(), error.message()));
  if (!fs::is_directory(real, error)) {
    refuse_output(file, fmt::format("{} is no folder", folder.string()));
  }
  return real;
}

OutputTarget regular_target(const fs::path& path, const std::string& file) {
  const std::string folder = path.parent_path().string();
  const std::optional<struct stat> existing = status_of(path.string());
  for (const int standard : {STDOUT_FILENO, STDERR_FILENO}) {
    struct stat open {};
    if (!existing || ::fstat(standard, &open) != 0 || !same(*existing, open)) continue;
    return {OutputTarget::Kind::descriptor, path.string(), standard};
  }
  if (::access(folder.c_str(), W_OK | X_OK) != 0) {
    refuse_output(file, fmt::format("folder {}: {}", folder, std::strerror(errno)));
  }
  if (existing && ::access(path.c_str(), W_OK) != 0) refuse_output(file, std::strerror(errno));
  return {OutputTarget::Kind::file, path.string(), -1};
}

}  // namespace

OutputTarget output_target(const std::string& file) {
  if (file.empty()) {
    throw InputError("an output with an empty name (allowed: the name of a file)");
  }
  if (file.ends_with('/')) refuse_output(file, "it is the name of a folder");
  fs::path path = file;
  std::error_code error;
  constexpr int most_links = 40;  // limit of the kernel
  for (int links = 0; links <= most_links; ++links) {
    const fs::path folder = folder_of(path, file);
    const std::string name = path.filename().string();
    if (const std::optional<int> descriptor = descriptor_named(folder, name)) {
      const int flags = ::fcntl(*descriptor, F_GETFL);
      if (flags < 0 || (flags & O_ACCMODE) == O_RDONLY) refuse_output(file, std::strerror(EBADF));
      return {OutputTarget::Kind::descriptor, path.string(), *descriptor};
    }
    path = folder / name;
    if (!fs::is_symlink(fs::symlink_status(path, error))) {
      const std::optional<struct stat> existing = status_of(path.string());
      // Only a name that does not exist yet may refer to nothing; the name may also be too long.
      if (!existing && errno != ENOENT) refuse_output(file, std::strerror(errno));
      if (existing && S_ISDIR(existing->st_mode)) refuse_output(file, "it is a folder");
      if (!existing || S_ISREG(existing->st_mode)) return regular_target(path, file);
      if (::access(path.c_str(), W_OK) != 0) refuse_output(file, std::strerror(errno));
      return {OutputTarget::Kind::device, path.string(), -1};
    }
    const fs::path link = fs::read_symlink(path, error);
    if (error) refuse_output(file, error.message());
    path = folder / link;  // `link` itself if it is absolute
  }
  refuse_output(file, std::strerror(ELOOP));
}

bool same_file(const std::string& a, const std::string& b) {
  const std::optional<struct stat> of_a = status_of(a);
  const std::optional<struct stat> of_b = status_of(b);
  return of_a && of_b && same(*of_a, *of_b);
}

void write_all(int descriptor, std::string_view text, const std::string& name) {
  while (!text.empty()) {
    const ssize_t written = ::write(descriptor, text.data(), text.size());
    if (written >= 0) {
      text.remove_prefix(static_cast<std::size_t>(written));
      continue;
    }
    if (errno == EINTR) continue;
    if (errno == EAGAIN) {
      // Another process has made a shared terminal or pipe non-blocking.
      pollfd wait{.fd = descriptor, .events = POLLOUT, .revents = 0};
      if (::poll(&wait, 1, -1) >= 0 || errno == EINTR) continue;
    }
    if (errno == EPIPE) throw BrokenPipe(fmt::format("{}: its reader has closed it", name));
    fail_to_write_output(name, errno);
  }
}

struct OutputFile::State {
  std::string file;  ///< name as the user wrote it
  Replaces replaces;
  OutputTarget target;
  int descriptor = -1;
  /// Next to the target, whose name it gets when it is complete.
  std::optional<TemporaryFile> temporary;

  State(const std::string& name, Replaces what)
      : file(name), replaces(what), target(output_target(name)) {
    require_no_input();
    switch (target.kind) {
      case OutputTarget::Kind::descriptor:
        descriptor = target.descriptor;
        return;
      case OutputTarget::Kind::device:
        descriptor = ::open(target.path.c_str(), O_WRONLY | O_NOCTTY | O_CLOEXEC);
        break;
      case OutputTarget::Kind::file:
        descriptor = temporary.emplace(fs::path(target.path).parent_path()).descriptor();
        break;
    }
    if (descriptor < 0) fail_to_write_output(file, errno);
  }
  ~State() {
    if (target.kind != OutputTarget::Kind::descriptor && descriptor >= 0) ::close(descriptor);
  }

  void require_no_input() const {
    if (replaces == Replaces::no_input) require_not_read(file, file);
  }

  /// Copies the owner of the replaced file, if this user may set it, and its permissions.
  /// @throws OutputError if the permissions cannot be set
  void copy_permissions() const {
    const std::optional<struct stat> existing = status_of(target.path);
    if (!existing) return;
    constexpr unsigned permission_bits = 07777;
    [[maybe_unused]] const int kept = ::fchown(descriptor, existing->st_uid, existing->st_gid);
    if (::fchmod(descriptor, existing->st_mode & permission_bits) != 0) {
      fail_to_write_output(file, errno);
    }
  }

  void close_checked() {
    const int closing = descriptor;
    descriptor = -1;
    if (::close(closing) != 0 && errno != EINTR) fail_to_write_output(file, errno);
  }

  void finish() {
    if (target.kind == OutputTarget::Kind::descriptor) return;
    if (target.kind == OutputTarget::Kind::device) return close_checked();
    require_no_input();  // a file that was read after this output was opened
    copy_permissions();
    // Network file systems report a full disk here or on close; some do not support fsync.
    if (::fsync(descriptor) != 0 && errno != EINVAL && errno != ENOSYS) {
      fail_to_write_output(file, errno);
    }
    close_checked();
    if (::rename(temporary->path().c_str(), target.path.c_str()) != 0) {
      fail_to_write_output(file, errno);
    }
    temporary.reset();
  }
};

OutputFile::OutputFile(const std::string& file, Replaces replaces)
    : state_(std::make_unique<State>(file, replaces)) {}
OutputFile::~OutputFile() = default;

void OutputFile::append(std::string_view text) {
  write_all(state_->descriptor, text, state_->file);
}

void OutputFile::finish() { state_->finish(); }

void write_file(const std::string& file, std::string_view text, Replaces replaces) {
  OutputFile output(file, replaces);
  output.append(text);
  output.finish();
}

}  // namespace dlo::compare
