#pragma once

#include <filesystem>
#include <string>

#include "figure/layout.hpp"

namespace dlo::compare {

/// Returns the version that the installed gnuplot reports; empty if there is none.
/// @param folder  private working directory
[[nodiscard]] std::string gnuplot_version(const std::filesystem::path& folder);

/// Runs a script in its folder, where it writes a picture file.
/// @return one line that states why the file was not drawn; empty on success
[[nodiscard]] std::string run_script(const std::string& script, const std::string& output,
                                     const std::filesystem::path& folder);

/// Returns an SVG file as an element of a page: without prolog, with a title.
/// @param name  prefix of all identifiers, unique in the page
/// @throws std::invalid_argument if there is no svg element
[[nodiscard]] std::string inline_svg(const std::string& svg, const std::string& name,
                                     const std::string& title);

enum class PictureFormat { svg, png, pdf };

/// File extensions, in the order of PictureFormat.
inline constexpr const char* picture_extensions[] = {".svg", ".png", ".pdf"};

/// Returns the script that draws a picture. It contains all titles and numbers.
[[nodiscard]] std::string picture_script(const Picture& picture, PictureFormat format,
                                         const std::string& output);

}  // namespace dlo::compare
