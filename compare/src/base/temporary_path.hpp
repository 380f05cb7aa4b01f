#pragma once

#include <csignal>
#include <cstddef>
#include <filesystem>
#include <string>

namespace dlo::compare {

/// Encloses the start of a child and the construction of its TemporaryGroup, so that end_groups()
/// misses no child: it waits for these starts, up to about a second, and none begins after it. All
/// signals of the thread are blocked meanwhile.
class GroupStart {
 public:
  GroupStart();
  ~GroupStart();
  GroupStart(const GroupStart&) = delete;
  GroupStart& operator=(const GroupStart&) = delete;

 private:
  sigset_t before_{};
};

/// A process group that is killed if a signal ends this process and end_groups_at_signals() was
/// called before. Any thread may have one.
class TemporaryGroup {
 public:
  /// @param group  number of the group, > 1
  /// @throws std::runtime_error if there are too many at a time; the group is killed before
  explicit TemporaryGroup(int group);
  ~TemporaryGroup();
  TemporaryGroup(const TemporaryGroup&) = delete;
  TemporaryGroup& operator=(const TemporaryGroup&) = delete;

 private:
  std::size_t slot_ = 0;
};

/// Kills every TemporaryGroup and lets no other begin. A signal handler may call it.
void end_groups();

/// Installs a handler that calls end_groups() for each signal that ends the process by default,
/// except SIGKILL, unless the signal is ignored or has a handler. Meant for programs: a library
/// installs none.
void end_groups_at_signals();

/// Returns the folder for temporary files: TMPDIR (else TMP, TEMP or TEMPDIR), or /tmp if that
/// names no folder.
[[nodiscard]] std::filesystem::path temporary_directory();

/// A new file, open for writing, with the permissions that the umask leaves. Its destructor removes
/// it unless it was renamed. A signal that ends the process leaves the file, named .dlo-*.tmp.
class TemporaryFile {
 public:
  /// @param folder  in which the file is made
  explicit TemporaryFile(const std::filesystem::path& folder);
  ~TemporaryFile();
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  [[nodiscard]] const std::string& path() const { return path_; }
  /// Returns the descriptor, which the caller closes; -1 if the file could not be made, with the
  /// reason in errno.
  [[nodiscard]] int descriptor() const { return descriptor_; }

 private:
  int descriptor_ = -1;
  std::string path_;
};

/// A new folder that only its owner may read. Its destructor removes the folder and its contents.
/// A signal that ends the process leaves the folder, named .dlo-*.tmp.
class TemporaryFolder {
 public:
  /// @param folder  in which the folder is made
  /// @throws OutputError with the message `failure` and the reason if it cannot be made
  explicit TemporaryFolder(const std::string& failure,
                           const std::filesystem::path& folder = temporary_directory());
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace dlo::compare
