#pragma once

#include <string>
#include <string_view>

#include "decode/npy_array.hpp"
#include "points/raw_shape.hpp"

namespace dlo::compare {

/// Reads a shape as NumPy saves an array: M x 2 or M x 3 of any integers or of 32 or 64 bit
/// floating-point numbers, in any order of bytes and axes; of frames x M x 3 the one that the
/// file's name asks for (shape_name). @throws InputError naming the file
[[nodiscard]] RawShape read_npy_shape(std::string_view bytes, const std::string& file);

}  // namespace dlo::compare
