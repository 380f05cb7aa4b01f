#pragma once

#include <csignal>
#include <filesystem>
#include <optional>
#include <string>

namespace dlo::compare {

/// A file or folder that goes when the process is ended by a signal, see
/// remove_temporaries_at_signals(). Beyond a fixed number at a time they stay.
class TemporaryPath {
 public:
  /// @param path  absolute, or relative to a working directory that stays
  explicit TemporaryPath(const std::string& path);
  ~TemporaryPath();
  TemporaryPath(const TemporaryPath&) = delete;
  TemporaryPath& operator=(const TemporaryPath&) = delete;

  /// From now on a signal leaves it.
  void keep();

 private:
  int slot_ = -1;
};

/// A process group that is killed when the process is ended by a signal, as above. One at a time.
class TemporaryGroup {
 public:
  /// @param group  number of the group, > 1
  explicit TemporaryGroup(int group);
  ~TemporaryGroup();
  TemporaryGroup(const TemporaryGroup&) = delete;
  TemporaryGroup& operator=(const TemporaryGroup&) = delete;
};

/// Removes a file, or a folder with all that is in it, however deep and whatever its permissions,
/// as far as its owner may; links are not followed. May be called by a signal handler.
void remove_tree(const char* path);

/// Kills a TemporaryGroup, and removes what OutputFile and write_report() have not finished; may be
/// called by a signal handler.
void remove_temporaries();

/// Lets all signals that end the process and can be handled remove_temporaries() before, unless
/// they are ignored or handled already. For programs: a library leaves signals alone.
void remove_temporaries_at_signals();

/// Holds all signals back while it lives.
class SignalsHeld {
 public:
  SignalsHeld();
  ~SignalsHeld();
  SignalsHeld(const SignalsHeld&) = delete;
  SignalsHeld& operator=(const SignalsHeld&) = delete;

 private:
  sigset_t before_{};
};

/// Where the environment wants temporary files: TMPDIR, or /tmp if that names no folder.
[[nodiscard]] std::filesystem::path temporary_directory();

/// A new file, open for writing, with the permissions that the umask leaves. Gone when it is left
/// or a signal ends the process, unless it has got another name by then.
class TemporaryFile {
 public:
  /// @param folder  that it is made in
  explicit TemporaryFile(const std::filesystem::path& folder);
  ~TemporaryFile();
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  [[nodiscard]] const std::string& path() const { return path_; }
  /// For whom it is made to close; -1: it could not be made, errno says why.
  [[nodiscard]] int descriptor() const { return descriptor_; }

 private:
  int descriptor_ = -1;
  std::string path_;
  std::optional<TemporaryPath> at_signals_;
};

/// A new folder for nobody else, gone with all that is in it when it is left or a signal ends the
/// process.
class TemporaryFolder {
 public:
  /// @param folder  that it is made in
  /// @throws OutputError with this message and the reason if it cannot be made
  explicit TemporaryFolder(const std::string& failure,
                           const std::filesystem::path& folder = temporary_directory());
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// From now on a signal leaves it.
  void keep() { at_signals_->keep(); }

 private:
  std::filesystem::path path_;
  std::optional<TemporaryPath> at_signals_;
};

}  // namespace dlo::compare
