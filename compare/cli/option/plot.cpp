#include "option/plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <optional>

#include "base/input_file.hpp"
#include "base/output_file.hpp"
#include "base/temporary_path.hpp"
#include "dlo/compare/error.hpp"
#include "figure/gnuplot.hpp"

namespace dlo::cli {
namespace {

namespace fs = std::filesystem;

compare::TemporaryFolder drawing_folder(const std::string& option) {
  return compare::TemporaryFolder(
      option + ": no folder to draw in: " + compare::temporary_directory().string());
}

std::optional<compare::PictureFormat> format_of(const std::string& file) {
  const auto* const found =
      std::ranges::find(compare::picture_extensions, fs::path(file).extension().string());
  if (found == std::end(compare::picture_extensions)) return std::nullopt;
  return static_cast<compare::PictureFormat>(found - std::begin(compare::picture_extensions));
}

/// Returns a picture drawn by gnuplot, as the content of its file.
/// @throws compare::OutputError naming `option`
std::string drawn_picture(const compare::Picture& picture, compare::PictureFormat format,
                          const std::string& option) {
  if (std::all_of(picture.rows.begin(), picture.rows.end(),
                  [](const compare::PictureRow& row) { return row.empty(); })) {
    throw compare::OutputError(option + ": there is nothing to draw");
  }
  const compare::TemporaryFolder folder = drawing_folder(option);
  const std::string output =
      std::string("plot") + compare::picture_extensions[static_cast<std::size_t>(format)];
  compare::write_file(folder.path() / "plot.gp", compare::picture_script(picture, format, output));
  const std::string failure = compare::run_script("plot.gp", output, folder.path());
  if (!failure.empty()) throw compare::OutputError(option + ": " + failure);
  return compare::read_file((folder.path() / output).string());
}

}  // namespace

void PlotOptions::require_drawable() const {
  if (!draws()) return;
  if (!format_of(file_)) {
    throw compare::InputError(
        fmt::format("--plot {}: a picture of unknown format (allowed: a file that ends with .svg, "
                    ".png or .pdf)",
                    file_));
  }
  if (compare::gnuplot_version(drawing_folder("--plot").path()).empty()) {
    throw compare::InputError(fmt::format(
        "--plot {}: needs the program gnuplot, which is not found (Debian: gnuplot-nox)", file_));
  }
}

void PlotOptions::draw(const std::function<compare::Picture()>& picture) const {
  if (!draws()) return;
  compare::write_file(file_, drawn_picture(picture(), *format_of(file_), "--plot " + file_));
}

std::vector<compare::PagePicture> page_pictures(const compare::Picture& picture,
                                                const std::string& name,
                                                const std::string& option) {
  std::vector<compare::PagePicture> pictures;
  for (const compare::PictureRow& row : picture.rows) {
    for (const std::vector<compare::Figure>& column : row) {
      for (const compare::Figure& figure : column) {
        compare::PagePicture& drawn = pictures.emplace_back();
        try {
          const std::string svg =
              drawn_picture({{{{figure}}}}, compare::PictureFormat::svg, option);
          drawn.svg =
              compare::inline_svg(svg, fmt::format("{}-{}", name, pictures.size()), figure.title);
        } catch (const compare::OutputError& error) {
          drawn.failure = error.what();
        }
      }
    }
  }
  return pictures;
}

}  // namespace dlo::cli
