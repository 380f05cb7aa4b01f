#include "dlo/compare/shape_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <numbers>
#include <string_view>
#include <system_error>
#include <vector>

#include "base/input_file.hpp"
#include "base/number.hpp"
#include "base/quote.hpp"
#include "decode/xml.hpp"
#include "dlo/compare/error.hpp"
#include "points/readers.hpp"

namespace dlo::compare {
namespace {

/// Name of a shape: FILE, or FILE.npy:INDEX for one frame of an array of frames.
struct ShapeName {
  std::string file;   ///< file to read
  std::string index;  ///< index of the frame; empty: the whole array
};

/// Splits a name into its parts; the name of the file itself may contain colons.
ShapeName shape_name(const std::string& name) {
  constexpr std::string_view array = ".npy:";
  const std::size_t found = name.rfind(array);
  if (found == std::string::npos) return {name, ""};
  const std::size_t colon = found + array.size() - 1;
  return {name.substr(0, colon), name.substr(colon + 1)};
}

constexpr const char* arrays_allowed = "(allowed: N x 3 or N x 2)";

/// Returns the name that selects a frame of an array of frames.
std::string frame_selector(const ShapeName& name, const std::string& index) {
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
                    frame_selector(name, "0"), frame_selector(name, "-1")));
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

/// Reads a NumPy array: M x 2 or M x 3 of any integer type or of 32 or 64 bit floating-point
/// numbers, in any byte order and memory order. Of an array of frames, frames x M x 2 or frames x
/// M x 3, it reads the frame that the name selects.
/// @throws InputError naming the file
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

constexpr double largest_coordinate = 1e6;
/// Smallest distance between distinct neighbours [m]. Neighbours closer than this are the same
/// point, because lengths between them would underflow.
constexpr double least_distance = 1e-15;

double distance_between(const std::array<double, 3>& a, const std::array<double, 3>& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

std::string point_location(const RawShape& raw, const std::string& file, std::size_t i) {
  return raw.lines.empty() ? fmt::format("{}: point {}", file, i + 1)
                           : fmt::format("{}:{}: point {}", file, raw.lines[i], i + 1);
}

void require_number(const RawShape& raw, const std::string& file, std::size_t i, const char* name,
                    double value, double unit) {
  if (std::isfinite(value) && std::abs(value * unit) <= largest_coordinate) return;
  throw InputError(fmt::format("{}: {} = {:g} (allowed: numbers up to {:g} m)",
                               point_location(raw, file, i), name, value, largest_coordinate));
}

void require_points(const RawShape& raw, const std::string& file, double unit) {
  if (raw.points.size() < 2) {
    throw InputError(fmt::format("{}: {} point{} (allowed: 2 to {})", file, raw.points.size(),
                                 raw.points.size() == 1 ? "" : "s", most_shape_points));
  }
  constexpr const char* names[] = {"x", "y", "z"};
  for (std::size_t i = 0; i < raw.points.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      require_number(raw, file, i, names[k], raw.points[i][k], unit);
    }
    if (i > 0 && !(unit * distance_between(raw.points[i], raw.points[i - 1]) > least_distance)) {
      throw InputError(
          fmt::format("{}: the same as the point before (allowed: distinct neighbours)",
                      point_location(raw, file, i)));
    }
  }
}

void require_arc_lengths(const RawShape& raw, const std::string& file, double unit) {
  const std::vector<double>& s = raw.arc_length;
  for (std::size_t i = 0; i < s.size(); ++i) {
    require_number(raw, file, i, "s", s[i], unit);
    if (i == 0) continue;
    const bool growing = s[1] > s[0];
    if (growing ? s[i] > s[i - 1] : s[i] < s[i - 1]) continue;
    throw InputError(
        fmt::format("{}: s = {} after {} (allowed: s grows from point to point, or falls)",
                    point_location(raw, file, i), s[i], s[i - 1]));
  }
}

Eigen::Vector3d vector_of(const std::array<double, 3>& v) { return {v[0], v[1], v[2]}; }

/// Checks that each d1 is a unit vector across the rod. The tangent is only known from the two
/// chords at a point, so the allowed angle includes the angle between them.
void require_unit_directors(const RawShape& raw, const std::string& file) {
  if (!raw.d1.empty() && raw.d1.size() != raw.points.size()) {
    throw InputError(fmt::format("{}: d1: {} vectors of {} points (allowed: one a point, or none)",
                                 file, raw.d1.size(), raw.points.size()));
  }
  const std::size_t count = raw.points.size();
  const auto chord = [&](std::size_t i) -> Eigen::Vector3d {
    return (vector_of(raw.points[i + 1]) - vector_of(raw.points[i])).normalized();
  };
  const auto angle = [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return std::atan2(a.cross(b).norm(), a.dot(b));
  };
  for (std::size_t i = 0; i < raw.d1.size(); ++i) {
    const Eigen::Vector3d d1 = vector_of(raw.d1[i]);
    constexpr double rounding = 1e-3;
    if (!(std::abs(d1.norm() - 1) <= rounding)) {
      throw InputError(
          fmt::format("{}: d1 = [{:g}, {:g}, {:g}] of norm {:.6g} (allowed: 1 within {:g})",
                      point_location(raw, file, i), d1.x(), d1.y(), d1.z(), d1.norm(), rounding));
    }
    const std::size_t joint = std::clamp<std::size_t>(i, 1, std::max<std::size_t>(count - 2, 1));
    const Eigen::Vector3d before = chord(joint - 1);
    const Eigen::Vector3d after = count > 2 ? chord(joint) : before;
    const Eigen::Vector3d tangent = i == 0           ? before
                                    : i == count - 1 ? after
                                                     : Eigen::Vector3d(before + after);
    constexpr double right_angle = std::numbers::pi / 2;
    const double most = right_angle / 18 + angle(before, after);
    const double angle_error = std::abs(angle(d1, tangent) - right_angle);
    if (angle_error <= most) continue;
    throw InputError(fmt::format(
        "{}: d1 is {:.3g} degrees off the cross-section (allowed: up to {:.3g}, 5 plus "
        "the bend of the rod there)",
        point_location(raw, file, i), angle_error / right_angle * 90, most / right_angle * 90));
  }
}

/// Returns the length of the polyline through 64 of the points at most: few enough that noise
/// between neighbours hardly lengthens it.
double coarse_polyline_length(const RawShape& raw) {
  constexpr std::size_t most_chords = 63;
  const std::size_t last = raw.points.size() - 1;
  const std::size_t chords = std::min(most_chords, last);
  double sum = 0;
  for (std::size_t i = 0; i < chords; ++i) {
    const auto& [x, y, z] = raw.points[last * i / chords];
    const auto& [next_x, next_y, next_z] = raw.points[last * (i + 1) / chords];
    sum += std::hypot(next_x - x, next_y - y, next_z - z);
  }
  return sum;
}

/// Returns the unit of the column s [m]: the unit of the points, or metres if the polyline would
/// otherwise be more than five times as long as the arc lengths.
/// @throws InputError if it is more than five times as long with both units
double arc_length_unit(const RawShape& raw, const std::string& file, double unit) {
  if (raw.arc_length.empty()) return unit;
  constexpr double largest_length_ratio = 5;
  const double polyline = coarse_polyline_length(raw) * unit;
  const double span = std::abs(raw.arc_length.back() - raw.arc_length.front());
  if (polyline <= largest_length_ratio * span * unit) return unit;
  if (polyline <= largest_length_ratio * span) return 1;
  throw InputError(
      fmt::format("{}: s: spans {:.4g} m where the points' polyline is {:.4g} m long (allowed: s "
                  "in the unit of "
                  "the points, see --unit, or in metres)",
                  file, span * unit, polyline));
}

RawShape read_any_shape(std::string_view text, const std::string& file, double unit) {
  if (text.starts_with(npy_magic)) return points_of(NpyArray(text, file), shape_name(file));
  refuse_archives(text, file);
  text = after_byte_order_mark(text);
  const std::size_t start = text.find_first_not_of(" \t\r\n");
  if (start == std::string_view::npos) {
    throw InputError(fmt::format(
        "{}: empty (allowed: a shape as CSV, JSON, a VTK polyline or a NumPy array)", file));
  }
  const std::string_view content = text.substr(start);
  if (content.starts_with("# vtk")) return read_vtk_shape(text, file);
  if (content.front() == '[' || content.front() == '{') return read_json_shape(text, file, unit);
  return read_csv_shape(text, file);
}

/// @param unit  unit of the numbers, unless the file states that they are in metres [m]
MeasuredShape checked(const RawShape& raw, const std::string& file, double unit) {
  const double metres = raw.in_metres ? 1 : unit;
  require_points(raw, file, metres);
  require_arc_lengths(raw, file, metres);
  require_unit_directors(raw, file);
  MeasuredShape shape;
  shape.file = file;
  shape.unit = metres;
  shape.points.resize(3, static_cast<Eigen::Index>(raw.points.size()));
  for (std::size_t i = 0; i < raw.points.size(); ++i) {
    shape.points.col(static_cast<Eigen::Index>(i)) = metres * vector_of(raw.points[i]);
  }
  shape.d1.resize(3, static_cast<Eigen::Index>(raw.d1.size()));
  for (std::size_t i = 0; i < raw.d1.size(); ++i) {
    shape.d1.col(static_cast<Eigen::Index>(i)) = vector_of(raw.d1[i]).normalized();
  }
  const double arc_metres = arc_length_unit(raw, file, metres);
  for (const double s : raw.arc_length) shape.arc_length.push_back(arc_metres * s);
  shape.notes = raw.notes;
  return shape;
}

}  // namespace

MeasuredShape parse_shape(const std::string& text, const std::string& file, double unit) {
  return checked(read_any_shape(text, file, unit), file, unit);
}

MeasuredShape shape_of(const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                       const std::vector<double>& arc_length, const std::string& name,
                       const Eigen::Ref<const Eigen::Matrix3Xd>& d1) {
  require_point_count(static_cast<std::size_t>(points.cols()), name);
  RawShape raw;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    raw.points.push_back({points(0, i), points(1, i), points(2, i)});
  }
  if (!arc_length.empty() && arc_length.size() != raw.points.size()) {
    throw InputError(fmt::format("{}: {} arc lengths of {} points (allowed: as many, or none)",
                                 name, arc_length.size(), raw.points.size()));
  }
  raw.arc_length = arc_length;
  for (const auto& v : d1.colwise()) raw.d1.push_back({v.x(), v.y(), v.z()});
  return checked(raw, name, 1);
}

std::string file_of_shape(const std::string& name) {
  std::error_code unknown;
  return std::filesystem::exists(name, unknown) ? name : shape_name(name).file;
}

MeasuredShape load_shape(const std::string& path, double unit) {
  return parse_shape(read_file(file_of_shape(path)), path, unit);
}

void require_point_count(std::size_t count, const std::string& where) {
  if (count <= static_cast<std::size_t>(most_shape_points)) return;
  throw InputError(
      fmt::format("{}: {} points (allowed: 2 to {})", where, count, most_shape_points));
}

}  // namespace dlo::compare
