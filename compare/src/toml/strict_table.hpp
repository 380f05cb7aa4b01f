#pragma once

#include <toml++/toml.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "dlo/compare/choice.hpp"
#include "toml/scene_keys.hpp"

namespace dlo::compare {

/// A TOML table that is read strictly: every key has to be read before finish(), and every value
/// must have the right type and range. All errors are InputErrors of the form "file:line: key =
/// value: what is wrong (allowed: ...)".
class StrictTable {
 public:
  StrictTable(const toml::table& table, std::string path, std::string file);

  [[nodiscard]] bool has(std::string_view key) const { return table_.contains(key); }

  /// Reads a number in SI units, or a string with a unit. @throws InputError if missing or invalid
  double number(std::string_view key, Dimension dimension, const Range& range);
  std::optional<double> optional_number(std::string_view key, Dimension dimension,
                                        const Range& range);
  /// Reads true or false; false if the key is missing.
  bool flag(std::string_view key);
  std::string text(std::string_view key);
  std::optional<std::string> optional_text(std::string_view key);
  int integer(std::string_view key, const Range& range);
  int integer(std::string_view key, int low, int high) {
    return integer(key, Range::between(low, high, ""));
  }
  /// Reads one of `allowed`.
  std::string choice(std::string_view key, const std::vector<std::string>& allowed);
  /// Reads a value of an enumeration by its name in Choices.
  template <Chosen Value>
  Value choice(std::string_view key) {
    return from_name<Value>(choice(key, names<Value>()));
  }
  Eigen::Vector3d vector(std::string_view key, Dimension dimension);
  std::optional<Eigen::Vector3d> optional_vector(std::string_view key, Dimension dimension);
  /// Reads one number y, which means [0, y], a pair [x, y], or, if `most` > 1, up to `most` rows of
  /// two numbers each: [[x, y], ..]. Empty without the key.
  std::vector<Eigen::Vector2d> pairs(std::string_view key, Dimension dimension, std::size_t most);

  /// Reads a table of a scene from here on: dimensions, ranges and required keys are those of its
  /// rows, also in inner tables.
  /// @throws InputError that names the first key without a row, or that another key excludes, or
  /// that another key needs
  void use_rows_of(std::string_view name);
  /// Reads a key by its row. A missing key that is not required leaves the value as it is.
  /// @return whether the key is given
  template <typename Value>
  bool read(std::string_view key, Value& value) {
    if (find(key) == nullptr && !row(key).required()) return false;
    value = value_of(key, value);
    return true;
  }
  /// Reads a key that has to be given, by its row.
  double number(std::string_view key) { return number(key, row(key).dimension, row(key).range); }
  int integer(std::string_view key) { return integer(key, row(key).range); }
  Eigen::Vector3d vector(std::string_view key) { return vector(key, row(key).dimension); }
  Eigen::Vector2d pair(std::string_view key);
  std::vector<Eigen::Vector2d> pairs(std::string_view key) {
    return pairs(key, row(key).dimension, static_cast<std::size_t>(row(key).range.high));
  }
  /// Reads one of the names in a key's row; returns the default without the key.
  std::string choice(std::string_view key) {
    return find(key) == nullptr ? row(key).missing : choice(key, row(key).choices());
  }
  /// Reads rows of three numbers; a single vector is one row.
  std::vector<Eigen::Vector3d> vectors(std::string_view key);
  /// Reads rows of three lengths, which become columns; or of six numbers in every row, a point and
  /// a vector at it.
  Eigen::MatrixXd points(std::string_view key);
  /// Reads three rows of three numbers each; std::nullopt if the key is not given.
  std::optional<Eigen::Matrix3d> optional_rows(std::string_view key);
  /// Reads a quaternion as it is written, of any norm; std::nullopt if the key is not given.
  std::optional<Eigen::Quaterniond> optional_quaternion(std::string_view key);
  /// Refuses the first of these keys that is given. @throws InputError with `problem`
  void refuse(const std::vector<std::string>& keys, const std::string& problem) const;

  std::optional<StrictTable> optional_table(std::string_view key);
  StrictTable table(std::string_view key);
  /// Returns the tables of [[key]], in order. Their number is checked if the table has rows.
  std::vector<StrictTable> tables(std::string_view key);
  /// Whether a key is given and has a value of this type.
  [[nodiscard]] bool is(std::string_view key, toml::node_type type) const;
  [[nodiscard]] std::vector<std::string> keys() const;

  /// Checks that the table has only allowed keys; their values are not checked. It is called before
  /// a key is read (use_rows_of() does), so that a message names a misspelt key rather than the key
  /// that is missing because of it.
  /// @throws InputError that names the first key that is not allowed
  void only(const std::vector<std::string>& allowed) const;

  /// Checks that every key was read.
  /// @throws InputError that names the first key that was not read, and the allowed keys
  void finish() const;

  /// Returns "file:line" of this table; "file" if it was made in code.
  [[nodiscard]] std::string where() const { return where(nullptr); }

  /// Throws an InputError "file:line: key = value: problem", without " = value" if the key is
  /// missing or a table.
  [[noreturn]] void fail(std::string_view key, const std::string& problem) const;

 private:
  [[nodiscard]] const SceneKey& row(std::string_view key) const { return rows_->key(key); }
  /// Reads a given key as the type of the second argument.
  template <typename Value>
  Value value_of(std::string_view key, const std::optional<Value>& /*type*/) {
    return value_of(key, Value{});
  }
  template <typename Value>
  Value value_of(std::string_view key, const Value& /*type*/) {
    if constexpr (std::is_same_v<Value, double>) return number(key);
    if constexpr (std::is_same_v<Value, int>) return integer(key);
    if constexpr (std::is_same_v<Value, bool>) return flag(key);
    if constexpr (std::is_same_v<Value, std::string>) return text(key);
    if constexpr (std::is_same_v<Value, Eigen::Vector3d>) return vector(key);
    if constexpr (std::is_same_v<Value, Eigen::Vector2d>) return pair(key);
    if constexpr (std::is_enum_v<Value>) return choice<Value>(key);
  }
  [[nodiscard]] StrictTable inner(std::string_view key, const toml::table& table) const;
  /// Checks the number of a key's rows or tables by its row.
  void require_count(std::string_view key, std::size_t count) const;
  const toml::node* find(std::string_view key);
  const toml::node& required_node(std::string_view key);
  [[nodiscard]] std::string where(const toml::node* node) const;
  [[nodiscard]] std::string name(std::string_view key) const;
  [[nodiscard]] double read_number(std::string_view key, const toml::node& node,
                                   Dimension dimension) const;
  /// Form of a value of several numbers.
  struct NumberForm {
    /// Allowed numbers of values in a row; 1 is a number without brackets.
    std::vector<std::size_t> sizes;
    std::optional<bool> nested;  ///< whether there are rows; empty: either
    const char* words;           ///< description of the form for a message
  };
  /// Reads rows of numbers, which become columns. The dimension is that of the first three numbers
  /// of a row; others have none.
  [[nodiscard]] Eigen::MatrixXd columns(std::string_view key, Dimension dimension,
                                        const NumberForm& form);

  const toml::table& table_;
  std::string path_;
  std::string file_;
  const SceneTable* rows_ = nullptr;
  std::set<std::string, std::less<>> known_;
};

/// Largest size of a TOML text [bytes]. A scene of ten thousand loads has a tenth of it; the parsed
/// text takes about fifty times its size.
inline constexpr std::size_t largest_toml = std::size_t{1} << 22;

/// Parses a file's text.
/// @throws InputError with file, line and the parser's message, or as require_toml_limits(), or if
/// the text is larger than largest_toml
[[nodiscard]] toml::table parse_toml(const std::string& text, const std::string& file);

}  // namespace dlo::compare
