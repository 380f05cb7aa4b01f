#pragma once

#include <string>
#include <string_view>

#include "points/raw_shape.hpp"

namespace dlo::compare {

/// How NumPy's files begin (numpy.lib.format), and zip archives.
inline constexpr std::string_view npy_magic = "\x93NUMPY";
inline constexpr std::string_view zip_magic = "PK\x03\x04";

/// Reads a shape as NumPy saves an array: M x 2 or M x 3 of any integers or of 32 or 64 bit
/// floating-point numbers, in any order of bytes and axes; of frames x M x 3 the one that the
/// file's name asks for (shape_name). @throws InputError naming the file
[[nodiscard]] RawShape read_npy_shape(std::string_view bytes, const std::string& file);

/// Reads a shape from NumPy's archive of arrays: that which the file's name asks for, or the one of
/// points. @throws InputError naming the file, and the arrays if there are several
[[nodiscard]] RawShape read_npz_shape(std::string_view bytes, const std::string& file);

}  // namespace dlo::compare
