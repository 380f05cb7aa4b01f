#pragma once

#include <csignal>
#include <filesystem>
#include <string>

namespace dlo::compare {

/// A process group that is killed if a signal ends this process and end_group_at_signals() was
/// called before. At most one at a time.
class TemporaryGroup {
 public:
  /// @param group  number of the group, > 1
  explicit TemporaryGroup(int group);
  ~TemporaryGroup();
  TemporaryGroup(const TemporaryGroup&) = delete;
  TemporaryGroup& operator=(const TemporaryGroup&) = delete;
};

/// Kills the TemporaryGroup, if there is one. A signal handler may call it.
void end_group();

/// Installs a handler that calls end_group() for each signal that ends the process by default,
/// unless the signal is ignored or has a handler. Meant for programs: a library installs none.
void end_group_at_signals();

/// Blocks all signals during its lifetime.
class SignalsHeld {
 public:
  SignalsHeld();
  ~SignalsHeld();
  SignalsHeld(const SignalsHeld&) = delete;
  SignalsHeld& operator=(const SignalsHeld&) = delete;

 private:
  sigset_t before_{};
};

/// Returns the folder for temporary files: TMPDIR, or /tmp if that names no folder.
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
  /// Descriptor, which the caller closes; -1 if the file could not be made, with the reason in
  /// errno.
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
  /// @throws OutputError with this message and the reason if it cannot be made
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
