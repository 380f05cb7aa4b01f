#pragma once

#include <string>

namespace dlo::compare {

/// What the names of a series' frames begin with: "rod" of rod.vtk.series.
[[nodiscard]] std::string series_stem(const std::string& series);

/// Whether a file is one that --paraview may write beside the series file, whatever its name or
/// links: one of any number, because how many there are is known only at the end.
[[nodiscard]] bool is_frame_of_series(const std::string& file, const std::string& series);

/// What the frames are called, for messages: "rod_00000.vtk, .." of rod.vtk.series.
[[nodiscard]] std::string frame_names(const std::string& series);

}  // namespace dlo::compare
