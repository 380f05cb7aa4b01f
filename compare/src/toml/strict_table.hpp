#pragma once

#include <toml++/toml.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "dlo/compare/choice.hpp"
#include "toml/quantity.hpp"

namespace dlo::compare {

/// Allowed range of a number, with its description for a message.
struct Range {
  double low;
  double high;
  bool low_open;
  std::string text;

  [[nodiscard]] static Range any();
  [[nodiscard]] static Range positive();
  [[nodiscard]] static Range not_negative();
  [[nodiscard]] static Range between(double low, double high, const std::string& unit);
  [[nodiscard]] bool holds(double value) const;
};

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
  std::optional<int> optional_integer(std::string_view key, int low, int high);
  /// Reads true or false; false if the key is missing.
  bool flag(std::string_view key);
  std::string text(std::string_view key);
  std::optional<std::string> optional_text(std::string_view key);
  int integer(std::string_view key, int low, int high);
  /// Reads one of `allowed`.
  std::string choice(std::string_view key, const std::vector<std::string>& allowed);
  /// Reads a value of an enumeration by its name in Choices.
  template <Chosen Value>
  Value choice(std::string_view key) {
    return from_name<Value>(choice(key, names<Value>()));
  }
  template <Chosen Value>
  std::optional<Value> optional_choice(std::string_view key) {
    if (find(key) == nullptr) return std::nullopt;
    return choice<Value>(key);
  }
  Eigen::Vector3d vector(std::string_view key, Dimension dimension);
  std::optional<Eigen::Vector3d> optional_vector(std::string_view key, Dimension dimension);
  /// Reads one number y, which means [0, y], or a pair [x, y].
  std::optional<Eigen::Vector2d> optional_pair(std::string_view key, Dimension dimension);
  /// Reads one number, a pair, or one to `most` rows of two numbers each: [[x, y], ..]. Empty
  /// without the key.
  std::vector<Eigen::Vector2d> pairs(std::string_view key, Dimension dimension, std::size_t most);
  /// Reads three numbers, or two to `most` rows of three.
  std::vector<Eigen::Vector3d> vectors(std::string_view key, Dimension dimension, std::size_t most);
  /// Reads two to `most` rows of three lengths, which become columns; or of six numbers in every
  /// row, a point and a vector at it.
  Eigen::MatrixXd points(std::string_view key, std::size_t most);
  /// Reads three rows of three numbers each.
  std::optional<Eigen::Matrix3d> optional_rows(std::string_view key);
  /// Reads a quaternion as it is written, of any norm.
  std::optional<Eigen::Quaterniond> optional_quaternion(std::string_view key);
  std::optional<StrictTable> optional_table(std::string_view key);
  StrictTable table(std::string_view key);
  /// Returns the tables of [[key]], in order.
  std::vector<StrictTable> tables(std::string_view key);
  [[nodiscard]] bool is_table(std::string_view key) const;
  [[nodiscard]] bool is_text(std::string_view key) const;
  [[nodiscard]] bool is_flag(std::string_view key) const;
  [[nodiscard]] bool is_array(std::string_view key) const;
  [[nodiscard]] std::vector<std::string> keys() const;

  /// Checks that the table has only allowed keys; their values are not checked. It is called before
  /// a key is read, so that a message names a misspelt key rather than the key that is missing
  /// because of it.
  /// @throws InputError that names the first key that is not allowed
  void only(const std::vector<std::string>& allowed) const;

  /// Checks that every key was read.
  /// @throws InputError that names the first key that was not read, and the allowed keys
  void finish() const;

  /// Returns "file:line" of this table.
  [[nodiscard]] std::string where() const { return where(nullptr); }

  /// Throws an InputError "file:line: key = value: problem", without " = value" if the key is
  /// missing or a table.
  [[noreturn]] void fail(std::string_view key, const std::string& problem) const;

 private:
  const toml::node* find(std::string_view key);
  const toml::node& need(std::string_view key);
  [[nodiscard]] std::string where(const toml::node* node) const;
  [[nodiscard]] std::string name(std::string_view key) const;
  [[nodiscard]] double read_number(std::string_view key, const toml::node& node,
                                   Dimension dimension) const;
  /// Reads an array of `Size` numbers. @param form  required form in a message
  template <int Size>
  [[nodiscard]] Eigen::Vector<double, Size> read_numbers(std::string_view key,
                                                         const toml::node& node,
                                                         Dimension dimension,
                                                         const char* form) const;

  const toml::table& table_;
  std::string path_;
  std::string file_;
  std::set<std::string, std::less<>> known_;
};

/// Largest size of a TOML text [bytes]. A scene of ten thousand loads has a tenth of it; the parsed
/// text takes about fifty times its size.
inline constexpr std::size_t largest_toml = std::size_t{1} << 22;

/// Parses a file's text.
/// @throws InputError with file, line and the parser's message, or if the text is larger than
/// largest_toml or nested deeper than deepest_nesting
[[nodiscard]] toml::table parse_toml(const std::string& text, const std::string& file);

/// A table of a scene file and its possible keys.
struct SceneTable {
  std::string name;  ///< "rod", "gripper"; "" for the file itself, "material" for a rod's own
  std::vector<std::string> keys;  ///< in alphabetical order
};

/// Returns all tables of a scene file except those of poses.
[[nodiscard]] const std::vector<SceneTable>& scene_tables();

/// Returns the possible keys of a table. @throws std::out_of_range for an unknown name
[[nodiscard]] const std::vector<std::string>& scene_keys(std::string_view table);

}  // namespace dlo::compare
