#include "base/temporary_path.hpp"

#include <dirent.h>
#include <fcntl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <climits>
#include <csignal>
#include <cstdint>
#include <cstring>

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

void remove_tree(int parent, const char* name, int depth) {
  if (::unlinkat(parent, name, 0) == 0 || depth == 0) return;
  const int folder = ::openat(parent, name, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (folder < 0) return;
  std::array<char, 4096> buffer{};
  for (;;) {
    const long bytes = ::syscall(SYS_getdents64, folder, buffer.data(), buffer.size());
    if (bytes <= 0) break;
    std::uint16_t length = 0;
    for (const char* entry = buffer.data(); entry < buffer.data() + bytes; entry += length) {
      std::memcpy(&length, entry + length_at, sizeof length);
      const char* inner = entry + name_at;
      if (std::strcmp(inner, ".") != 0 && std::strcmp(inner, "..") != 0) {
        remove_tree(folder, inner, depth - 1);
      }
    }
  }
  ::close(folder);
  ::unlinkat(parent, name, AT_REMOVEDIR);
}

extern "C" void remove_and_end(int number) {
  remove_temporaries();
  // SA_RESETHAND has put the default back, which ends the process when this handler returns.
  (void)std::raise(number);
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

void remove_temporaries() {
  // First, so that nobody writes into what is removed.
  if (const int group = temporary_group; group > 1) ::kill(-group, SIGKILL);
  constexpr int deepest = 4;  // a report: its folder, report/, scenes/
  for (Slot& slot : slots) {
    if (slot.ready) remove_tree(AT_FDCWD, slot.path.data(), deepest);
  }
}

void remove_temporaries_at_signals() {
  struct sigaction action = {};
  action.sa_handler = remove_and_end;
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  ::sigemptyset(&action.sa_mask);
  for (const int number : {SIGHUP, SIGINT, SIGPIPE, SIGTERM}) {
    struct sigaction before = {};
    // What the caller ignores stays ignored, as nohup wants it.
    if (::sigaction(number, nullptr, &before) == 0 && before.sa_handler == SIG_DFL) {
      ::sigaction(number, &action, nullptr);
    }
  }
}

}  // namespace dlo::compare
