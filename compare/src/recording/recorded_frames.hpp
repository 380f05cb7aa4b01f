#pragma once

#include <string>

#include "trajectory/read_markers.hpp"

namespace dlo::compare {

/// A recorded motion of any kind, as positions on the rod by time.
///     CSV: markers, as parse_markers() takes them.
///     FILE.vtk.series: as `dlo track --paraview` and ParaView write it, JSON with the names and
///     times of polylines beside it (legacy ASCII VTK).
///     FILE.npz: NumPy's archive of arrays, t of T times [s], points of T x n x 3 or T x n x 2
///     coordinates [m], and where it is known s of the n points' arc lengths [m].
///     A folder: the one FILE.vtk.series in it, else its *.vtk by name, each with "t = 0.1 s" in
///     its title.
/// Frames without arc lengths begin at the rod's first end; theirs are along the polyline, over the
/// rod's length.
/// @param length  of the rod [m]
/// @throws InputError naming file, line, what is wrong and what is allowed
[[nodiscard]] MarkerMotion load_recording(const std::string& path, double length);

/// The same of the content of a file that is no series. @param file  its name, for messages
[[nodiscard]] MarkerMotion parse_recording(const std::string& text, const std::string& file,
                                           double length);

}  // namespace dlo::compare
