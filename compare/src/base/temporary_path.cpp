#include "base/temporary_path.hpp"

#include <dirent.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <system_error>

#include "base/output_file.hpp"
#include "dlo/compare/error.hpp"

namespace dlo::compare {
namespace {

/// What a signal handler can read: no memory is taken or given back.
struct Slot {
  std::atomic<bool> taken = false;
  std::atomic<bool> ready = false;  ///< the path is written
  std::array<char, PATH_MAX> path{};
};

constexpr int most_slots = 16;
std::array<Slot, most_slots> slots;

std::atomic<int> temporary_group = 0;  ///< 0: none

// As getdents64(2) fills a buffer, which readdir would take memory for: inode and offset of 8 bytes
// each, the entry's length in 2 bytes, its type in 1 byte, its name.
constexpr std::size_t length_at = 16;
constexpr std::size_t name_at = 19;

/// What `use(name)` is told of each entry of an open folder, from its first on.
template <typename Use>
void for_each_entry(int folder, const Use& use) {
  ::lseek(folder, 0, SEEK_SET);
  std::array<char, 4096> buffer{};
  for (;;) {
    const long bytes = ::syscall(SYS_getdents64, folder, buffer.data(), buffer.size());
    if (bytes <= 0) return;
    std::uint16_t length = 0;
    for (const char* entry = buffer.data(); entry < buffer.data() + bytes; entry += length) {
      std::memcpy(&length, entry + length_at, sizeof length);
      const char* name = entry + name_at;
      if (std::strcmp(name, ".") != 0 && std::strcmp(name, "..") != 0) use(name);
    }
  }
}

/// A folder that may be read and changed even if its owner has forbidden it; -1 for what is none.
int open_folder(int parent, const char* name) {
  constexpr int flags = O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC;
  int folder = ::openat(parent, name, flags);
  if (folder < 0 && errno == EACCES) {
    // No link: opening one would have been ELOOP or ENOTDIR.
    ::fchmodat(parent, name, S_IRWXU, 0);
    folder = ::openat(parent, name, flags);
  }
  if (folder >= 0) ::fchmod(folder, S_IRWXU);
  return folder;
}

/// Names one after the other; who finds one taken asks for the next.
class FreeName {
 public:
  const char* next() {
    unsigned left = number_++;
    for (std::size_t i = digits; i > 0; --i, left /= 16) {
      name_[prefix + i - 1] = "0123456789abcdef"[left % 16];
    }
    return name_.data();
  }

 private:
  static constexpr std::size_t prefix = 5;
  static constexpr std::size_t digits = 8;
  unsigned number_ = 0;
  std::array<char, prefix + digits + 1> name_{".dlo-"};
};

/// Removes a folder in an open one, whose own folders it puts beside it: however deep a tree is,
/// two folders are open and no memory is taken. @return whether anything has changed
bool remove_or_lift(int root, const char* name, FreeName& free_name) {
  if (::unlinkat(root, name, 0) == 0) return true;
  const int folder = open_folder(root, name);
  if (folder < 0) return false;
  bool changed = false;
  for_each_entry(folder, [&](const char* inner) {
    if (::unlinkat(folder, inner, 0) == 0 || ::unlinkat(folder, inner, AT_REMOVEDIR) == 0) {
      changed = true;
      return;
    }
    // Only what may be written can get another parent.
    const int lifted = open_folder(folder, inner);
    if (lifted >= 0) ::close(lifted);
    int status = -1;
    do {
      status = ::renameat(folder, inner, root, free_name.next());
    } while (status != 0 && (errno == ENOTEMPTY || errno == EEXIST));
    if (status == 0) changed = true;
  });
  ::close(folder);
  return ::unlinkat(root, name, AT_REMOVEDIR) == 0 || changed;
}

/// Long enough for a killed process to be gone, which writes no more then; poll() may be called by
/// a signal handler.
void wait_for_end(int process) {
  constexpr int most_looks = 200;
  for (int look = 0; look < most_looks; ++look) {
    siginfo_t info{};
    const int status =
        ::waitid(P_PID, static_cast<id_t>(process), &info,
                 static_cast<int>(WEXITED) | static_cast<int>(WNOHANG) | static_cast<int>(WNOWAIT));
    if (status != 0 || info.si_pid == process) return;
    ::poll(nullptr, 0, 1);
  }
}

/// Whether a signal that is not handled ends a process, as all do but these (signal(7)).
bool ends_process(int number) {
  constexpr std::array others = {SIGCHLD, SIGCONT, SIGURG,  SIGWINCH,
                                 SIGSTOP, SIGTSTP, SIGTTIN, SIGTTOU};
  return std::find(others.begin(), others.end(), number) == others.end();
}

extern "C" void remove_and_end(int number) {
  remove_temporaries();
  // SA_RESETHAND has put the default back, which ends the process when this handler returns.
  (void)std::raise(number);
}

/// The path by which `make(path)` has made something in a folder that nothing there had; empty
/// where that cannot be, errno says why.
template <typename Make>
std::string made_in(const std::filesystem::path& folder, const Make& make) {
  for (;;) {
    std::uint64_t random = 0;
    if (::getrandom(&random, sizeof random, 0) != sizeof random) return {};
    // Not made of another file's name, which may be as long as a name can be.
    std::string path = folder / fmt::format(".dlo-{:016x}.tmp", random);
    if (make(path.c_str())) return path;
    if (errno != EEXIST) return {};
  }
}

}  // namespace

TemporaryPath::TemporaryPath(const std::string& path) {
  if (path.size() >= PATH_MAX) return;
  for (int i = 0; i < most_slots; ++i) {
    Slot& slot = slots[static_cast<std::size_t>(i)];
    if (slot.taken.exchange(true)) continue;
    std::memcpy(slot.path.data(), path.c_str(), path.size() + 1);
    slot.ready = true;
    slot_ = i;
    return;
  }
}

TemporaryPath::~TemporaryPath() { keep(); }

void TemporaryPath::keep() {
  if (slot_ < 0) return;
  Slot& slot = slots[static_cast<std::size_t>(slot_)];
  slot.ready = false;
  slot.taken = false;
  slot_ = -1;
}

TemporaryGroup::TemporaryGroup(int group) { temporary_group = group; }

TemporaryGroup::~TemporaryGroup() { temporary_group = 0; }

void remove_tree(const char* path) {
  if (::unlinkat(AT_FDCWD, path, 0) == 0) return;
  const int root = open_folder(AT_FDCWD, path);
  if (root < 0) return;
  FreeName free_name;
  // A folder may be changed while it is read, which can hide some of it from one pass.
  // Each pass takes a level away; whoever goes on writing must not keep this from its end.
  constexpr int most_passes = 100'000;
  bool changed = true;
  for (int pass = 0; changed && pass < most_passes; ++pass) {
    changed = false;
    for_each_entry(root, [&](const char* name) {
      if (remove_or_lift(root, name, free_name)) changed = true;
    });
  }
  ::close(root);
  ::unlinkat(AT_FDCWD, path, AT_REMOVEDIR);
}

void remove_temporaries() {
  // First, so that nobody writes into what is removed.
  if (const int group = temporary_group; group > 1) {
    ::kill(-group, SIGKILL);
    wait_for_end(group);
  }
  for (Slot& slot : slots) {
    if (slot.ready) remove_tree(slot.path.data());
  }
}

void remove_temporaries_at_signals() {
  struct sigaction action = {};
  action.sa_handler = remove_and_end;
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  // One that comes meanwhile waits.
  ::sigfillset(&action.sa_mask);
  const int last = SIGRTMAX;
  for (int number = 1; number <= last; ++number) {
    if (!ends_process(number)) continue;
    struct sigaction before = {};
    // What the caller ignores stays ignored, as nohup wants it; the C library's own are refused.
    if (::sigaction(number, nullptr, &before) == 0 && before.sa_handler == SIG_DFL) {
      ::sigaction(number, &action, nullptr);
    }
  }
}

SignalsHeld::SignalsHeld() {
  sigset_t all;
  ::sigfillset(&all);
  ::pthread_sigmask(SIG_BLOCK, &all, &before_);
}

SignalsHeld::~SignalsHeld() { ::pthread_sigmask(SIG_SETMASK, &before_, nullptr); }

TemporaryFile::TemporaryFile(const std::filesystem::path& folder) {
  // A signal between making and noting what is made would leave it behind.
  const SignalsHeld held;
  path_ = made_in(folder, [this](const char* path) {
    // The kernel applies the umask, which mkstemp would not.
    descriptor_ = ::open(path, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    return descriptor_ >= 0;
  });
  at_signals_.emplace(path_);
}

TemporaryFile::~TemporaryFile() { ::unlink(path_.c_str()); }

TemporaryFolder::TemporaryFolder(const std::string& failure, const std::filesystem::path& folder) {
  const SignalsHeld held;
  // cppcheck-suppress useInitializationList ; no signal may come between its making and its noting
  path_ = made_in(folder, [](const char* path) { return ::mkdir(path, S_IRWXU) == 0; });
  if (path_.empty()) throw OutputError(fmt::format("{} ({})", failure, std::strerror(errno)));
  at_signals_.emplace(path_.string());
}

TemporaryFolder::~TemporaryFolder() { remove_tree(path_.c_str()); }

std::filesystem::path temporary_directory() {
  std::error_code unknown;
  std::filesystem::path path = std::filesystem::temp_directory_path(unknown);
  return path.empty() ? "/tmp" : path;
}

}  // namespace dlo::compare
