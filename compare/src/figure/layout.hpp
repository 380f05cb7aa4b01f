#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace dlo::compare {

/// Symbol at the points of a curve.
enum class Mark { none, cross, open_square, square, circle, dot, triangle, down_triangle, diamond };

enum class Dashes { solid, dashed, dotted, dash_dotted, dash_dot_dotted };

struct CurveStyle {
  std::string colour = "#000000";  ///< "#RRGGBB"
  double width = 1;                ///< line width; 0: no line
  Dashes dashes = Dashes::solid;
  Mark mark = Mark::none;
  double mark_size = 1;
  std::string fill;  ///< colour of the area that the line encloses; empty: not filled
};

/// Number of different colours of curves.
inline constexpr std::size_t curve_colours = 6;

/// Returns the style of the i-th curve, with a line and marks. Its colour can be distinguished by
/// colour-blind readers, and its marks differ too. Styles repeat after curve_colours.
[[nodiscard]] CurveStyle curve_style(std::size_t i);

/// Points of one style in a plot. Infinite coordinates are drawn at the plot's edge. At NaN a line
/// is interrupted.
struct PlottedCurve {
  std::string id;     ///< name of the curve in the script
  std::string title;  ///< text in the legend; empty: no entry
  CurveStyle look;
  std::vector<double> x, y;
  std::vector<double> z;  ///< only for a plot in space
};

struct Text {
  double x, y;
  std::string words;
  double dx = 0, dy = 0;  ///< offset of the text's left centre from (x, y) [pixels]
};

/// Values on a rectangular grid, drawn as adjacent rectangles with colours from light to dark.
struct Cells {
  std::vector<double> x, y;    ///< edges of the rectangles, increasing
  std::vector<double> values;  ///< row by row from the lowest; NaN: not drawn

  /// Returns the smallest and the largest finite value; infinity and -infinity if there is none.
  [[nodiscard]] std::pair<double, double> range() const;
};

/// Colours of cells, from the smallest value to the largest.
inline constexpr const char* cell_colours[] = {"#F2F0E6", "#5B9BC8", "#0B2D5B"};

/// Label at a position of an axis.
struct Tic {
  double at;
  std::string label;
};

struct PlotAxis {
  std::string label;
  std::optional<double> from, to;  ///< limits; empty: those of the drawn data, with a margin
  bool logarithmic = false;
  /// No elements: no tics; std::nullopt: chosen by the plotting program.
  std::optional<std::vector<Tic>> tics;
};

/// Plot of a figure. gnuplot or matplotlib chooses its tics and places its legend below it.
struct Panel {
  int height = 330;  ///< height of the plot without axes and legend [pixels]
  PlotAxis x, y;
  std::optional<PlotAxis> z;  ///< only for a plot in space
  int upright = 2;            ///< vertical axis of a plot in space
  std::vector<PlottedCurve> curves;
  std::vector<Text> texts;
  std::optional<Cells> cells;
  bool equal_aspect = false;  ///< whether all axes have the same number of pixels per metre
  bool has_legend = true;     ///< whether the panel has a legend; false if another panel's legend
                              ///< contains the titles of its curves

  /// Whether the legend contains a curve.
  [[nodiscard]] bool shows_title(const PlottedCurve& curve) const {
    return has_legend && !curve.title.empty();
  }
  /// Returns the height of the plot with its axes and legend [pixels].
  [[nodiscard]] int full_height() const;
};

/// Returns a panel as it is drawn: with limits on all axes, infinite coordinates moved to the edge,
/// and without curves of which no point can be drawn: x or y is NaN, or not positive on a
/// logarithmic axis.
[[nodiscard]] Panel laid_out(Panel panel);

/// Figure with plots below each other.
struct Figure {
  std::string title;  ///< one line
  std::vector<Panel> panels;
};

/// Figures next to each other; each column contains figures below each other.
using PictureRow = std::vector<std::vector<Figure>>;

/// Picture in one file: rows of figures below each other.
struct Picture {
  std::vector<PictureRow> rows;
};

/// Width of every figure [pixels], small enough for its text to be read on a page of 375.
inline constexpr int figure_width = 460;
/// Approximate width of a plot in its figure [pixels].
inline constexpr int plot_width = 358;

}  // namespace dlo::compare
