#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace dlo::compare {

/// A file that is written by one process at a time. Created if it is not there, never truncated by
/// opening it; its end is where writing goes on. Errors are OutputErrors that name the file.
class LockedFile {
 public:
  enum class Held { refuse, wait };  ///< what to do while another process holds it

  /// @throws InputError if it cannot be opened, is no regular file, or is held and that is refused
  explicit LockedFile(const std::string& path, Held held = Held::refuse);
  ~LockedFile();
  LockedFile(const LockedFile&) = delete;
  LockedFile& operator=(const LockedFile&) = delete;

  void cut(std::int64_t size);
  void append(std::string_view text);
  /// Waits until the disk has everything: a power failure then takes nothing.
  void sync();
  /// Gives the file another name, replacing a file of that name.
  void rename(const std::string& path);
  void remove();

 private:
  [[noreturn]] void refuse(int error) const;
  [[noreturn]] void fail(int error) const;

  std::string path_;
  int descriptor_ = -1;
};

}  // namespace dlo::compare
