#include "toml/strict_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "base/text.hpp"
#include "dlo/compare/error.hpp"

namespace dlo::compare {
namespace {

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
  constexpr std::size_t longest_shown_line = 60;
  if (line.size() > longest_shown_line) {
    line.resize(longest_shown_line);
    line += "...";
  }
  return line;
}

}  // namespace

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

const toml::node& StrictTable::required_node(std::string_view key) {
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
  const double value = read_number(key, required_node(key), dimension);
  if (!range.holds(value)) fail(key, fmt::format("out of range (allowed: {})", range.text));
  return value;
}

std::optional<double> StrictTable::optional_number(std::string_view key, Dimension dimension,
                                                   const Range& range) {
  if (find(key) == nullptr) return std::nullopt;
  return number(key, dimension, range);
}

int StrictTable::integer(std::string_view key, const Range& range) {
  const auto value = required_node(key).value_exact<std::int64_t>();
  if (!value || !range.holds(static_cast<double>(*value))) {
    fail(key, fmt::format("must be a whole number (allowed: {})", range.text));
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
  const auto value = required_node(key).value_exact<std::string>();
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

Eigen::MatrixXd StrictTable::columns(std::string_view key, Dimension dimension,
                                     const NumberForm& form) {
  const toml::node& node = required_node(key);
  const toml::array* list = node.as_array();
  const bool nested = list != nullptr && !list->empty() && list->front().is_array();
  if (form.nested.value_or(nested) != nested) fail(key, form.words);
  if (nested && rows_ != nullptr) require_count(key, list->size());
  Eigen::MatrixXd result;
  for (std::size_t i = 0; i < (nested ? list->size() : 1); ++i) {
    const toml::array* row = nested ? list->get(i)->as_array() : list;
    const std::size_t size = row == nullptr ? 1 : row->size();
    if (i == 0)
      result.resize(static_cast<Eigen::Index>(size),
                    nested ? static_cast<Eigen::Index>(list->size()) : 1);
    const bool allowed = std::ranges::find(form.sizes, size) != form.sizes.end();
    if (!allowed || (row == nullptr) != (size == 1) || (nested && row == nullptr) ||
        result.rows() != static_cast<Eigen::Index>(size)) {
      fail(key, form.words);
    }
    for (std::size_t k = 0; k < size; ++k) {
      result(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(i)) = read_number(
          key, row == nullptr ? node : *row->get(k), k < 3 ? dimension : Dimension::number);
    }
  }
  return result;
}

Eigen::Vector3d StrictTable::vector(std::string_view key, Dimension dimension) {
  return columns(key, dimension, {{3}, false, "must be a vector of three numbers [x, y, z]"});
}

std::optional<Eigen::Vector3d> StrictTable::optional_vector(std::string_view key,
                                                            Dimension dimension) {
  if (find(key) == nullptr) return std::nullopt;
  return vector(key, dimension);
}

std::vector<Eigen::Vector2d> StrictTable::pairs(std::string_view key, Dimension dimension,
                                                std::size_t most) {
  if (find(key) == nullptr) return {};
  const bool single = most == 1;
  const Eigen::MatrixXd rows =
      columns(key, dimension,
              {{1, 2},
               single ? std::optional(false) : std::nullopt,
               single ? "must be one number, or two in brackets [x, y]"
                      : "must be one number, [x, y], or rows of two numbers [[x, y], ..]"});
  const auto count = static_cast<std::size_t>(rows.cols());
  if (count > most) fail(key, fmt::format("{} rows (allowed: 1 to {})", count, most));
  if (rows.rows() == 1) return {{0, rows(0)}};
  return {rows.colwise().begin(), rows.colwise().end()};
}

Eigen::Vector2d StrictTable::pair(std::string_view key) {
  const Eigen::Vector2d pair = pairs(key, row(key).dimension, 1).front();
  const Range& range = row(key).range;
  if (range.holds(pair.x()) && range.holds(pair.y())) return pair;
  fail(key, fmt::format("out of range (allowed: {}, about d1 and about d2)", range.text));
}

void StrictTable::require_count(std::string_view key, std::size_t count) const {
  const Range& range = row(key).range;
  if (!range.holds(static_cast<double>(count))) {
    fail(key, fmt::format("{} given (allowed: {})", count, range.text));
  }
}

std::vector<Eigen::Vector3d> StrictTable::vectors(std::string_view key) {
  const Eigen::MatrixXd rows = columns(
      key, row(key).dimension,
      {{3}, std::nullopt, "must be three numbers [x, y, z], or rows of these [[x, y, z], ..]"});
  return {rows.colwise().begin(), rows.colwise().end()};
}

Eigen::MatrixXd StrictTable::points(std::string_view key) {
  return columns(
      key, Dimension::length,
      {{3, 6},
       true,
       "must be rows [[x, y, z], ..] of three numbers, or of six with a vector in every row"});
}

std::optional<Eigen::Matrix3d> StrictTable::optional_rows(std::string_view key) {
  if (find(key) == nullptr) return std::nullopt;
  constexpr const char* words = "must be three rows of three numbers [[x, y, z], [..], [..]]";
  const Eigen::MatrixXd rows = columns(key, Dimension::number, {{3}, true, words});
  if (rows.cols() != 3) fail(key, words);
  return rows.transpose();
}

std::optional<Eigen::Quaterniond> StrictTable::optional_quaternion(std::string_view key) {
  if (find(key) == nullptr) return std::nullopt;
  const Eigen::Vector4d q =
      columns(key, Dimension::number, {{4}, false, "must be four numbers [w, x, y, z]"});
  return Eigen::Quaterniond(q[0], q[1], q[2], q[3]);
}

bool StrictTable::is(std::string_view key, toml::node_type type) const {
  const toml::node* node = table_.get(key);
  return node != nullptr && node->type() == type;
}

StrictTable StrictTable::inner(std::string_view key, const toml::table& table) const {
  StrictTable result(table, name(key), file_);
  if (rows_ != nullptr) result.use_rows_of(result.path_);
  return result;
}

StrictTable StrictTable::table(std::string_view key) {
  const toml::table* found = required_node(key).as_table();
  if (found == nullptr) fail(key, "must be a table");
  return inner(key, *found);
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
  const auto is_table = [](const toml::node& element) { return element.is_table(); };
  if (array == nullptr || !std::ranges::all_of(*array, is_table)) {
    fail(key, fmt::format("must be written as [[{}]]", key));
  }
  if (rows_ != nullptr) require_count(key, array->size());
  for (const toml::node& element : *array) result.push_back(inner(key, *element.as_table()));
  return result;
}

void StrictTable::use_rows_of(std::string_view name) {
  rows_ = &scene_table(name);
  only(rows_->names);
  for (const SceneKey& key : rows_->keys) {
    if (!has(key.name)) continue;
    for (const std::string& other : key.excludes) {
      if (!has(other)) continue;
      fail(key.name, fmt::format("given besides {} (allowed: one of the two)", other));
    }
    for (const std::string& other : key.needs) {
      if (has(other)) continue;
      fail(other,
           fmt::format("missing, it is required beside {0} (allowed: both, or no {0})", key.name));
    }
  }
}

void StrictTable::refuse(const std::vector<std::string>& keys, const std::string& problem) const {
  for (const std::string& key : keys) {
    if (has(key)) fail(key, problem);
  }
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
