#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace dlo::compare {

/// A shape from another program or a camera: points along a rod, in any frame, at any spacing, from
/// either end; parts of the rod may be missing.
struct MeasuredShape {
  std::string file;         ///< name of the file, for messages
  Eigen::Matrix3Xd points;  ///< in the file's order [m], 3 x M, neighbours distinct
  /// Arc lengths in the file, increasing or decreasing [m], M; empty if not given.
  std::vector<double> arc_length;
  /// Unit first directors of the rod's frames at the points, 3 x M; empty if not given.
  Eigen::Matrix3Xd d1 = {};
  std::vector<std::string> notes = {};  ///< how the file was interpreted, for people
  double unit = 1;                      ///< unit of the coordinates in the file [m]
};

/// Largest number of points of a shape file.
inline constexpr long most_shape_points = 100'000;

/// Reads a shape; the format is recognised from the content.
///     CSV: x,y or x,y,z or x,y,z,s per line, or any order of these under a header with their names
///          (s: arc length, in the unit of the points, or in metres if it would otherwise span less
///          than a fifth of the polyline). Fields are separated by commas, or else by semicolons,
///          tabs or blanks; blank lines and lines that begin with # are skipped. A header may also
///          have d1_x, d1_y, d1_z. A table of nodes has node,x,y,z per line and other columns,
///          which are ignored: under a header with these names (or id, index or point for node), or
///          without one if the first column contains the nodes' numbers (distinct integers; in a
///          table of four columns counted from 0 or 1, with a fourth column that is no arc length).
///     JSON: [[x, y, z], ...], or an object with `points_m` and, if known, `arc_length_m` as `dlo
///          solve` writes it, which needs the unit 1; or `points` in the unit that is given, with
///          `arc_length` as s; `d1`, vectors as points.
///     VTK: legacy, ASCII, DATASET POLYDATA with POINTS and one polyline in LINES (or several that
///          follow on from each other); without LINES the points in their order. The point data
///          arc_length_m of a FIELD, as `dlo solve` writes it; such a file is in metres. Its d1.
///     NumPy: an array M x 2 or M x 3; of frames x M x 2 or frames x M x 3 the frame at
///          FILE.npy:INDEX, from 0 or, negative, from the end.
/// Without z, z is zero.
/// @param file  name of the file, for messages and to choose a frame of an array
/// @param unit  unit of the file's numbers [m]
/// @throws InputError that names file, line (point, in JSON), what is wrong and what is allowed: 2
/// to most_shape_points points, all finite and within 1e6 m, neighbours distinct, s strictly
/// increasing or decreasing and in one of the two units, d1 of norm 1 within 1e-3, and
/// perpendicular to the chords within 5 degrees plus the angle between adjacent chords
[[nodiscard]] MeasuredShape parse_shape(const std::string& text, const std::string& file,
                                        double unit = 1);

/// Checks a shape from a program's own numbers by the rules for files, and returns it.
/// @param points  [m], 3 x M;  @param arc_length  increasing or decreasing [m], M; or empty
/// @param name  name of the shape in messages;  @param d1  3 x M; or empty
/// @throws InputError as parse_shape
[[nodiscard]] MeasuredShape shape_of(
    const Eigen::Ref<const Eigen::Matrix3Xd>& points, const std::vector<double>& arc_length,
    const std::string& name, const Eigen::Ref<const Eigen::Matrix3Xd>& d1 = Eigen::Matrix3Xd());

/// Returns the file of a shape's name: the name without :INDEX, unless a file has the whole name.
[[nodiscard]] std::string file_of_shape(const std::string& name);

/// Reads a shape file. @param path  a file, or FILE.npy:INDEX for a frame of its array
/// @throws InputError as parse_shape, or if it cannot be read
[[nodiscard]] MeasuredShape load_shape(const std::string& path, double unit = 1);

}  // namespace dlo::compare
