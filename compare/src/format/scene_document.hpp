#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "dlo/compare/scene.hpp"

namespace dlo::compare {

/// Returns a scene as it was read, in SI units, with all derived quantities, for programs that know
/// neither TOML nor materials (schema dlo/scene/1, described in doc/protocol.md). Quantities that
/// the scene does not have are null; `drag` is missing without drag. `force_model` contains the
/// polygon of discretise(), or in `refused` the reason why there is none.
[[nodiscard]] nlohmann::ordered_json scene_document(const Scene& scene);

/// Returns the part of the document about the rod's layers; null without layers.
[[nodiscard]] nlohmann::ordered_json layers_document(const Scene& scene);
/// Returns the part about the points of the rest shape; null without a rest shape.
[[nodiscard]] nlohmann::ordered_json rest_shape_document(const Scene& scene);

/// Returns that document as text: invalid UTF-8 in a name becomes U+FFFD.
[[nodiscard]] std::string scene_document_text(const Scene& scene);

}  // namespace dlo::compare
