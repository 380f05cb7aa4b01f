#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "points/raw_shape.hpp"

namespace dlo::compare {

/// Joins a cell to a polyline. @param cell  indices of its points, two or more
/// @param where  "file" or "file:line" @throws InputError if it does not follow on from it
void join_cell(const std::vector<std::size_t>& cell, std::vector<std::size_t>& order,
               const std::string& where);

/// A shape's points, and all that is known of them, in this order.
[[nodiscard]] RawShape in_order(const RawShape& points, const std::vector<std::size_t>& order);

}  // namespace dlo::compare
