#pragma once

#include <cstddef>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "decode/binary.hpp"
#include "decode/zip_archive.hpp"

namespace dlo::compare {

/// How NumPy's files begin (numpy.lib.format), and zip archives.
inline constexpr std::string_view npy_magic = "\x93NUMPY";
inline constexpr std::string_view zip_magic = "PK\x03\x04";

/// Bytes from the begin of an array that have its header.
inline constexpr std::size_t longest_npy_start = 10'012;

/// An array as NumPy saves it, of any integers or of 32 or 64 bit floating-point numbers, in any
/// order of bytes and axes.
class NpyArray {
 public:
  /// Reads its header. @param bytes  outlive it;  @param where  for messages
  /// @throws InputError naming `where` if the header is damaged
  NpyArray(std::string_view bytes, std::string where);

  /// Of its dimensions.
  [[nodiscard]] const std::vector<std::size_t>& shape() const { return shape_; }
  /// The same in words, such as "3 x 2".
  [[nodiscard]] std::string shape_text() const;
  /// Whether its numbers are of a type that is read.
  [[nodiscard]] bool has_numbers() const { return format_.has_value(); }
  /// @throws InputError unless has_numbers(), and the bytes hold so many
  void require_numbers() const;
  /// One of them, after require_numbers(). @param index  one a dimension, below its size
  [[nodiscard]] double at(std::initializer_list<std::size_t> index) const;
  /// @throws InputError naming the array
  [[noreturn]] void fail(const std::string& problem) const;
  [[nodiscard]] const std::string& where() const { return where_; }  ///< for messages

 private:
  std::string_view bytes_;
  std::string where_;
  std::string type_;  // as numpy writes it, such as <f8
  std::optional<NumberFormat> format_;
  bool by_columns_ = false;
  std::vector<std::size_t> shape_;
  std::size_t begin_ = 0;  // of the numbers
};

/// As NumPy knows an archive's entry: its name without ".npy".
[[nodiscard]] std::string npz_key(const ZipArchive::Entry& entry);
/// That of an archive with this key, none without.
[[nodiscard]] const ZipArchive::Entry* find_npz_entry(const ZipArchive& archive,
                                                      const std::string& key);
/// The keys of an archive, in quotes, for messages; the first eight of them.
[[nodiscard]] std::string npz_keys(const ZipArchive& archive);

}  // namespace dlo::compare
