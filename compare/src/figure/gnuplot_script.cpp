#include "figure/gnuplot_script.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include "base/quote.hpp"

namespace dlo::compare {
namespace {

constexpr const char* zero_width_space = "\xe2\x80\x8b";

constexpr int title_line_pixels = 22;
constexpr int title_margin = 14;

int height_of(const Figure& figure) {
  int height = 0;
  for (const Panel& panel : figure.panels) height += laid_out(panel).full_height();
  return height;
}

/// A title in lines that fit above a figure.
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

int titled_height(const Figure& figure) {
  return title_margin + title_line_pixels * static_cast<int>(title_lines(figure.title).size()) +
         height_of(figure);
}

int height_of(const std::vector<Figure>& column) {
  int height = 0;
  for (const Figure& figure : column) height += titled_height(figure);
  return height;
}

int height_of(const PictureRow& row) {
  int height = 0;
  for (const std::vector<Figure>& column : row) height = std::max(height, height_of(column));
  return height;
}

/// gnuplot's numbers of the marks, in their order.
constexpr int point_types[] = {0, 2, 4, 5, 6, 7, 8, 10, 12};

std::string line_style(const Look& look) {
  return fmt::format("linewidth {} dashtype {}", look.width, static_cast<int>(look.dashes) + 1);
}

std::string mark_style(const Look& look) {
  return fmt::format("pointtype {} pointsize {}", point_types[static_cast<std::size_t>(look.mark)],
                     look.mark_size);
}

std::string fill_style(const Look& look) {
  return fmt::format("fillstyle solid 1 {} fillcolor rgb '{}'",
                     look.width > 0 ? fmt::format("border linecolor rgb '{}'", look.colour)
                                    : std::string("noborder"),
                     look.fill);
}

std::string style_of(const Look& look) {
  if (!look.fill.empty()) return "with filledcurves closed " + fill_style(look);
  const bool has_line = look.width > 0;
  const bool has_marks = look.mark != Mark::none;
  return fmt::format("with {}{} linecolor rgb '{}' {} {}", has_line ? "lines" : "",
                     has_marks ? "points" : "", look.colour, has_line ? line_style(look) : "",
                     has_marks ? mark_style(look) : "");
}

/// Places on a canvas, from its top left corner [pixels], as gnuplot counts them.
struct Canvas {
  int width = figure_width;
  int height = 0;

  [[nodiscard]] double x(double pixels) const { return pixels / width; }
  [[nodiscard]] double y(double pixels) const { return 1 - pixels / height; }
};

/// A script in the making.
class Script {
 public:
  explicit Script(const Canvas& canvas) : canvas_(canvas) {}

  /// @param left, top  its place on the canvas [pixels]
  void add_panels(const Figure& figure, double left, double top, const std::string& title = {}) {
    std::string first = title;
    for (const Panel& described : figure.panels) {
      const Panel panel = laid_out(described);
      add_frame(panel, left, top);
      out_ += first;
      first.clear();
      add_axis(panel.x, 'x');
      add_axis(panel.y, 'y');
      add_texts(panel);
      add_plot(panel, left, top);
      top += panel.full_height();
    }
  }
  [[nodiscard]] std::string title(const Figure& figure, double left, double top) const {
    // In a multiplot a label is drawn with the plot after it.
    int number = 10;
    std::string out;
    for (const std::string& line : title_lines(figure.title)) {
      top += title_line_pixels;
      fmt::format_to(std::back_inserter(out), "set label {} {} at screen {:.6f},{:.6f} left\n",
                     number++, gnuplot_string(line), canvas_.x(left + from_the_left),
                     canvas_.y(top + title_margin - title_line_pixels / 2.0));
    }
    return out;
  }
  [[nodiscard]] const std::string& text() const { return out_; }

 private:
  static constexpr double from_the_left = 8;  // [pixels]

  template <typename... Arguments>
  void add(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    fmt::format_to(std::back_inserter(out_), format, std::forward<Arguments>(arguments)...);
  }

  void add_frame(const Panel& panel, double left, double top) {
    constexpr double above = 20;
    const double plot_top = top + top_margin;
    const double plot_bottom = plot_top + panel.height;
    add("reset\n"
        "set key off\n"
        "set grid linecolor rgb '#808080'\n"
        "set lmargin at screen {:.6f}\n"
        "set rmargin at screen {:.6f}\n"
        "set tmargin at screen {:.6f}\n"
        "set bmargin at screen {:.6f}\n",
        canvas_.x(left + panel.left), canvas_.x(left + panel.left + panel.width()),
        canvas_.y(plot_top), canvas_.y(plot_bottom));
    add_legend(panel, left, top + panel.legend_top());
    // The upright axis's name stands level above it, where no number is in its way.
    add("set xlabel {}\nset label 1 {} at screen {:.6f},{:.6f} left\n",
        gnuplot_string(panel.x.label), gnuplot_string(panel.y.label),
        canvas_.x(left + from_the_left), canvas_.y(plot_top - above));
    if (panel.equal_aspect) {
      add("# equal aspect: {:.6g} pixels a metre on both axes\n",
          panel.width() / (*panel.x.to - *panel.x.from));
    }
  }

  /// Drawn as it is laid out: gnuplot's own key breaks into columns where a plot is flat, onto what
  /// is beside it.
  void add_legend(const Panel& panel, double left, double top) {
    constexpr double sample = 30;
    constexpr double gap = 10;
    int number = 1000;
    const double from = left + from_the_left;
    double at = top + key_row_pixels / 2.0;
    for (const PlottedCurve& curve : panel.curves) {
      if (!panel.has_legend || curve.title.empty()) continue;
      const Look& look = curve.look;
      const auto place = [&](double right, double down) {
        return fmt::format("screen {:.6f},{:.6f}", canvas_.x(from + right), canvas_.y(at + down));
      };
      ++number;
      constexpr double thick = 5;
      if (!look.fill.empty()) {
        add("set object {} rectangle from {} to {} {}\n", number, place(0, -thick),
            place(sample, thick), fill_style(look));
      } else if (look.width > 0) {
        add("set arrow {} from {} to {} nohead linecolor rgb '{}' {}\n", number, place(0, 0),
            place(sample, 0), look.colour, line_style(look));
      }
      if (look.mark != Mark::none) {
        add("set label {} '' at {} point linecolor rgb '{}' {}\n", number, place(sample / 2, 0),
            look.colour, mark_style(look));
      }
      add("set label {} {} at {} left\n", number + 1000, gnuplot_string(curve.title),
          place(sample + gap, 0));
      at += key_row_pixels;
    }
  }

  void add_axis(const PlotAxis& axis, char name) {
    if (axis.logarithmic) add("set logscale {}\n", name);
    add("set {}range [{:.10g}:{:.10g}]\nunset {}tics\n", name, *axis.from, *axis.to, name);
    std::vector<std::string> tics;
    for (const Tic& tic : *axis.tics) {
      tics.push_back(fmt::format("{} {:.10g}", gnuplot_string(tic.label), tic.at));
    }
    if (!tics.empty()) add("set {}tics nomirror ({})\n", name, fmt::join(tics, ", "));
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

  /// A block of numbers. @return its name
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

  /// Boxes with borders of their own colour, which leave no stripes between them.
  std::string add_cells(const Cells& cells, const Panel& panel, double left, double top) {
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
    const bool differ = most > least;
    const double spread = differ ? most - least : std::max(1e-9, std::abs(least));
    add("EOD\nset palette defined (0 '{}', 0.5 '{}', 1 '{}')\nset cbrange [{:.10g}:{:.10g}]\n"
        "set cbtics ('{:.3g}' {:.10g}",
        cell_colours[0], cell_colours[1], cell_colours[2], least, least + spread, least, least);
    if (differ) add(", '{0:.3g}' {0:.10g}, '{1:.3g}' {1:.10g}", (least + most) / 2, most);
    const double bottom = top + top_margin + panel.height + axis_pixels;
    constexpr double bar = 12;
    constexpr double inset = 24;  // for half of the numbers at its ends
    add(")\nset colorbox user horizontal origin screen {:.6f},{:.6f} size screen {:.6f},{:.6f}\n",
        canvas_.x(left + panel.left + inset), canvas_.y(bottom + bar),
        canvas_.x(panel.width() - 2 * inset), bar / canvas_.height);
    return fmt::format(
        "{} using 1:2:3:4:5:6:7 notitle with boxxyerror fillstyle solid 1 border linewidth 0.5 "
        "linecolor palette",
        name);
  }

  void add_plot(const Panel& panel, double left, double top) {
    std::vector<std::string> plots;
    if (panel.cells && panel.cells->range().first <= panel.cells->range().second) {
      plots.push_back(add_cells(*panel.cells, panel, left, top));
    }
    for (const PlottedCurve& curve : panel.curves) {
      const std::string numbers = add_numbers(curve);
      plots.push_back(numbers + " notitle " + style_of(curve.look));
    }
    if (plots.empty()) plots.emplace_back("NaN notitle");
    add("plot {}\n", fmt::join(plots, ", \\\n  "));
  }

  Canvas canvas_;
  std::string out_;
  int blocks_ = 0;
};

/// The same picture in every format, as the SVG has it: in PDF a pixel is 0.75 points, and a line
/// of width 1 half a point; cairo's symbols are half as large. Its ends are round: where they are
/// not, cairo begins wide lines with a spike.
std::string terminal(PictureFormat format, const Canvas& canvas) {
  switch (format) {
    case PictureFormat::svg:
      return fmt::format(
          "set terminal svg size {},{} noenhanced font 'sans-serif,16' rounded linewidth 1.3 "
          "background "
          "'#ffffff'\n",
          canvas.width, canvas.height);
    case PictureFormat::png:  // twice as fine, for screens and print
      return fmt::format(
          "set terminal pngcairo size {},{} noenhanced font 'sans-serif,12' fontscale 2 rounded "
          "linewidth "
          "2.6 pointscale 4 background '#ffffff'\n",
          2 * canvas.width, 2 * canvas.height);
    case PictureFormat::pdf:  // 96 pixels an inch
      return fmt::format(
          "set terminal pdfcairo size {:.4f}in,{:.4f}in noenhanced font 'sans-serif,12' fontscale "
          "0.75 rounded linewidth 1.95 pointscale 1.5 background '#ffffff'\n",
          canvas.width / 96.0, canvas.height / 96.0);
  }
  return {};
}

std::string whole_script(const std::string& head, const std::string& output, const Script& script) {
  return head + "set encoding utf8\nset output " + gnuplot_string(output) + "\nset multiplot\n" +
         script.text() + "unset multiplot\n";
}

}  // namespace

std::string gnuplot_string(const std::string& text) {
  // gnuplot writes texts into an SVG's CDATA sections, which "]]>" would end.
  std::string shown = xml_text(text);
  for (std::size_t at = 0; (at = shown.find("]]>", at)) != std::string::npos;) {
    shown.insert(at + 2, zero_width_space);
  }
  // In single quotes an apostrophe is doubled, which gnuplot mistakes at the beginning; and a
  // backtick runs a command. As octal numbers in double quotes neither is seen before it is drawn.
  if (shown.find_first_of("'`") == std::string::npos) return "'" + shown + "'";
  std::string result = "\"";
  for (const char c : shown) {
    const bool special = c == '\'' || c == '`' || c == '"' || c == '\\';
    result += special ? fmt::format("\\{:03o}", static_cast<unsigned>(c)) : std::string(1, c);
  }
  return result + "\"";
}

std::string figure_script(const Figure& figure) {
  const Canvas canvas{.height = height_of(figure)};
  Script script(canvas);
  script.add_panels(figure, 0, 0);
  const std::string head = fmt::format(
      "# gnuplot {0}.gp draws {0}.svg; its numbers are in {1}, too\n"
      "set terminal svg size {2},{3} dynamic noenhanced font 'sans-serif,16' rounded linewidth "
      "1.3\n",
      figure.name, figure.csv_file, canvas.width, canvas.height);
  return whole_script(head, figure.name + ".svg", script);
}

std::string picture_script(const Picture& picture, PictureFormat format,
                           const std::string& output) {
  Canvas canvas;
  for (const PictureRow& row : picture.rows) {
    canvas.width = std::max(canvas.width, figure_width * static_cast<int>(row.size()));
    canvas.height += height_of(row);
  }
  Script script(canvas);
  double top = 0;
  for (const PictureRow& row : picture.rows) {
    double left = 0;
    for (const std::vector<Figure>& column : row) {
      double below = top;
      for (const Figure& figure : column) {
        const int height = titled_height(figure);
        script.add_panels(figure, left, below + height - height_of(figure),
                          script.title(figure, left, below));
        below += height;
      }
      left += figure_width;
    }
    top += height_of(row);
  }
  return whole_script(terminal(format, canvas), output, script);
}

}  // namespace dlo::compare
