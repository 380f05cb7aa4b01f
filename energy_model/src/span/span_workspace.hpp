#pragma once

#include <memory>
#include <vector>

#include "newton/newton.hpp"
#include "strain/span_energy.hpp"

namespace dlo::energy_model {

/// Buffers that survive a solve: models that no solution holds any more are used again.
class SpanWorkspace {
 public:
  [[nodiscard]] std::shared_ptr<SpanEnergy> model(const Span& span, int terms);
  [[nodiscard]] NewtonBuffers& newton() { return newton_; }
  [[nodiscard]] NewtonFactors& factors() { return newton_.factors; }

 private:
  std::vector<std::shared_ptr<SpanEnergy>> models_;
  NewtonBuffers newton_;
};

}  // namespace dlo::energy_model
