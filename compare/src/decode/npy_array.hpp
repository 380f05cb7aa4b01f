#pragma once

#include <cstddef>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "decode/binary.hpp"

namespace dlo::compare {

/// First bytes of a file with one array that NumPy saves (numpy.lib.format).
inline constexpr std::string_view npy_magic = "\x93NUMPY";

/// An array saved by NumPy, of any integers or of 32 or 64 bit floating-point numbers, in any order
/// of bytes and axes.
class NpyArray {
 public:
  /// Reads the header. @param bytes  must outlive the array;  @param where  for messages
  /// @throws InputError that names `where` if the header is damaged or too long, or if it is that
  /// of a structured array
  NpyArray(std::string_view bytes, std::string where);

  /// Returns the size of each dimension.
  [[nodiscard]] const std::vector<std::size_t>& shape() const { return shape_; }
  /// Returns the dimensions as text, such as "3 x 2".
  [[nodiscard]] std::string shape_text() const;
  /// Checks the numbers. @throws InputError unless their type is supported, and the bytes contain
  /// all of them and nothing else
  void require_numbers() const;
  /// Returns one number, after require_numbers(). @param index  one per dimension, below its size
  [[nodiscard]] double at(std::initializer_list<std::size_t> index) const;
  /// Throws an InputError that names the array.
  [[noreturn]] void fail(const std::string& problem) const;
  [[nodiscard]] const std::string& where() const { return where_; }  ///< for messages

 private:
  std::string_view bytes_;
  std::string where_;
  std::string type_;  // type as NumPy writes it, such as <f8
  std::optional<NumberFormat> format_;
  bool by_columns_ = false;
  std::vector<std::size_t> shape_;
  std::size_t begin_ = 0;  // start of the numbers
};

}  // namespace dlo::compare
