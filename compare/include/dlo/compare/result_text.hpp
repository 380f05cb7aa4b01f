#pragma once

#include <string>

#include "dlo/compare/check.hpp"
#include "dlo/compare/comparison.hpp"
#include "dlo/compare/force_model_fit.hpp"
#include "dlo/compare/material_fit.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/solution.hpp"

namespace dlo::compare {

/// A result as `dlo` shows it: of `dlo check`.
[[nodiscard]] std::string to_text(const CheckResult& result);
/// Of `dlo calibrate --shape`.
[[nodiscard]] std::string to_text(const Calibration& result);
/// Of `dlo calibrate` of scenes alone, whose target counts as asked for.
[[nodiscard]] std::string to_text(const ForceModelFit& result);
/// Of `dlo compare`.
[[nodiscard]] std::string to_text(const Comparison& result);
/// Of `dlo solve`. @param scene  that was solved
[[nodiscard]] std::string to_text(const Solution& result, const Scene& scene);

/// A result as the document of the same command with `--format json`.
[[nodiscard]] std::string to_json(const CheckResult& result);
/// The same of a calibration.
[[nodiscard]] std::string to_json(const Calibration& result);
/// The same of the force model's.
[[nodiscard]] std::string to_json(const ForceModelFit& result);
/// The same of a comparison.
[[nodiscard]] std::string to_json(const Comparison& result);
/// The same of a shape, with the scene's plan, which costs as much as some ten solves.
[[nodiscard]] std::string to_json(const Solution& result, const Scene& scene);

}  // namespace dlo::compare
