#include <fmt/format.h>

#include <cstdint>
#include <vector>

#include "base/number.hpp"
#include "base/quote.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/shape_file.hpp"
#include "points/readers.hpp"

namespace dlo::compare {
namespace {

constexpr const char* arrays_allowed = "(allowed: N x 3 or N x 2)";

/// Returns the name that selects a frame of an array of frames.
std::string chosen(const ShapeName& name, const std::string& index) {
  return fmt::format("{}:{}", name.file, index);
}

/// Returns the index of the selected frame of an array of frames.
std::size_t frame_of(const NpyArray& array, const ShapeName& name) {
  const std::vector<std::size_t>& n = array.shape();
  const auto frames = static_cast<std::int64_t>(n[0]);
  const std::optional<std::int64_t> index = as_number<std::int64_t>(name.index);
  if (!index || *index >= frames || *index < -frames) {
    array.fail(
        fmt::format("{} frames of {} points{} (allowed: one of them, as {} for the first and {} "
                    "for the last)",
                    n[0], n[1], name.index.empty() ? "" : ", no frame " + quoted_piece(name.index),
                    chosen(name, "0"), chosen(name, "-1")));
  }
  return static_cast<std::size_t>(*index < 0 ? *index + frames : *index);
}

void require_one_frame(const NpyArray& array, const ShapeName& name) {
  const std::vector<std::size_t>& n = array.shape();
  if (n.size() != 2 || (n[1] != 2 && n[1] != 3)) {
    const bool lying = n.size() == 2 && (n[0] == 2 || n[0] == 3);
    array.fail(fmt::format("an array of {} {}{}", array.shape_text(), arrays_allowed,
                           lying ? "; numpy.save its transpose" : ""));
  }
  if (name.index.empty()) return;
  array.fail(fmt::format("has no frames to choose {} from (allowed: {} alone)",
                         quoted_piece(name.index), name.file));
}

RawShape points_of(const NpyArray& array, const ShapeName& name) {
  array.require_numbers();
  const std::vector<std::size_t>& n = array.shape();
  const bool has_frames = n.size() == 3 && (n[2] == 2 || n[2] == 3);
  if (!has_frames) require_one_frame(array, name);
  const std::size_t frame = has_frames ? frame_of(array, name) : 0;
  const std::size_t count = has_frames ? n[1] : n[0];
  require_point_count(count, array.where());
  RawShape raw;
  raw.points.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    std::array<double, 3> point{};
    for (std::size_t k = 0; k < n.back(); ++k) {
      point[k] = has_frames ? array.at({frame, i, k}) : array.at({i, k});
    }
    raw.points.push_back(point);
  }
  return raw;
}

}  // namespace

RawShape read_npy_shape(std::string_view bytes, const std::string& file) {
  return points_of(NpyArray(bytes, file), shape_name(file));
}

}  // namespace dlo::compare
