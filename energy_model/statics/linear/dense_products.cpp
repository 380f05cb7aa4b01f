#include "linear/dense_products.hpp"

#include <cstdlib>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace dlo::energy_model {

// dense_kernel.cpp is compiled once for each of these namespaces.
namespace kernel_baseline {
const DenseKernel& dense_kernel();
}
#if defined(__x86_64__)
namespace kernel_avx2 {
const DenseKernel& dense_kernel();
}
namespace kernel_avx512 {
const DenseKernel& dense_kernel();
}
#endif

namespace {

constexpr const char* variable = "DLO_INSTRUCTION_SET";

/// Lists the instruction sets of this machine, the fastest last.
std::vector<std::pair<std::string_view, const DenseKernel*>> kernels() {
  std::vector<std::pair<std::string_view, const DenseKernel*>> result = {
      {"baseline", &kernel_baseline::dense_kernel()}};
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {
    result.emplace_back("avx2", &kernel_avx2::dense_kernel());
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
        __builtin_cpu_supports("avx512vl")) {
      result.emplace_back("avx512", &kernel_avx512::dense_kernel());
    }
  }
#endif
  return result;
}

}  // namespace

const DenseKernel& dense_kernel_named(std::string_view name) {
  std::string allowed;
  for (const auto& [set, kernel] : kernels()) {
    if (name == set) return *kernel;
    allowed += (allowed.empty() ? "" : ", ") + std::string(set);
  }
  throw std::invalid_argument("dense_kernel_named: " + std::string(variable) + " = " +
                              std::string(name) + ", must be one that this machine has (" +
                              allowed + ")");
}

const DenseKernel& dense_kernel() {
  static const DenseKernel& chosen = []() -> const DenseKernel& {
    const char* name = std::getenv(variable);
    if (name != nullptr && *name != '\0') return dense_kernel_named(name);
    return *kernels().back().second;
  }();
  return chosen;
}

}  // namespace dlo::energy_model
