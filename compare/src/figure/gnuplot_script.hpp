#pragma once

#include <string>

#include "figure/layout.hpp"

namespace dlo::compare {

/// The endings of files that a picture can be drawn into.
enum class PictureFormat { svg, png, pdf };

/// A text as a gnuplot string that nothing in it can end or run.
[[nodiscard]] std::string gnuplot_string(const std::string& text);

/// The script that draws a picture with its figures' titles, numbers and all.
[[nodiscard]] std::string picture_script(const Picture& picture, PictureFormat format,
                                         const std::string& output);

}  // namespace dlo::compare
