#include "trajectory/trajectory_files.hpp"

#include <filesystem>
#include <optional>
#include <system_error>

#include "base/input_file.hpp"
#include "dlo/compare/error.hpp"
#include "toml/strict_table.hpp"

namespace dlo::compare {
namespace {

std::optional<toml::table> document_of(const std::string& file) {
  std::error_code unknown;
  // A pipe can be read once only.
  if (!std::filesystem::is_regular_file(file, unknown)) return std::nullopt;
  try {
    return parse_toml(read_file(file), file);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

}  // namespace

std::string path_beside(const std::string& name, const std::string& scene_file) {
  return (std::filesystem::path(scene_file).parent_path() / name).string();
}

std::vector<std::string> trajectory_files(const std::string& scene_file) {
  const std::optional<toml::table> document = document_of(scene_file);
  std::vector<std::string> files;
  if (!document) return files;
  for (const auto& points : {(*document)["rod"]["rest_shape"].value_exact<std::string>(),
                             (*document)["track"]["start"].value_exact<std::string>()}) {
    if (points) files.push_back(path_beside(*points, scene_file));
  }
  for (const char* moving : {"gripper", "obstacle"}) {
    const toml::array* tables = (*document)[moving].as_array();
    if (tables == nullptr) continue;
    for (const toml::node& node : *tables) {
      const toml::table* table = node.as_table();
      if (table == nullptr) continue;
      const auto name = (*table)["trajectory"].value_exact<std::string>();
      if (name) files.push_back(path_beside(*name, scene_file));
    }
  }
  return files;
}

}  // namespace dlo::compare
