#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include "base/quote.hpp"
#include "base/text.hpp"
#include "figure/gnuplot.hpp"

namespace dlo::compare {
namespace {

constexpr const char* zero_width_space = "\xe2\x80\x8b";

/// Returns a text as a gnuplot string that is quoted so that its content cannot end it or be
/// executed.
std::string gnuplot_string(const std::string& text) {
  // gnuplot writes texts into CDATA sections of the SVG, which "]]>" would end.
  const std::string shown =
      replace_placeholders(xml_text(text), {{"]]>", fmt::format("]]{}>", zero_width_space)}});
  // In single quotes an apostrophe has to be doubled, which gnuplot misreads at the beginning of a
  // string, and a backtick runs a command. Octal escapes in double quotes avoid both.
  if (shown.find_first_of("'`") == std::string::npos) return "'" + shown + "'";
  return "\"" +
         replace_placeholders(shown,
                              {{"'", "\\047"}, {"`", "\\140"}, {"\"", "\\042"}, {"\\", "\\134"}}) +
         "\"";
}

constexpr int title_line_pixels = 22;

/// Divides a title between words into lines that fit above a figure: of at most 50 bytes, unless a
/// word is longer.
std::vector<std::string> title_lines(const std::string& title) {
  constexpr std::size_t most = 50;
  std::vector<std::string> lines = {""};
  for (std::size_t at = 0; at < title.size();) {
    const std::size_t end = std::min(title.find(' ', at), title.size());
    const std::string word = title.substr(at, end - at);
    at = end + 1;
    if (!lines.back().empty() && lines.back().size() + 1 + word.size() > most) lines.emplace_back();
    if (!lines.back().empty()) lines.back() += ' ';
    lines.back() += word;
  }
  return lines;
}

/// Returns the height of a panel [pixels]; that of the first panel includes the figure's title.
int height_of(const Figure& figure, std::size_t panel) {
  const int title =
      panel > 0 ? 0 : title_line_pixels * static_cast<int>(title_lines(figure.title).size());
  return title + laid_out(figure.panels[panel]).full_height();
}

int height_of(const Figure& figure) {
  int height = 0;
  for (std::size_t i = 0; i < figure.panels.size(); ++i) height += height_of(figure, i);
  return height;
}

int height_of(const std::vector<Figure>& column) {
  int height = 0;
  for (const Figure& figure : column) height += height_of(figure);
  return height;
}

int height_of(const PictureRow& row) {
  int height = 0;
  for (const std::vector<Figure>& column : row) height = std::max(height, height_of(column));
  return height;
}

/// gnuplot's point types of the marks, in the order of Mark.
constexpr int point_types[] = {0, 2, 4, 5, 6, 7, 8, 10, 12};

std::string style_of(const CurveStyle& look) {
  const std::string colour = fmt::format("linecolor rgb '{}'", look.colour);
  const bool has_line = look.width > 0;
  if (!look.fill.empty()) {
    return fmt::format("with filledcurves closed fillstyle solid 1 {} fillcolor rgb '{}'",
                       has_line ? "border " + colour : "noborder", look.fill);
  }
  const std::string line = has_line ? fmt::format("linewidth {} dashtype {}", look.width,
                                                  static_cast<int>(look.dashes) + 1)
                                    : std::string();
  const std::string marks =
      look.mark != Mark::none
          ? fmt::format("pointtype {} pointsize {}",
                        point_types[static_cast<std::size_t>(look.mark)], look.mark_size)
          : std::string();
  return fmt::format("with {}{} {} {} {}", has_line ? "lines" : "", marks.empty() ? "" : "points",
                     colour, line, marks);
}

/// Size of a picture [pixels].
struct Canvas {
  int width = figure_width;
  int height = 0;
  /// Smaller than other text, so that no title is cut off [pixels in SVG, else points].
  int legend_font = 13;
};

/// Builds a script. gnuplot places tics and legends.
class Script {
 public:
  explicit Script(const Canvas& canvas) : canvas_(canvas) {}

  /// @param left, top  upper left corner of the figure [pixels]
  void add_figure(const Figure& figure, int left, int top) {
    for (std::size_t i = 0; i < figure.panels.size(); ++i) {
      const Panel panel = laid_out(figure.panels[i]);
      const int height = height_of(figure, i);
      add("reset\nset origin {:.6f},{:.6f}\nset size {:.6f},{:.6f}\n",
          static_cast<double>(left) / canvas_.width,
          1 - static_cast<double>(top + height) / canvas_.height,
          static_cast<double>(figure_width) / canvas_.width,
          static_cast<double>(height) / canvas_.height);
      if (i == 0) add_title(figure.title);
      if (panel.equal_aspect) add("set size ratio -1\n");
      add("set grid linecolor rgb '#808080'\n");
      if (panel.has_legend) {
        add("set key below left Left reverse vertical maxcols 1 samplen 2 font ',{}'\n",
            canvas_.legend_font);
      } else {
        add("set key off\n");
      }
      add_axis(panel.x, 'x');
      add_axis(panel.y, 'y');
      add_texts(panel);
      add_plot(panel);
      top += height;
    }
  }
  [[nodiscard]] const std::string& text() const { return out_; }

 private:
  template <typename... Arguments>
  void add(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    fmt::format_to(std::back_inserter(out_), format, std::forward<Arguments>(arguments)...);
  }

  void add_title(const std::string& title) {
    std::vector<std::string> lines = title_lines(title);
    for (std::string& line : lines) line = gnuplot_string(line);
    add("set title {}\n", fmt::join(lines, R"(."\n".)"));
  }

  void add_axis(const PlotAxis& axis, char name) {
    add("set {}label {}\n", name, gnuplot_string(axis.label));
    if (axis.logarithmic) add("set logscale {}\n", name);
    add("set {}range [{:.10g}:{:.10g}]\nset {}tics nomirror\n", name, *axis.from, *axis.to, name);
    if (!axis.tics) return;
    std::vector<std::string> tics;
    for (const Tic& tic : *axis.tics) {
      tics.push_back(fmt::format("{} {:.10g}", gnuplot_string(tic.label), tic.at));
    }
    if (tics.empty()) {
      add("unset {}tics\n", name);
    } else {
      add("set {}tics ({})\n", name, fmt::join(tics, ", "));
    }
  }

  void add_texts(const Panel& panel) {
    constexpr int first = 100;
    int number = first;
    for (const Text& text : panel.texts) {
      add("set label {} {} at {:.10g},{:.10g} left front offset screen {:.6f}, screen {:.6f}\n",
          number++, gnuplot_string(text.words), text.x, text.y, text.dx / canvas_.width,
          text.dy / canvas_.height);
    }
  }

  /// Adds a data block. @return its name
  std::string add_numbers(const PlottedCurve& curve) {
    std::string name = fmt::format("$numbers_{}", ++blocks_);
    if (!curve.id.empty()) add("# {}\n", curve.id);
    add("{} << EOD\n", name);
    for (std::size_t i = 0; i < curve.x.size(); ++i) {
      const bool ends = std::isnan(curve.x[i]) || std::isnan(curve.y[i]);
      out_ += ends ? "\n" : csv_number(curve.x[i]) + " " + csv_number(curve.y[i]) + "\n";
    }
    out_ += "EOD\n";
    return name;
  }

  /// Adds boxes with borders in their fill colour, which leaves no gaps between them.
  std::string add_cells(const Cells& cells) {
    const std::string name = fmt::format("$numbers_{}", ++blocks_);
    const auto [least, most] = cells.range();
    add("{} << EOD\n", name);
    const std::size_t columns = cells.x.size() - 1;
    for (std::size_t i = 0; i < cells.values.size(); ++i) {
      if (std::isnan(cells.values[i])) continue;
      const std::size_t row = i / columns;
      const std::size_t column = i % columns;
      add("{} {} {} {} {} {} {}\n", csv_number(cells.x[column]), csv_number(cells.y[row]),
          csv_number(cells.x[column]), csv_number(cells.x[column + 1]), csv_number(cells.y[row]),
          csv_number(cells.y[row + 1]), csv_number(cells.values[i]));
    }
    const double spread = most > least ? most - least : std::max(1e-9, std::abs(least));
    add("EOD\nset palette defined (0 '{}', 0.5 '{}', 1 '{}')\nset cbrange [{:.10g}:{:.10g}]\n",
        cell_colours[0], cell_colours[1], cell_colours[2], least, least + spread);
    return fmt::format(
        "{} using 1:2:3:4:5:6:7 notitle with boxxyerror fillstyle solid 1 border linewidth 0.5 "
        "linecolor palette",
        name);
  }

  void add_plot(const Panel& panel) {
    std::vector<std::string> plots;
    if (panel.cells && panel.cells->range().first <= panel.cells->range().second) {
      plots.push_back(add_cells(*panel.cells));
    }
    for (const PlottedCurve& curve : panel.curves) {
      const std::string title =
          panel.shows_title(curve) ? "title " + gnuplot_string(curve.title) : "notitle";
      plots.push_back(fmt::format("{} {} {}", add_numbers(curve), title, style_of(curve.look)));
    }
    if (plots.empty()) plots.emplace_back("NaN notitle");
    add("plot {}\n", fmt::join(plots, ", \\\n  "));
  }

  Canvas canvas_;
  std::string out_;
  int blocks_ = 0;
};

/// Returns the terminal command, with sizes such that all formats look like the SVG. In PDF a pixel
/// is 0.75 points, a line of width 1 is half a point wide, and cairo's symbols are half as large.
/// Line ends are round, because cairo begins wide lines with a spike otherwise.
std::string terminal(PictureFormat format, const Canvas& canvas) {
  switch (format) {
    case PictureFormat::svg:
      return fmt::format(
          "set terminal svg size {},{} noenhanced font 'sans-serif,16' rounded linewidth 1.3 "
          "background "
          "'#ffffff'\n",
          canvas.width, canvas.height);
    case PictureFormat::png:  // twice the resolution, for screens and print
      return fmt::format(
          "set terminal pngcairo size {},{} noenhanced font 'sans-serif,12' fontscale 2 rounded "
          "linewidth "
          "2.6 pointscale 4 background '#ffffff'\n",
          2 * canvas.width, 2 * canvas.height);
    case PictureFormat::pdf:  // 96 pixels per inch
      return fmt::format(
          "set terminal pdfcairo size {:.4f}in,{:.4f}in noenhanced font 'sans-serif,12' fontscale "
          "0.75 rounded linewidth 1.95 pointscale 1.5 background '#ffffff'\n",
          canvas.width / 96.0, canvas.height / 96.0);
  }
  return {};
}

}  // namespace

std::string picture_script(const Picture& picture, PictureFormat format,
                           const std::string& output) {
  // Text of 16 pixels in SVG corresponds to 12 points in the other formats.
  Canvas canvas{.legend_font = format == PictureFormat::svg ? 13 : 10};
  for (const PictureRow& row : picture.rows) {
    canvas.width = std::max(canvas.width, figure_width * static_cast<int>(row.size()));
    canvas.height += height_of(row);
  }
  Script script(canvas);
  int top = 0;
  for (const PictureRow& row : picture.rows) {
    int left = 0;
    for (const std::vector<Figure>& column : row) {
      int below = top;
      for (const Figure& figure : column) {
        script.add_figure(figure, left, below);
        below += height_of(figure);
      }
      left += figure_width;
    }
    top += height_of(row);
  }
  return terminal(format, canvas) + "set encoding utf8\nset output " + gnuplot_string(output) +
         "\nset multiplot\n" + script.text() + "unset multiplot\n";
}

}  // namespace dlo::compare
