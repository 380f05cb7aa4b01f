#include "points/read_npy.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <utility>
#include <vector>

#include "base/number.hpp"
#include "base/quote.hpp"
#include "decode/zip_archive.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/shape_file.hpp"
#include "points/shape_name.hpp"

namespace dlo::compare {
namespace {

constexpr const char* arrays_allowed = "(allowed: N x 3 or N x 2)";

/// Whether an array's shape is one of points, or of frames of them.
bool has_points(const NpyArray& array) {
  const std::vector<std::size_t>& n = array.shape();
  if (!array.has_numbers() || (n.size() != 2 && n.size() != 3)) return false;
  return n.back() == 2 || n.back() == 3;
}

/// The name by which a frame of an array is asked for; without an index the array's.
std::string chosen(const ShapeName& name, const std::string& index) {
  const std::string array =
      name.key.empty() ? name.file : fmt::format("{}:{}", name.file, name.key);
  return index.empty() ? array : fmt::format("{}:{}", array, index);
}

/// Of an array of frames, that which is asked for.
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
                         quoted_piece(name.index), chosen(name, "")));
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

/// Of the only array of points in an archive. @throws InputError listing what is there
const ZipArchive::Entry& only_points(const ZipArchive& archive, const std::string& file) {
  std::vector<std::string> names;
  std::string example;
  const ZipArchive::Entry* found = nullptr;
  int points = 0;
  for (const ZipArchive::Entry& entry : archive.entries()) {
    const std::string start = archive.read_start(entry, longest_npy_start);
    if (!start.starts_with(npy_magic)) continue;
    const std::string where = fmt::format("{}: entry {}", file, quoted_piece(entry.name));
    const NpyArray array(start, where);
    constexpr std::size_t most_named = 8;
    if (names.size() < most_named) {
      names.push_back(fmt::format("{} ({})", quoted_piece(npz_key(entry)), array.shape_text()));
    }
    if (!has_points(array)) continue;
    ++points;
    if (found == nullptr) found = &entry;
  }
  if (points == 1) return *found;
  if (points == 0) {
    throw InputError(fmt::format("{}: no array of points {}{}", file, arrays_allowed,
                                 names.empty() ? "" : fmt::format(": {}", fmt::join(names, ", "))));
  }
  throw InputError(fmt::format("{0}: several arrays: {1} (allowed: one of them, as {0}:{2})", file,
                               fmt::join(names, ", "), printable_piece(npz_key(*found))));
}

const ZipArchive::Entry& entry_of(const ZipArchive& archive, const ShapeName& name,
                                  const std::string& file) {
  if (name.key.empty()) return only_points(archive, file);
  const ZipArchive::Entry* found = find_npz_entry(archive, name.key);
  if (found != nullptr) return *found;
  throw InputError(fmt::format("{}: no array {} (allowed: {})", file, quoted_piece(name.key),
                               npz_keys(archive)));
}

}  // namespace

RawShape read_npy_shape(std::string_view bytes, const std::string& file) {
  return points_of(NpyArray(bytes, file), shape_name(file));
}

RawShape read_npz_shape(std::string_view bytes, const std::string& file) {
  ShapeName name = shape_name(file);
  const ZipArchive archive(bytes, file);
  const ZipArchive::Entry& entry = entry_of(archive, name, file);
  const std::string array = archive.read(entry);
  const bool was_asked = !name.key.empty();
  name.key = printable_piece(npz_key(entry));
  return points_of(NpyArray(array, was_asked ? file : fmt::format("{}: array {}", file, name.key)),
                   name);
}

}  // namespace dlo::compare
