#include "batch/locked_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "base/output_file.hpp"
#include "dlo/compare/error.hpp"

namespace dlo::compare {

LockedFile::LockedFile(const std::string& path, Held held) : path_(path) {
  for (;;) {
    descriptor_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
    if (descriptor_ < 0) refuse(errno);
    if (::flock(descriptor_, held == Held::wait ? LOCK_EX : LOCK_EX | LOCK_NB) != 0) {
      const int error = errno;
      ::close(descriptor_);
      if (error != EWOULDBLOCK) refuse(error);
      throw InputError(fmt::format(
          "{}: another process is writing it (allowed: one file for each process)", path));
    }
    // Between opening and locking, the process that had it may have renamed it.
    struct stat locked {};
    struct stat named {};
    const bool same = ::fstat(descriptor_, &locked) == 0 && ::stat(path.c_str(), &named) == 0 &&
                      locked.st_ino == named.st_ino && locked.st_dev == named.st_dev;
    if (same && S_ISREG(locked.st_mode)) return;
    ::close(descriptor_);
    if (same) throw InputError(fmt::format("{}: cannot be written (it is no regular file)", path));
  }
}

LockedFile::~LockedFile() { ::close(descriptor_); }

void LockedFile::cut(std::int64_t size) {
  if (::ftruncate(descriptor_, size) != 0) fail(errno);
}

void LockedFile::append(std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = ::write(descriptor_, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail(errno);
    text.remove_prefix(static_cast<std::size_t>(written));
  }
}

void LockedFile::sync() {
  if (::fsync(descriptor_) != 0) fail(errno);
}

void LockedFile::rename(const std::string& path) {
  if (std::rename(path_.c_str(), path.c_str()) != 0) fail(errno);
  path_ = path;
}

void LockedFile::remove() {
  if (::unlink(path_.c_str()) != 0) fail(errno);
}

void LockedFile::refuse(int error) const {
  throw InputError(fmt::format("{}: cannot be written ({})", path_, std::strerror(error)));
}

void LockedFile::fail(int error) const {
  throw OutputError(fmt::format("{}: cannot be written ({})", path_, std::strerror(error)));
}

}  // namespace dlo::compare
