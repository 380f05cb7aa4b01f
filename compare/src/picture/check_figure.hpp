#pragma once

#include <optional>

#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape_check.hpp"
#include "figure/layout.hpp"
#include "figure/series.hpp"

namespace dlo::compare {

/// What a picture shows of a check's shapes.
[[nodiscard]] Drawing check_drawing(const Scene& scene, const ShapeCheck& check);

/// A measured shape on the rod of its scene, distances as whiskers from the rod to the points, the
/// worst point circled; beside it the distances along the rod.
/// @param allowed_m  a tolerance, drawn as a level
[[nodiscard]] Picture check_picture(const Scene& scene, const ShapeCheck& check,
                                    std::optional<double> allowed_m = std::nullopt);

}  // namespace dlo::compare
