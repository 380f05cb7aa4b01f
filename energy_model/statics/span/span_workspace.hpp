#pragma once

#include <memory>

#include "base/pool.hpp"
#include "newton/newton.hpp"
#include "strain/span_energy.hpp"
#include "strain/span_solution.hpp"

namespace dlo::energy_model {

/// Buffers that are kept from one solve to the next: models that no solution holds any more are
/// reused.
class SpanWorkspace {
 public:
  [[nodiscard]] std::shared_ptr<SpanEnergy> model(const Span& span, int terms);
  /// Returns a solution with a model but without unknowns.
  [[nodiscard]] SpanSolution empty_solution(const Span& span, int terms);
  /// Returns a solution's unknowns with another number of coefficients; not an equilibrium yet.
  [[nodiscard]] SpanSolution with_terms(const SpanSolution& solution, int terms);
  [[nodiscard]] NewtonBuffers& newton() { return newton_; }
  [[nodiscard]] NewtonFactors& factors() { return newton_.factors; }

 private:
  Pool<SpanEnergy> models_;
  NewtonBuffers newton_;
};

}  // namespace dlo::energy_model
