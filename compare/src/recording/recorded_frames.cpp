#include "recording/recorded_frames.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "base/input_file.hpp"
#include "base/number.hpp"
#include "decode/npy_array.hpp"
#include "decode/zip_archive.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape_file.hpp"
#include "shape/arc_lengths.hpp"

namespace dlo::compare {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::string_view series_ending = ".vtk.series";
constexpr std::size_t most_frame_points = 1'000'000;

/// The rod at one time.
struct Frame {
  double time = 0;   ///< [s]
  std::string name;  ///< for messages
  std::function<MeasuredShape()> load;
};

Frame file_frame(double time, const fs::path& file) {
  return {time, file.filename().string(), [file] { return load_shape(file.string()); }};
}

std::vector<Frame> series_frames(const fs::path& series) {
  constexpr const char* allowed =
      "(allowed: JSON with \"files\", a list of objects with \"name\" and \"time\")";
  std::vector<Frame> frames;
  try {
    const json document = json::parse(read_file(series.string()));
    for (const json& file : document.at("files")) {
      frames.push_back(file_frame(file.at("time").get<double>(),
                                  series.parent_path() / file.at("name").get<std::string>()));
      if (std::isfinite(frames.back().time)) continue;
      throw InputError(fmt::format("{}: file {}: a time that is not finite {}", series.string(),
                                   frames.size(), allowed));
    }
  } catch (const json::exception&) {
    throw InputError(fmt::format("{}: no series of frames {}", series.string(), allowed));
  }
  if (frames.empty()) {
    throw InputError(fmt::format("{}: no frames {}", series.string(), allowed));
  }
  return frames;
}

/// Of "t = 0.1 s" in a title; none without it.
std::optional<double> time_in_title(std::string_view text) {
  constexpr std::string_view mark = "t = ";
  const std::size_t line = text.find('\n');
  if (line == std::string_view::npos) return std::nullopt;
  std::string_view title = text.substr(line + 1);
  title = title.substr(0, title.find('\n'));
  const std::size_t at = title.rfind(mark);
  if (at == std::string_view::npos) return std::nullopt;
  const auto number = leading_number<double>(title.substr(at + mark.size()));
  if (number.error != std::errc() || !std::isfinite(number.value)) return std::nullopt;
  return number.value;
}

std::vector<Frame> folder_frames(const fs::path& folder) {
  std::vector<fs::path> series;
  std::vector<fs::path> files;
  std::error_code unknown;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, unknown)) {
    const fs::path& path = entry.path();
    if (path.string().ends_with(series_ending)) series.push_back(path);
    if (path.extension() == ".vtk") files.push_back(path);
  }
  if (series.size() == 1) return series_frames(series.front());
  if (files.empty() || series.size() > 1) {
    throw InputError(
        fmt::format("{}: {} in this folder (allowed: one FILE{}, or *.vtk)", folder.string(),
                    files.empty() ? "no frames" : "more than one series", series_ending));
  }
  std::ranges::sort(files);
  std::vector<Frame> frames;
  frames.reserve(files.size());
  for (const fs::path& file : files) {
    const std::optional<double> time = time_in_title(read_file(file.string()));
    if (!time) {
      throw InputError(
          fmt::format("{}:2: no time of this frame (allowed: a title with \"t = 0.1 "
                      "s\", or a FILE{} in the folder)",
                      file.string(), series_ending));
    }
    frames.push_back(file_frame(*time, file));
  }
  return frames;
}

/// Arrays of an archive are named t, points and s.
constexpr const char* archive_allowed =
    "(allowed: t, T times in s, points, T x n x 3 in m, and where they are known s, n arc lengths "
    "in m)";

/// An array's bytes and what they are.
struct ArchiveArray {
  std::string bytes;
  std::optional<NpyArray> array;
};

/// @return its numbers are there; an array only if the archive has it
std::unique_ptr<const ArchiveArray> archive_array(const ZipArchive& archive, const char* key,
                                                  const std::string& file) {
  const ZipArchive::Entry* entry = find_npz_entry(archive, key);
  if (entry == nullptr) return nullptr;
  auto result = std::make_unique<ArchiveArray>();
  result->bytes = archive.read(*entry);
  result->array.emplace(result->bytes, fmt::format("{}: array {}", file, key));
  result->array->require_numbers();
  return result;
}

/// @param count  of the numbers; none: any
std::vector<double> numbers_of(const NpyArray& array, std::optional<std::size_t> count,
                               const char* allowed) {
  const std::vector<std::size_t>& n = array.shape();
  if (n.size() != 1 || n[0] != count.value_or(n[0])) {
    array.fail(fmt::format("an array of {} (allowed: {})", array.shape_text(), allowed));
  }
  std::vector<double> numbers(n[0]);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    numbers[i] = array.at({i});
    if (std::isfinite(numbers[i])) continue;
    array.fail(fmt::format("number {} is {} (allowed: finite ones)", i, numbers[i]));
  }
  return numbers;
}

/// Where its points are along the rod [m].
std::vector<double> arc_lengths_of(const MeasuredShape& shape, double length) {
  if (!shape.arc_length.empty()) return file_arc_lengths(shape, length);
  std::vector<double> s = lengths_along(shape.points);
  const double whole = s.back();
  for (double& at : s) at *= length / whole;
  return s;
}

MarkerMotion motion_of_frames(std::vector<Frame> frames, const std::string& file, double length) {
  std::ranges::stable_sort(frames, {}, &Frame::time);
  const auto twice = std::ranges::adjacent_find(frames, {}, &Frame::time);
  if (twice != frames.end()) {
    throw InputError(fmt::format("{}: {} and {} are both at {:g} s (allowed: one frame a time)",
                                 file, twice->name, std::next(twice)->name, twice->time));
  }
  MarkerMotion result{.file = file, .positions = {}};
  for (const Frame& frame : frames) {
    const MeasuredShape shape = frame.load();
    const std::vector<double> s = arc_lengths_of(shape, length);
    if (result.positions.size() + s.size() > most_frame_points) {
      throw InputError(fmt::format("{}: more than {} points", file, most_frame_points));
    }
    std::vector<MarkerPosition> points;
    points.reserve(s.size());
    for (std::size_t i = 0; i < s.size(); ++i) {
      points.push_back({frame.time, s[i], shape.points.col(static_cast<Eigen::Index>(i))});
    }
    std::ranges::sort(points, {}, &MarkerPosition::arc_length);
    result.positions.insert(result.positions.end(), points.begin(), points.end());
  }
  return result;
}

/// A frame's points [m], 3 x n.
Eigen::Matrix3Xd frame_points(const NpyArray& array, std::size_t frame) {
  const std::vector<std::size_t>& n = array.shape();
  Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Zero(3, static_cast<Eigen::Index>(n[1]));
  for (std::size_t i = 0; i < n[1]; ++i) {
    for (std::size_t k = 0; k < n[2]; ++k) {
      points(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(i)) = array.at({frame, i, k});
    }
  }
  return points;
}

/// Frames of NumPy's archive of arrays.
MarkerMotion motion_of_archive(const std::string& text, const std::string& file, double length) {
  const ZipArchive archive(text, file);
  const auto t = archive_array(archive, "t", file);
  const auto points = archive_array(archive, "points", file);
  const auto s = archive_array(archive, "s", file);
  if (!t || !points) {
    throw InputError(fmt::format("{}: no array {}, but {} {}", file, t ? "points" : "t",
                                 npz_keys(archive), archive_allowed));
  }
  const std::vector<double> times = numbers_of(*t->array, std::nullopt, "a row of times in s");
  const NpyArray& array = *points->array;
  const std::vector<std::size_t>& n = array.shape();
  if (n.size() != 3 || n[0] != times.size() || n[0] == 0 || (n[2] != 2 && n[2] != 3)) {
    array.fail(fmt::format("an array of {} where array t has {} (allowed: T x n x 3 where t has T)",
                           array.shape_text(), times.size()));
  }
  const std::vector<double> arc_lengths =
      s ? numbers_of(*s->array, n[1], "as many numbers as a frame of points has")
        : std::vector<double>{};
  std::vector<Frame> frames;
  frames.reserve(times.size());
  for (std::size_t k = 0; k < times.size(); ++k) {
    const std::string name = fmt::format("points[{}]", k);
    frames.push_back({times[k], name, [&array, &arc_lengths, &file, k, name] {
                        return shape_of(frame_points(array, k), arc_lengths,
                                        fmt::format("{}: {}", file, name));
                      }});
  }
  return motion_of_frames(std::move(frames), file, length);
}

}  // namespace

MarkerMotion parse_recording(const std::string& text, const std::string& file, double length) {
  if (text.starts_with(zip_magic)) return motion_of_archive(text, file, length);
  if (!text.starts_with(npy_magic)) return parse_markers(text, file);
  throw InputError(fmt::format(
      "{}: one array, without times (allowed: FILE.npz with arrays t and points)", file));
}

MarkerMotion load_recording(const std::string& path, double length) {
  std::error_code unknown;
  const bool folder = fs::is_directory(path, unknown);
  if (!folder && !path.ends_with(series_ending)) {
    return parse_recording(read_file(path), path, length);
  }
  return motion_of_frames(folder ? folder_frames(path) : series_frames(path), path, length);
}

}  // namespace dlo::compare
