#include "span/span_workspace.hpp"

namespace dlo::energy_model {

std::shared_ptr<SpanEnergy> SpanWorkspace::model(const Span& span, int terms) {
  std::shared_ptr<SpanEnergy> model =
      models_.take([terms](const SpanEnergy& kept) { return kept.terms() == terms; });
  model->reset(span, terms);
  return model;
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
