#include "toml/strict_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "base/text.hpp"
#include "dlo/compare/error.hpp"

namespace dlo::compare {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

std::string joined(const std::vector<std::string>& words) {
  return fmt::format("{}", fmt::join(words, ", "));
}

std::string shown(const toml::node& node) {
  // fmt prints the fewest digits that identify the double, which are those that the user wrote.
  if (const auto number = node.value_exact<double>()) return fmt::format("{}", *number);
  std::ostringstream text;
  node.visit([&](const auto& value) { text << value; });
  std::string line = text.str();
  std::replace(line.begin(), line.end(), '\n', ' ');
  constexpr std::size_t longest = 60;
  if (line.size() > longest) {
    line.resize(longest);
    line += "...";
  }
  return line;
}

}  // namespace

Range Range::any() { return {-infinity, infinity, false, "any number"}; }
Range Range::positive() { return {0, infinity, true, "> 0"}; }
Range Range::not_negative() { return {0, infinity, false, ">= 0"}; }
Range Range::between(double low, double high, const std::string& unit) {
  return {low, high, false, fmt::format("{} to {}{}", low, high, unit)};
}
bool Range::holds(double value) const {
  return (low_open ? value > low : value >= low) && value <= high;
}

StrictTable::StrictTable(const toml::table& table, std::string path, std::string file)
    : table_(table), path_(std::move(path)), file_(std::move(file)) {}

std::string StrictTable::name(std::string_view key) const {
  return path_.empty() ? std::string(key) : fmt::format("{}.{}", path_, key);
}

std::string StrictTable::where(const toml::node* node) const {
  const toml::source_position position =
      node != nullptr ? node->source().begin : table_.source().begin;
  return position.line > 0 ? fmt::format("{}:{}", file_, position.line) : file_;
}

void StrictTable::fail(std::string_view key, const std::string& problem) const {
  const toml::node* node = table_.get(key);
  const bool has_value = node != nullptr && !node->is_table() && !node->is_array_of_tables();
  throw InputError(where(node), name(key),
                   has_value ? fmt::format(" = {}: {}", shown(*node), problem) : ": " + problem);
}

const toml::node* StrictTable::find(std::string_view key) {
  known_.emplace(key);
  return table_.get(key);
}

const toml::node& StrictTable::need(std::string_view key) {
  const toml::node* node = find(key);
  if (node == nullptr) fail(key, "missing, it is required");
  return *node;
}

double StrictTable::read_number(std::string_view key, const toml::node& node,
                                Dimension dimension) const {
  double value = NAN;
  if (const auto number = node.value_exact<double>()) {
    value = *number;
  } else if (const auto integer = node.value_exact<std::int64_t>()) {
    value = static_cast<double>(*integer);
  } else if (const auto text = node.value_exact<std::string>()) {
    try {
      value = parse_quantity(*text, dimension);
    } catch (const InputError& error) {
      fail(key, error.what());
    }
  } else {
    const std::string units = known_units(dimension);
    fail(key, units.empty() ? "must be a number"
                            : fmt::format("must be a number in SI units or a string with a unit "
                                          "(allowed: {})",
                                          units));
  }
  if (!std::isfinite(value)) fail(key, "must be finite");
  if (const std::string problem = magnitude_problem(value, dimension); !problem.empty()) {
    fail(key, problem);
  }
  return value;
}

double StrictTable::number(std::string_view key, Dimension dimension, const Range& range) {
  const double value = read_number(key, need(key), dimension);
  if (!range.holds(value)) fail(key, fmt::format("out of range (allowed: {})", range.text));
  return value;
}

std::optional<double> StrictTable::optional_number(std::string_view key, Dimension dimension,
                                                   const Range& range) {
  if (find(key) == nullptr) return std::nullopt;
  return number(key, dimension, range);
}

std::optional<int> StrictTable::optional_integer(std::string_view key, int low, int high) {
  if (find(key) == nullptr) return std::nullopt;
  return integer(key, low, high);
}

int StrictTable::integer(std::string_view key, int low, int high) {
  const auto value = need(key).value_exact<std::int64_t>();
  if (!value || *value < low || *value > high) {
    fail(key, fmt::format("must be a whole number (allowed: {} to {})", low, high));
  }
  return static_cast<int>(*value);
}

bool StrictTable::flag(std::string_view key) {
  const toml::node* node = find(key);
  if (node == nullptr) return false;
  const auto value = node->value_exact<bool>();
  if (!value) fail(key, "must be true or false (allowed: true, false)");
  return *value;
}

std::string StrictTable::text(std::string_view key) {
  const auto value = need(key).value_exact<std::string>();
  if (!value) fail(key, "must be a string");
  return *value;
}

std::optional<std::string> StrictTable::optional_text(std::string_view key) {
  if (find(key) == nullptr) return std::nullopt;
  return text(key);
}

std::string StrictTable::choice(std::string_view key, const std::vector<std::string>& allowed) {
  std::string value = text(key);
  if (std::find(allowed.begin(), allowed.end(), value) == allowed.end()) {
    fail(key,
         fmt::format("unknown{} (allowed: {})", did_you_mean(value, allowed), joined(allowed)));
  }
  return value;
}

template <int Size>
Eigen::Vector<double, Size> StrictTable::read_numbers(std::string_view key, const toml::node& node,
                                                      Dimension dimension, const char* form) const {
  const toml::array* array = node.as_array();
  if (array == nullptr || array->size() != Size) fail(key, form);
  Eigen::Vector<double, Size> value;
  for (Eigen::Index i = 0; i < Size; ++i) {
    value[i] = read_number(key, *array->get(static_cast<std::size_t>(i)), dimension);
  }
  return value;
}

Eigen::Vector3d StrictTable::vector(std::string_view key, Dimension dimension) {
  return read_numbers<3>(key, need(key), dimension, "must be a vector of three numbers [x, y, z]");
}

std::optional<Eigen::Vector3d> StrictTable::optional_vector(std::string_view key,
                                                            Dimension dimension) {
  if (find(key) == nullptr) return std::nullopt;
  return vector(key, dimension);
}

std::optional<Eigen::Vector2d> StrictTable::optional_pair(std::string_view key,
                                                          Dimension dimension) {
  const toml::node* node = find(key);
  if (node == nullptr) return std::nullopt;
  if (!node->is_array()) return Eigen::Vector2d(0, read_number(key, *node, dimension));
  return read_numbers<2>(key, *node, dimension, "must be one number, or two in brackets [x, y]");
}

std::vector<Eigen::Vector2d> StrictTable::pairs(std::string_view key, Dimension dimension,
                                                std::size_t most) {
  const toml::node* node = find(key);
  if (node == nullptr) return {};
  const toml::array* rows = node->as_array();
  if (rows == nullptr || rows->empty() || !rows->front().is_array()) {
    return {optional_pair(key, dimension).value()};
  }
  if (rows->size() > most) {
    fail(key, fmt::format("{} rows (allowed: 1 to {})", rows->size(), most));
  }
  std::vector<Eigen::Vector2d> pairs;
  for (const toml::node& row : *rows) {
    pairs.emplace_back(read_numbers<2>(
        key, row, dimension, "must be one number, [x, y], or rows of two numbers [[x, y], ..]"));
  }
  return pairs;
}

std::vector<Eigen::Vector3d> StrictTable::vectors(std::string_view key, Dimension dimension,
                                                  std::size_t most) {
  const toml::array* rows = need(key).as_array();
  if (rows == nullptr || rows->empty() || !rows->front().is_array())
    return {vector(key, dimension)};
  if (rows->size() < 2 || rows->size() > most) {
    fail(key, fmt::format("{} rows (allowed: 2 to {}, or three numbers)", rows->size(), most));
  }
  std::vector<Eigen::Vector3d> vectors;
  for (const toml::node& row : *rows) {
    vectors.emplace_back(read_numbers<3>(
        key, row, dimension, "must be three numbers [x, y, z], or rows of these [[x, y, z], ..]"));
  }
  return vectors;
}

Eigen::MatrixXd StrictTable::points(std::string_view key, std::size_t most) {
  const toml::array& rows = *need(key).as_array();
  if (rows.size() < 2 || rows.size() > most) {
    fail(key, fmt::format("{} rows (allowed: 2 to {})", rows.size(), most));
  }
  const toml::array* first = rows.front().as_array();
  const bool with_vectors = first != nullptr && first->size() == 6;
  Eigen::MatrixXd points(with_vectors ? 6 : 3, static_cast<Eigen::Index>(rows.size()));
  constexpr const char* form =
      "must be rows [[x, y, z], ..] of three numbers, or of six with a vector in every row";
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const toml::array* row = rows[static_cast<std::size_t>(i)].as_array();
    if (row == nullptr || row->size() != static_cast<std::size_t>(points.rows())) fail(key, form);
    for (Eigen::Index k = 0; k < points.rows(); ++k) {
      points(k, i) = read_number(key, (*row)[static_cast<std::size_t>(k)],
                                 k < 3 ? Dimension::length : Dimension::number);
    }
  }
  return points;
}

std::optional<Eigen::Matrix3d> StrictTable::optional_rows(std::string_view key) {
  const toml::node* node = find(key);
  if (node == nullptr) return std::nullopt;
  constexpr const char* form = "must be three rows of three numbers [[x, y, z], [..], [..]]";
  const toml::array* array = node->as_array();
  if (array == nullptr || array->size() != 3) fail(key, form);
  Eigen::Matrix3d rows;
  for (Eigen::Index i = 0; i < 3; ++i) {
    const toml::node& row = *array->get(static_cast<std::size_t>(i));
    rows.row(i) = read_numbers<3>(key, row, Dimension::number, form);
  }
  return rows;
}

std::optional<Eigen::Quaterniond> StrictTable::optional_quaternion(std::string_view key) {
  const toml::node* node = find(key);
  if (node == nullptr) return std::nullopt;
  const Eigen::Vector4d numbers =
      read_numbers<4>(key, *node, Dimension::number, "must be four numbers [w, x, y, z]");
  return Eigen::Quaterniond(numbers[0], numbers[1], numbers[2], numbers[3]);
}

bool StrictTable::is_table(std::string_view key) const {
  const toml::node* node = table_.get(key);
  return node != nullptr && node->is_table();
}

bool StrictTable::is_text(std::string_view key) const {
  const toml::node* node = table_.get(key);
  return node != nullptr && node->is_string();
}

bool StrictTable::is_flag(std::string_view key) const {
  const toml::node* node = table_.get(key);
  return node != nullptr && node->is_boolean();
}

bool StrictTable::is_array(std::string_view key) const {
  const toml::node* node = table_.get(key);
  return node != nullptr && node->is_array();
}

StrictTable StrictTable::table(std::string_view key) {
  const toml::table* inner = need(key).as_table();
  if (inner == nullptr) fail(key, "must be a table");
  return {*inner, name(key), file_};
}

std::optional<StrictTable> StrictTable::optional_table(std::string_view key) {
  if (find(key) == nullptr) return std::nullopt;
  return table(key);
}

std::vector<StrictTable> StrictTable::tables(std::string_view key) {
  std::vector<StrictTable> result;
  const toml::node* node = find(key);
  if (node == nullptr) return result;
  const toml::array* array = node->as_array();
  if (array == nullptr) fail(key, fmt::format("must be written as [[{}]]", key));
  for (const toml::node& element : *array) {
    const toml::table* inner = element.as_table();
    if (inner == nullptr) fail(key, fmt::format("must be written as [[{}]]", key));
    result.emplace_back(*inner, name(key), file_);
  }
  return result;
}

std::vector<std::string> StrictTable::keys() const {
  std::vector<std::string> result;
  for (const auto& [key, node] : table_) result.emplace_back(key.str());
  return result;
}

void StrictTable::only(const std::vector<std::string>& allowed) const {
  for (const std::string& key : keys()) {
    if (std::find(allowed.begin(), allowed.end(), key) != allowed.end()) continue;
    fail(key,
         fmt::format("unknown key{} (allowed: {})", did_you_mean(key, allowed), joined(allowed)));
  }
}

void StrictTable::finish() const { only({known_.begin(), known_.end()}); }

toml::table parse_toml(const std::string& text, const std::string& file) {
  if (text.size() > largest_toml) {
    throw InputError(
        fmt::format("{}: {} bytes (allowed: up to {} of TOML)", file, text.size(), largest_toml));
  }
  require_toml_limits(text, file);
  try {
    return toml::parse(text, file);
  } catch (const toml::parse_error& error) {
    std::string description(error.description());
    std::replace(description.begin(), description.end(), '\n', ' ');
    const bool comma = description.ends_with("saw ','");
    throw InputError(fmt::format("{}:{}: not valid TOML: {} ({})", file, error.source().begin.line,
                                 description,
                                 comma ? "a number has a decimal point: 2.5"
                                       : "text, and a number with a unit, is in quotes: \"2 mm\""));
  }
}

}  // namespace dlo::compare
