#include "base/temporary_folder.hpp"

#include <fmt/format.h>
#include <stdlib.h>  // NOLINT(modernize-deprecated-headers): mkdtemp is not in cstdlib

#include <cerrno>
#include <cstring>
#include <system_error>

#include "dlo/compare/error.hpp"

namespace dlo::compare {
namespace {

std::string made(const std::string& failure, const std::filesystem::path& prefix) {
  // What mkdtemp replaces by letters that are not taken.
  std::string path = prefix.string() + ".XXXXXX";
  if (::mkdtemp(path.data()) == nullptr) {
    throw OutputError(fmt::format("{} ({})", failure, std::strerror(errno)));
  }
  return path;
}

}  // namespace

TemporaryFolder::TemporaryFolder(const std::string& failure, const std::filesystem::path& prefix)
    // A signal between making and noting it would leave it behind.
    : TemporaryFolder(SignalsHeld(), failure, prefix) {}

TemporaryFolder::TemporaryFolder(const SignalsHeld& /*held*/, const std::string& failure,
                                 const std::filesystem::path& prefix)
    : path_(made(failure, prefix)), at_signals_(path_.string()) {}

TemporaryFolder::~TemporaryFolder() { remove_tree(path_.c_str()); }

std::filesystem::path temporary_directory() {
  std::error_code unknown;
  std::filesystem::path path = std::filesystem::temp_directory_path(unknown);
  return path.empty() ? "/tmp" : path;
}

}  // namespace dlo::compare
