#pragma once

#include <string>

#include "dlo/compare/check.hpp"
#include "dlo/compare/comparison.hpp"
#include "dlo/compare/force_model_fit.hpp"
#include "dlo/compare/material_fit.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/solution.hpp"

namespace dlo::compare {

/// Returns the text that `dlo check` prints.
[[nodiscard]] std::string to_text(const CheckResult& result);
/// Returns the text that `dlo calibrate --shape` prints.
[[nodiscard]] std::string to_text(const Calibration& result);
/// Returns the text that `dlo calibrate` of scenes alone prints; the target counts as given by the
/// user.
[[nodiscard]] std::string to_text(const ForceModelFit& result);
/// Returns the text that `dlo compare` prints.
[[nodiscard]] std::string to_text(const Comparison& result);
/// Returns the text that `dlo solve` prints. @param scene  scene that was solved
[[nodiscard]] std::string to_text(const Solution& result, const Scene& scene);

/// Returns the document that `dlo check --format json` prints.
[[nodiscard]] std::string to_json(const CheckResult& result);
/// Returns the document that `dlo calibrate --shape` prints with `--format json`.
[[nodiscard]] std::string to_json(const Calibration& result);
/// Returns the document that `dlo calibrate` of scenes alone prints with `--format json`.
[[nodiscard]] std::string to_json(const ForceModelFit& result);
/// Returns the document that `dlo compare --format json` prints.
[[nodiscard]] std::string to_json(const Comparison& result);
/// Returns the document that `dlo solve --format json` prints, with the scene's plan, which costs
/// as much as about ten solves.
[[nodiscard]] std::string to_json(const Solution& result, const Scene& scene);

}  // namespace dlo::compare
