#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "dlo/compare/scene.hpp"

namespace dlo::compare {

/// A scene as it was read, in SI units, with every quantity that follows from it: what a program
/// needs that knows neither TOML nor materials (schema dlo/scene/1, described in doc/protocol.md).
/// What the scene does not have, or does not say, is null. `force_model` has the polygon of
/// discretise(), or in `refused` why there is none.
[[nodiscard]] nlohmann::ordered_json scene_document(const Scene& scene);

/// What it says of a rod's layers, and of the points of its rest shape; null without.
[[nodiscard]] nlohmann::ordered_json layers_document(const Scene& scene);
[[nodiscard]] nlohmann::ordered_json rest_shape_document(const Scene& scene);  ///< as above

/// That document as text: what is no UTF-8 in a name becomes U+FFFD.
[[nodiscard]] std::string scene_document_text(const Scene& scene);

}  // namespace dlo::compare
