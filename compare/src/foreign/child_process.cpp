#include "foreign/child_process.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <optional>
#include <thread>

#include "base/temporary_path.hpp"
#include "base/timer.hpp"

namespace dlo::compare {
namespace {

/// Attributes for posix_spawn: a new process group, redirected standard descriptors, and default
/// signal handling (this program ignores SIGXFSZ).
class SpawnSettings {
 public:
  explicit SpawnSettings(const ChildFiles& files) {
    ::posix_spawnattr_init(&attributes_);
    ::posix_spawn_file_actions_init(&actions_);
    ::posix_spawnattr_setpgroup(&attributes_, 0);
    sigset_t all;
    ::sigfillset(&all);
    ::posix_spawnattr_setsigdefault(&attributes_, &all);
    sigset_t none;
    ::sigemptyset(&none);
    ::posix_spawnattr_setsigmask(&attributes_, &none);
    ::posix_spawnattr_setflags(
        &attributes_, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK);
    ::posix_spawn_file_actions_addchdir_np(&actions_, files.folder.c_str());
    ::posix_spawn_file_actions_addopen(&actions_, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    constexpr int flags = O_WRONLY | O_CREAT | O_TRUNC;
    constexpr mode_t mode = S_IRUSR | S_IWUSR;
    ::posix_spawn_file_actions_addopen(&actions_, STDOUT_FILENO, files.output.c_str(), flags, mode);
    ::posix_spawn_file_actions_addopen(&actions_, STDERR_FILENO, files.error.c_str(), flags, mode);
  }
  ~SpawnSettings() {
    ::posix_spawn_file_actions_destroy(&actions_);
    ::posix_spawnattr_destroy(&attributes_);
  }
  SpawnSettings(const SpawnSettings&) = delete;
  SpawnSettings& operator=(const SpawnSettings&) = delete;

  /// Starts the program. Returns 0 or the error number.
  int spawn(const std::vector<std::string>& words, pid_t& process) const {
    std::vector<std::string> copies = words;  // argv is not const
    std::vector<char*> arguments;
    arguments.reserve(copies.size() + 1);
    for (std::string& word : copies) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    return ::posix_spawnp(&process, arguments.front(), &actions_, &attributes_, arguments.data(),
                          environ);
  }

 private:
  posix_spawnattr_t attributes_{};
  posix_spawn_file_actions_t actions_{};
};

/// Waits until a child has ended, and leaves it as a zombie; returns false at the time limit. The
/// timer begins before the start, during which a short program may end. The interval between two
/// checks is short at first and then a hundredth of the elapsed time, so that the wall time is
/// accurate to 1 %.
bool ended_within(pid_t process, double time_limit, const Timer& timer, double& seconds) {
  while (true) {
    siginfo_t info{};
    const int status =
        ::waitid(P_PID, static_cast<id_t>(process), &info,
                 static_cast<int>(WEXITED) | static_cast<int>(WNOHANG) | static_cast<int>(WNOWAIT));
    seconds = timer.seconds();
    if (status == 0 && info.si_pid == process) return true;
    if (seconds >= time_limit) return false;
    const double pause = std::clamp(seconds / 100, 5e-5, 1e-2);
    std::this_thread::sleep_for(std::chrono::duration<double>(pause));
  }
}

std::string problem_of(int status) {
  if (WIFSIGNALED(status)) {
    return fmt::format("ended by signal {} ({})", WTERMSIG(status), ::strsignal(WTERMSIG(status)));
  }
  return WEXITSTATUS(status) == 0 ? "" : fmt::format("exit status {}", WEXITSTATUS(status));
}

}  // namespace

ChildOutcome run_child(const std::vector<std::string>& words, const ChildFiles& files,
                       double time_limit) {
  ChildOutcome result;
  const Timer timer;
  pid_t process = 0;
  std::optional<TemporaryGroup> group;
  {
    const GroupStart start;
    const int error = SpawnSettings(files).spawn(words, process);
    if (error != 0) {
      result.problem = fmt::format("could not be started: {}", std::strerror(error));
      return result;
    }
    group.emplace(process);
  }
  result.too_long = !ended_within(process, time_limit, timer, result.seconds);
  // The group is killed before waitpid() releases the process id, which could be reused afterwards.
  ::kill(-process, SIGKILL);
  int status = 0;
  while (::waitpid(process, &status, 0) < 0 && errno == EINTR) continue;
  if (!result.too_long && WIFEXITED(status)) result.exit_status = WEXITSTATUS(status);
  result.problem = result.too_long
                       ? fmt::format("killed after the time limit of {:g} s", time_limit)
                       : problem_of(status);
  return result;
}

}  // namespace dlo::compare
