#pragma once

#include <optional>

#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape_check.hpp"
#include "figure/layout.hpp"
#include "figure/series.hpp"

namespace dlo::compare {

/// Points of a file, joined.
[[nodiscard]] Series file_series(const Shape& file);

/// From each point of the rod to the file's. @param rod  at the same arc lengths
[[nodiscard]] Series distance_series(const Shape& file, const Shape& rod);

/// How the worst point or frame is marked.
[[nodiscard]] Look worst_look();

/// Levels of distances in a plot against what is along x: the RMS, and a tolerance. One far above
/// all distances would flatten them: it is then in words only. The plot's axis begins at 0.
/// @param largest_m  of what is drawn;  @param length  of the rod [m]
void add_levels(Panel& panel, double rms_m, std::optional<double> allowed_m, double largest_m,
                double length);

/// What a picture shows of a check's shapes.
[[nodiscard]] Drawing check_drawing(const Scene& scene, const ShapeCheck& check);

/// A measured shape on the rod of its scene, distances as whiskers from the rod to the points, the
/// worst point circled; beside it the distances along the rod.
/// @param allowed_m  a tolerance, drawn as a level
[[nodiscard]] Picture check_picture(const Scene& scene, const ShapeCheck& check,
                                    std::optional<double> allowed_m = std::nullopt);

}  // namespace dlo::compare
