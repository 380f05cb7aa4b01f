#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace dlo::compare {

/// A zip archive in memory, as numpy writes it: entries that are stored or deflated, on one disk,
/// not encrypted, each and all together below the size of a file. It is read from its directory.
class ZipArchive {
 public:
  struct Entry {
    std::string name;
    std::size_t size = 0;  ///< inflated [bytes]

   private:
    friend class ZipArchive;
    std::string_view bytes_;  // as the archive has them
    unsigned long crc_ = 0;
    bool deflated_ = false;
  };

  /// @param bytes  outlive it;  @param file  its name, for messages
  /// @throws InputError naming the file, and the entry, if it is damaged, or has what is not read
  ZipArchive(std::string_view bytes, std::string file);

  [[nodiscard]] const std::vector<Entry>& entries() const { return entries_; }
  /// @throws InputError if the entry is damaged
  [[nodiscard]] std::string read(const Entry& entry) const;
  /// Its first bytes, up to `most`.
  [[nodiscard]] std::string read_start(const Entry& entry, std::size_t most) const;

 private:
  [[noreturn]] void fail(const std::string& problem) const;
  /// @param at  of its part of the directory; @return where the next one's is
  [[nodiscard]] std::size_t add_entry(std::string_view bytes, std::size_t at);

  std::string file_;
  std::vector<Entry> entries_;
};

}  // namespace dlo::compare
