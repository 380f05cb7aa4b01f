#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "base/text.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/shape_file.hpp"
#include "points/readers.hpp"

namespace dlo::compare {
namespace {

using nlohmann::json;

constexpr const char* json_allowed =
    "(allowed: [[x, y, z], ...], or an object with points_m as dlo solve writes it, or with "
    "points)";

json parsed(std::string_view text, const std::string& file) {
  // The limit allows for shapes written by dlo solve: five values per point, with several
  // equilibria one more.
  constexpr long most_values = 30 * most_shape_points;
  long values = 0;
  const auto line_at = [&](std::size_t byte) {
    const auto end = text.begin() + static_cast<long>(std::min(byte, text.size()));
    return 1 + std::count(text.begin(), end, '\n');
  };
  // The callback of the parser has no position; a stream has one.
  std::istringstream stream{std::string(text)};
  const auto check = [&](int depth, json::parse_event_t event, json& /*value*/) {
    const bool begins =
        event == json::parse_event_t::array_start || event == json::parse_event_t::object_start;
    if (begins && depth >= deepest_nesting) {
      throw InputError(fmt::format("{}:{}: brackets within brackets (allowed: {} levels)", file,
                                   line_at(static_cast<std::size_t>(stream.tellg())),
                                   deepest_nesting));
    }
    if ((begins || event == json::parse_event_t::value) && ++values > most_values) {
      throw InputError(fmt::format("{}: too many values (allowed: {})", file, most_values));
    }
    return true;
  };
  try {
    return json::parse(stream, check);
  } catch (const json::parse_error& error) {
    throw InputError(
        fmt::format("{}:{}: not valid JSON at byte {}", file, line_at(error.byte), error.byte));
  } catch (const json::exception&) {
    throw InputError(fmt::format("{}: not valid JSON: a number is out of range", file));
  }
}

double json_number(const json& value, const std::string& where) {
  if (!value.is_number()) throw InputError(fmt::format("{}: must be a number", where));
  return value.get<double>();
}

std::vector<std::array<double, 3>> json_points(const json& list, const std::string& where) {
  std::vector<std::array<double, 3>> points;
  if (!list.is_array()) throw InputError(fmt::format("{}: must be an array of points", where));
  require_point_count(list.size(), where);
  for (std::size_t i = 0; i < list.size(); ++i) {
    const json& point = list[i];
    const std::string at = fmt::format("{}[{}]", where, i);
    if (!point.is_array() || point.size() < 2 || point.size() > 3) {
      throw InputError(fmt::format("{}: must be a point (allowed: [x, y] or [x, y, z])", at));
    }
    if (point.size() != list[0].size()) {
      throw InputError(fmt::format("{}: {} coordinates where the first point has {}", at,
                                   point.size(), list[0].size()));
    }
    std::array<double, 3> coordinates{};
    for (std::size_t k = 0; k < point.size(); ++k) {
      coordinates[k] = json_number(point[k], fmt::format("{}[{}]", at, k));
    }
    points.push_back(coordinates);
  }
  return points;
}

void read_json_arc_lengths(const json& list, const std::string& where, RawShape& raw) {
  if (!list.is_array() || list.size() != raw.points.size()) {
    throw InputError(
        fmt::format("{}: must be an array of {} numbers, one per point", where, raw.points.size()));
  }
  for (std::size_t i = 0; i < list.size(); ++i) {
    raw.arc_length.push_back(json_number(list[i], fmt::format("{}[{}]", where, i)));
  }
}

}  // namespace

RawShape read_json_shape(std::string_view text, const std::string& file, double unit) {
  const json document = parsed(text, file);
  RawShape raw;
  if (document.is_array()) {
    raw.points = json_points(document, file + ": points");
    return raw;
  }
  raw.in_metres = document.contains("points_m");
  if (raw.in_metres && document.contains("points")) {
    throw InputError(fmt::format("{}: points_m and points (allowed: one of them)", file));
  }
  if (raw.in_metres && unit != 1) {
    throw InputError(fmt::format(
        "{}: points_m is in metres (allowed: unit m, or the name points in another unit)", file));
  }
  const char* points = raw.in_metres ? "points_m" : "points";
  const char* arc_length = raw.in_metres ? "arc_length_m" : "arc_length";
  if (!document.contains(points)) {
    throw InputError(fmt::format("{}: neither points_m nor points {}", file, json_allowed));
  }
  raw.points = json_points(document[points], fmt::format("{}: {}", file, points));
  if (document.contains("d1")) {
    raw.d1 = json_points(document["d1"], file + ": d1");
  }
  if (document.contains(arc_length)) {
    read_json_arc_lengths(document[arc_length], fmt::format("{}: {}", file, arc_length), raw);
  }
  return raw;
}

}  // namespace dlo::compare
