#include "base/temporary_path.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <ctime>
#include <stdexcept>
#include <system_error>

#include "base/output_file.hpp"

namespace dlo::compare {
namespace {

/// Largest number of groups at a time, larger than suite --jobs allows.
constexpr std::size_t most_groups = 2048;
std::array<std::atomic<int>, most_groups> temporary_groups{};  // 0: none
std::atomic<int> starts = 0;  // number of existing GroupStart objects
std::atomic<bool> ending = false;

/// Sleeps for a millisecond. A signal handler may call it.
void wait_shortly() {
  constexpr timespec wait_time{.tv_sec = 0, .tv_nsec = 1'000'000};
  (void)::nanosleep(&wait_time, nullptr);
}

/// Whether a signal without a handler ends a process, as all do except these (signal(7)).
bool ends_process(int number) {
  constexpr std::array harmless_signals = {SIGCHLD, SIGCONT, SIGURG,  SIGWINCH,
                                           SIGSTOP, SIGTSTP, SIGTTIN, SIGTTOU};
  return std::ranges::find(harmless_signals, number) == harmless_signals.end();
}

extern "C" void end_groups_and_process(int number) {
  end_groups();
  // SA_RESETHAND has restored the default, which ends the process when this handler returns.
  (void)std::raise(number);
}

/// Returns the new path in a folder by which `make(path)` succeeded; empty if it cannot succeed,
/// with the reason in errno.
template <typename Make>
std::string make_path_in(const std::filesystem::path& folder, const Make& make) {
  for (;;) {
    std::uint64_t random = 0;
    if (::getrandom(&random, sizeof random, 0) != sizeof random) return {};
    // The name is not derived from another file's name, which may already have the maximum length.
    std::string path = folder / fmt::format(".dlo-{:016x}.tmp", random);
    if (make(path.c_str())) return path;
    if (errno != EEXIST) return {};
  }
}

}  // namespace

GroupStart::GroupStart() {
  sigset_t all;
  ::sigfillset(&all);
  ::pthread_sigmask(SIG_BLOCK, &all, &before_);
  ++starts;
  if (!ending) return;
  --starts;
  for (;;) wait_shortly();  // until the process ends
}

GroupStart::~GroupStart() {
  --starts;
  ::pthread_sigmask(SIG_SETMASK, &before_, nullptr);
}

TemporaryGroup::TemporaryGroup(int group) {
  for (slot_ = 0; slot_ < most_groups; ++slot_) {
    int none = 0;
    if (temporary_groups[slot_].compare_exchange_strong(none, group)) return;
  }
  ::kill(-group, SIGKILL);
  throw std::runtime_error(fmt::format("more than {} programs at a time", most_groups));
}

TemporaryGroup::~TemporaryGroup() { temporary_groups[slot_] = 0; }

void end_groups() {
  ending = true;
  constexpr int longest_start = 1000;  // ms; a program on a lost network folder may never start
  for (int i = 0; i < longest_start && starts > 0; ++i) wait_shortly();
  for (const std::atomic<int>& one : temporary_groups) {
    if (const int group = one; group > 1) ::kill(-group, SIGKILL);
  }
}

void end_groups_at_signals() {
  struct sigaction action = {};
  action.sa_handler = end_groups_and_process;
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  // A signal that arrives during the handler waits.
  ::sigfillset(&action.sa_mask);
  const int last = SIGRTMAX;
  for (int number = 1; number <= last; ++number) {
    if (!ends_process(number)) continue;
    struct sigaction before = {};
    // A signal that the caller ignores stays ignored, as nohup expects; sigaction refuses those
    // that the C library uses.
    if (::sigaction(number, nullptr, &before) == 0 && before.sa_handler == SIG_DFL) {
      ::sigaction(number, &action, nullptr);
    }
  }
}

TemporaryFile::TemporaryFile(const std::filesystem::path& folder) {
  path_ = make_path_in(folder, [this](const char* path) {
    // The kernel applies the umask, which mkstemp would not.
    descriptor_ = ::open(path, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    return descriptor_ >= 0;
  });
}

TemporaryFile::~TemporaryFile() { ::unlink(path_.c_str()); }

TemporaryFolder::TemporaryFolder(const std::string& failure, const std::filesystem::path& folder)
    : path_(make_path_in(folder, [](const char* path) { return ::mkdir(path, S_IRWXU) == 0; })) {
  if (path_.empty()) throw OutputError(fmt::format("{} ({})", failure, std::strerror(errno)));
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::filesystem::path temporary_directory() {
  std::error_code unknown;
  std::filesystem::path path = std::filesystem::temp_directory_path(unknown);
  return path.empty() ? "/tmp" : path;
}

}  // namespace dlo::compare
