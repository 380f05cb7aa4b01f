#include "span/span_workspace.hpp"

#include <algorithm>

namespace dlo::energy_model {
namespace {

/// Models that are kept for as many terms each.
constexpr std::size_t most_kept_models = 8;

}  // namespace

std::shared_ptr<SpanEnergy> SpanWorkspace::model(const Span& span, int terms) {
  const auto is_unused = [](const auto& model) { return model.use_count() == 1; };
  auto unused = std::find_if(models_.begin(), models_.end(), [&](const auto& model) {
    return is_unused(model) && model->terms() == terms;
  });
  // Another one has buffers of another size.
  if (unused == models_.end() && models_.size() >= most_kept_models) {
    unused = std::find_if(models_.begin(), models_.end(), is_unused);
  }
  if (unused != models_.end()) {
    (*unused)->reset(span, terms);
    return *unused;
  }
  models_.push_back(std::make_shared<SpanEnergy>(span, terms));
  return models_.back();
}

SpanSolution SpanWorkspace::empty_solution(const Span& span, int terms) {
  SpanSolution solution;
  solution.model = model(span, terms);
  solution.terms = terms;
  return solution;
}

SpanSolution SpanWorkspace::with_terms(const SpanSolution& solution, int terms) {
  SpanSolution other = empty_solution(solution.model->span(), terms);
  other.x = other.model->prolong(*solution.model, solution.x);
  other.multipliers = other.model->prolong_multipliers(*solution.model, solution.multipliers);
  return other;
}

}  // namespace dlo::energy_model
