#pragma once

#include <string>
#include <vector>

namespace dlo::compare {

/// Files that a scene's file names for reading beside itself, as `trajectory` and `rest_shape`:
/// paths as the scene's reader opens them. None of what is no regular file or no TOML, which its
/// reader says better.
[[nodiscard]] std::vector<std::string> trajectory_files(const std::string& scene_file);

/// Where the file is that a scene names: relative to the scene's folder.
[[nodiscard]] std::string path_beside(const std::string& name, const std::string& scene_file);

}  // namespace dlo::compare
