#include "recording/recorded_frames.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "base/input_file.hpp"
#include "base/number.hpp"
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

/// A file that has the rod at one time.
struct FrameFile {
  double time = 0;  ///< [s]
  fs::path file;
};

std::vector<FrameFile> series_frames(const fs::path& series) {
  constexpr const char* allowed =
      "(allowed: JSON with \"files\", a list of objects with \"name\" and \"time\")";
  std::vector<FrameFile> frames;
  try {
    const json document = json::parse(read_file(series.string()));
    for (const json& file : document.at("files")) {
      frames.push_back({file.at("time").get<double>(),
                        series.parent_path() / file.at("name").get<std::string>()});
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

std::vector<FrameFile> folder_frames(const fs::path& folder) {
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
  std::vector<FrameFile> frames;
  frames.reserve(files.size());
  for (const fs::path& file : files) {
    const std::optional<double> time = time_in_title(read_file(file.string()));
    if (!time) {
      throw InputError(
          fmt::format("{}:2: no time of this frame (allowed: a title with \"t = 0.1 "
                      "s\", or a FILE{} in the folder)",
                      file.string(), series_ending));
    }
    frames.push_back({*time, file});
  }
  return frames;
}

/// Where its points are along the rod [m].
std::vector<double> arc_lengths_of(const MeasuredShape& shape, double length) {
  if (!shape.arc_length.empty()) return file_arc_lengths(shape, length);
  std::vector<double> s = lengths_along(shape.points);
  const double whole = s.back();
  for (double& at : s) at *= length / whole;
  return s;
}

MarkerMotion motion_of_frames(std::vector<FrameFile> frames, const std::string& file,
                              double length) {
  std::ranges::stable_sort(frames, {}, &FrameFile::time);
  const auto twice = std::ranges::adjacent_find(frames, {}, &FrameFile::time);
  if (twice != frames.end()) {
    throw InputError(fmt::format("{}: {} and {} are both at {:g} s (allowed: one frame a time)",
                                 file, twice->file.filename().string(),
                                 std::next(twice)->file.filename().string(), twice->time));
  }
  MarkerMotion result{.file = file, .positions = {}};
  for (const FrameFile& frame : frames) {
    const MeasuredShape shape = load_shape(frame.file.string());
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

}  // namespace

MarkerMotion load_recording(const std::string& path, double length) {
  std::error_code unknown;
  const bool folder = fs::is_directory(path, unknown);
  if (!folder && !path.ends_with(series_ending)) return load_markers(path);
  return motion_of_frames(folder ? folder_frames(path) : series_frames(path), path, length);
}

}  // namespace dlo::compare
