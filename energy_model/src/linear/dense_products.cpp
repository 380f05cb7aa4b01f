#include "linear/dense_products.hpp"

#include <cstdlib>
#include <stdexcept>
#include <string>
#include <vector>

namespace dlo::energy_model {

// One for each time that dense_kernel.cpp is compiled.
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

struct KernelOfSet {
  std::string_view name;
  const DenseKernel& kernel;
};

/// Of the sets that this machine has, the fastest last.
std::vector<KernelOfSet> available_kernels() {
  std::vector<KernelOfSet> kernels = {{"baseline", kernel_baseline::dense_kernel()}};
#if defined(__x86_64__)
  const bool runs_avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  const bool runs_avx512 = runs_avx2 && __builtin_cpu_supports("avx512f") &&
                           __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl");
  if (runs_avx2) kernels.push_back({"avx2", kernel_avx2::dense_kernel()});
  if (runs_avx512) kernels.push_back({"avx512", kernel_avx512::dense_kernel()});
#endif
  return kernels;
}

}  // namespace

const DenseKernel& dense_kernel_named(std::string_view name) {
  std::string allowed;
  for (const KernelOfSet& set : available_kernels()) {
    if (name == set.name) return set.kernel;
    allowed += (allowed.empty() ? "" : ", ") + std::string(set.name);
  }
  throw std::invalid_argument("dense_kernel_named: " + std::string(variable) + " = " +
                              std::string(name) + ", must be one that this machine has (" +
                              allowed + ")");
}

const DenseKernel& dense_kernel() {
  static const DenseKernel& chosen = []() -> const DenseKernel& {
    const char* name = std::getenv(variable);
    const bool given = name != nullptr && *name != '\0';
    return given ? dense_kernel_named(name) : available_kernels().back().kernel;
  }();
  return chosen;
}

}  // namespace dlo::energy_model
