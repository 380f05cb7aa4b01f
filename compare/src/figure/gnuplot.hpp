#pragma once

#include <filesystem>
#include <string>

#include "figure/layout.hpp"

namespace dlo::compare {

/// Version of the gnuplot that would draw, as it says it; empty if there is none.
/// @param folder  where nobody else has files, to run it in
[[nodiscard]] std::string gnuplot_version(const std::filesystem::path& folder);

/// Runs a script in the folder of its CSV files, where it draws a file.
/// @return why not, in one line; empty if it is drawn
[[nodiscard]] std::string run_script(const std::string& script, const std::string& output,
                                     const std::filesystem::path& folder);

/// Returns an SVG file as an element of a page: without prolog, with a title.
/// @param name  begins all identifiers, unique in the page
/// @throws std::invalid_argument if there is no svg element
[[nodiscard]] std::string inline_svg(const std::string& svg, const std::string& name,
                                     const std::string& title);

/// The endings of files that a picture can be drawn into.
enum class PictureFormat { svg, png, pdf };

/// A text as a gnuplot string that nothing in it can end or run.
[[nodiscard]] std::string gnuplot_string(const std::string& text);

/// The script that draws a picture with its figures' titles, numbers and all.
[[nodiscard]] std::string picture_script(const Picture& picture, PictureFormat format,
                                         const std::string& output);

}  // namespace dlo::compare
