#pragma once

#include <string>
#include <string_view>
#include <vector>

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
  /// Reads "> 0", ">= 0", "4 to 100", "1e-6 to 1e6 m", "0 to < 1"; any other text is a description
  /// without limits.
  [[nodiscard]] static Range parse(const std::string& text);
  [[nodiscard]] bool holds(double value) const;
};

/// A key of a scene file: a row of scene_keys.txt.
struct SceneKey {
  std::string name;
  std::string value;    ///< form and dimension of its value, for people
  std::string missing;  ///< "required", or the default, for people
  std::string example;  ///< value as in a file
  std::string words;    ///< sentences; empty for most tables
  Range range;          ///< range of each number, or of the number of rows or tables
  Dimension dimension = Dimension::number;
  std::vector<std::string> excludes;  ///< keys of the table that may not be given too
  std::vector<std::string> needs;     ///< keys of the table that have to be given too

  [[nodiscard]] bool required() const { return missing == "required"; }
  /// Returns the allowed values of a choice.
  [[nodiscard]] std::vector<std::string> choices() const;
};

/// A table of a scene file.
struct SceneTable {
  std::string header;  ///< "[rod.helix]", "[[gripper]]"; "[]" for the file itself
  std::string name;    ///< "rod.helix", "gripper"; "" for the file itself
  std::string words;   ///< sentences
  std::vector<SceneKey> keys;
  std::vector<std::string> names;  ///< names of the keys, in alphabetical order

  /// Returns a key by its name. @throws std::out_of_range for an unknown name
  [[nodiscard]] const SceneKey& key(std::string_view name) const;
};

[[nodiscard]] const std::vector<SceneTable>& scene_tables();

/// Returns a table by its name. @throws std::out_of_range for an unknown name
[[nodiscard]] const SceneTable& scene_table(std::string_view name);

}  // namespace dlo::compare
