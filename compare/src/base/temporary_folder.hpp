#pragma once

#include <filesystem>
#include <string>

#include "base/temporary_path.hpp"

namespace dlo::compare {

/// A new folder for nobody else, gone with all that is in it when it is left or a signal ends the
/// process.
class TemporaryFolder {
 public:
  /// @param prefix  of its path; six letters that are not taken follow
  /// @throws OutputError with this message and the reason if it cannot be made
  TemporaryFolder(const std::string& failure, const std::filesystem::path& prefix);
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  TemporaryFolder(TemporaryFolder&&) = delete;
  TemporaryFolder& operator=(TemporaryFolder&&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// From now on a signal leaves it.
  void keep() { at_signals_.keep(); }

 private:
  TemporaryFolder(const SignalsHeld& held, const std::string& failure,
                  const std::filesystem::path& prefix);

  std::filesystem::path path_;
  TemporaryPath at_signals_;
};

/// Where the environment wants temporary files: TMPDIR, or /tmp if that names no folder.
[[nodiscard]] std::filesystem::path temporary_directory();

}  // namespace dlo::compare
