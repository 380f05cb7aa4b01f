#include "points/polyline.hpp"

#include <fmt/format.h>

#include "dlo/compare/error.hpp"

namespace dlo::compare {

void join_cell(const std::vector<std::size_t>& cell, std::vector<std::size_t>& order,
               const std::string& where) {
  if (cell.size() < 2) {
    throw InputError(fmt::format("{}: a line of fewer than two points", where));
  }
  if (!order.empty() && cell.front() != order.back()) {
    throw InputError(fmt::format(
        "{}: several separate lines (allowed: one polyline, or lines that follow on)", where));
  }
  order.insert(order.end(), cell.begin() + (order.empty() ? 0 : 1), cell.end());
  require_point_count(order.size(), where);
}

RawShape in_order(const RawShape& points, const std::vector<std::size_t>& order) {
  RawShape result;
  result.in_metres = points.in_metres;
  result.notes = points.notes;
  for (const std::size_t i : order) {
    result.points.push_back(points.points[i]);
    if (!points.lines.empty()) result.lines.push_back(points.lines[i]);
    if (!points.arc_length.empty()) result.arc_length.push_back(points.arc_length[i]);
    if (!points.d1.empty()) result.d1.push_back(points.d1[i]);
  }
  return result;
}

}  // namespace dlo::compare
