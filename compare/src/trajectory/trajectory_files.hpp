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

/// What the names of a series' frames begin with: "rod" of rod.vtk.series.
[[nodiscard]] std::string series_stem(const std::string& series);

/// Whether a file is one that --paraview may write beside the series file, whatever its name or
/// links: one of any number, because how many there are is known only at the end.
[[nodiscard]] bool is_frame_of_series(const std::string& file, const std::string& series);

/// What the frames are called, for messages: "rod_00000.vtk, .." of rod.vtk.series.
[[nodiscard]] std::string frame_names(const std::string& series);

}  // namespace dlo::compare
