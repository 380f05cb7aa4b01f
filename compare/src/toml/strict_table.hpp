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

/// What a number may be, with the words for a message.
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

/// A TOML table that is read strictly: every key has to be asked for before finish(), every value
/// has to be of its kind and in its range. All errors are InputErrors of the form
/// "file:line: key = value: what is wrong (allowed: ...)".
class StrictTable {
 public:
  StrictTable(const toml::table& table, std::string path, std::string file);

  [[nodiscard]] bool has(std::string_view key) const { return table_.contains(key); }

  /// A number in SI units, or a string with a unit. @throws InputError if missing or wrong
  double number(std::string_view key, Dimension dimension, const Range& range);
  std::optional<double> optional_number(std::string_view key, Dimension dimension,
                                        const Range& range);
  std::optional<int> optional_integer(std::string_view key, int low, int high);
  /// true or false; false where there is no such key.
  bool flag(std::string_view key);
  std::string text(std::string_view key);
  std::optional<std::string> optional_text(std::string_view key);
  int integer(std::string_view key, int low, int high);
  /// One of `allowed`.
  std::string choice(std::string_view key, const std::vector<std::string>& allowed);
  /// Of an enumeration with a table of names.
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
  /// One number y, which is [0, y], or [x, y].
  std::optional<Eigen::Vector2d> optional_pair(std::string_view key, Dimension dimension);
  /// The same, or rows of two numbers each, one to `most` of them: [[x, y], ..]. None: no key.
  std::vector<Eigen::Vector2d> pairs(std::string_view key, Dimension dimension, std::size_t most);
  /// Three numbers, or rows of three, two to `most` of them.
  std::vector<Eigen::Vector3d> vectors(std::string_view key, Dimension dimension, std::size_t most);
  /// Columns of two to `most` rows of three lengths; or of six numbers in every row, a vector
  /// beside each point.
  Eigen::MatrixXd points(std::string_view key, std::size_t most);
  /// Rows of three numbers each.
  std::optional<Eigen::Matrix3d> optional_rows(std::string_view key);
  /// As it is written, of any norm.
  std::optional<Eigen::Quaterniond> optional_quaternion(std::string_view key);
  std::optional<StrictTable> optional_table(std::string_view key);
  StrictTable table(std::string_view key);
  /// The tables of [[key]], in order.
  std::vector<StrictTable> tables(std::string_view key);
  [[nodiscard]] bool is_table(std::string_view key) const;
  [[nodiscard]] bool is_text(std::string_view key) const;
  [[nodiscard]] bool is_flag(std::string_view key) const;
  [[nodiscard]] bool is_array(std::string_view key) const;
  [[nodiscard]] std::vector<std::string> keys() const;

  /// All that the table may have, in any of its forms. Called before a key is read, so that a wrong
  /// key is named rather than the one that is missing because of it.
  /// @throws InputError naming the first key that is not among them
  void only(const std::vector<std::string>& allowed) const;

  /// @throws InputError naming the first key that nobody asked for and the keys that exist
  void finish() const;

  /// "file:line" of this table
  [[nodiscard]] std::string where() const { return where(nullptr); }

  /// "file:line: key = value: problem"
  [[noreturn]] void fail(std::string_view key, const std::string& problem) const;

 private:
  const toml::node* find(std::string_view key);
  const toml::node& need(std::string_view key);
  [[nodiscard]] std::string where(const toml::node* node) const;
  [[nodiscard]] std::string name(std::string_view key) const;
  [[nodiscard]] double read_number(std::string_view key, const toml::node& node,
                                   Dimension dimension) const;
  /// An array of `Size` numbers. @param form  what a message says it must be
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

/// A scene of ten thousand loads has a tenth of it; parsed it takes some fifty times its size.
inline constexpr std::size_t largest_toml = std::size_t{1} << 22;

/// Parses a file's text. @throws InputError with file, line and what the parser says, or if the
/// text is larger than largest_toml or nested deeper than deepest_nesting
[[nodiscard]] toml::table parse_toml(const std::string& text, const std::string& file);

/// A table of a scene file and what it may have.
struct SceneTable {
  std::string name;  ///< "rod", "gripper"; "" of the file itself, "material" of a rod's own
  std::vector<std::string> keys;  ///< by the alphabet
};

/// All tables of a scene file but those of poses.
[[nodiscard]] const std::vector<SceneTable>& scene_tables();

/// What one of them may have. @throws std::out_of_range for another name
[[nodiscard]] const std::vector<std::string>& scene_keys(std::string_view table);

}  // namespace dlo::compare
