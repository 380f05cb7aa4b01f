#include "dlo/compare/result_text.hpp"

#include "dlo/compare/plan.hpp"
#include "format/json.hpp"
#include "format/result_output.hpp"

namespace dlo::compare {

std::string to_text(const CheckResult& result) {
  return cli::shape_check_document({result}).text();
}
std::string to_text(const Calibration& result) { return cli::material_document(result).text(); }
std::string to_text(const ForceModelFit& result) {
  return cli::force_model_document(result, true).text();
}
std::string to_text(const Comparison& result) { return cli::comparison_text(result); }
std::string to_text(const Solution& result, const Scene& scene) {
  return cli::solution_text(result, scene);
}

std::string to_json(const CheckResult& result) {
  return cli::json_text(cli::shape_check_document({result}).json);
}
std::string to_json(const Calibration& result) {
  return cli::json_text(cli::material_document(result).json);
}
std::string to_json(const ForceModelFit& result) {
  return cli::json_text(cli::force_model_document(result, true).json);
}
std::string to_json(const Comparison& result) {
  return cli::json_text(cli::comparisons_json({result}));
}
std::string to_json(const Solution& result, const Scene& scene) {
  return cli::json_text(cli::solution_json(result, scene, make_plan(scene)));
}

}  // namespace dlo::compare
