#pragma once

#include <string>

namespace dlo::compare {

/// Returns the path of a file that a scene names, which is relative to the scene's folder.
[[nodiscard]] std::string path_beside(const std::string& name, const std::string& scene_file);

/// Returns the beginning of the names of a series' frames: "rod" of rod.vtk.series.
[[nodiscard]] std::string series_stem(const std::string& series);

/// Whether a file, by its name or through links, may be one of the frames that --paraview writes
/// next to the series file. Frames of any number count, because the number of frames is known only
/// at the end.
[[nodiscard]] bool is_frame_of_series(const std::string& file, const std::string& series);

/// Returns the names of the frames for messages: "rod_00000.vtk, .." of rod.vtk.series.
[[nodiscard]] std::string frame_names(const std::string& series);

}  // namespace dlo::compare
