#include "linear/dense_products.hpp"

#include <array>
#include <cstdlib>
#include <stdexcept>
#include <string>

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

struct KernelOfSet {
  std::string_view name;
  const DenseKernel* kernel = nullptr;  ///< null if this machine cannot run the set
};

/// Lists the instruction sets, the fastest last; the first one is always available.
std::array<KernelOfSet, 3> kernels() {
  const DenseKernel* avx2 = nullptr;
  const DenseKernel* avx512 = nullptr;
#if defined(__x86_64__)
  const bool runs_avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  const bool runs_avx512 = runs_avx2 && __builtin_cpu_supports("avx512f") &&
                           __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl");
  if (runs_avx2) avx2 = &kernel_avx2::dense_kernel();
  if (runs_avx512) avx512 = &kernel_avx512::dense_kernel();
#endif
  return {{{"baseline", &kernel_baseline::dense_kernel()}, {"avx2", avx2}, {"avx512", avx512}}};
}

}  // namespace

const DenseKernel& dense_kernel_named(std::string_view name) {
  std::string allowed;
  for (const KernelOfSet& set : kernels()) {
    if (set.kernel == nullptr) continue;
    if (name == set.name) return *set.kernel;
    if (!allowed.empty()) allowed += ", ";
    allowed += set.name;
  }
  throw std::invalid_argument("dense_kernel_named: " + std::string(variable) + " = " +
                              std::string(name) + ", must be one that this machine has (" +
                              allowed + ")");
}

const DenseKernel& dense_kernel() {
  static const DenseKernel& chosen = []() -> const DenseKernel& {
    const char* name = std::getenv(variable);
    if (name != nullptr && *name != '\0') return dense_kernel_named(name);
    const DenseKernel* fastest = nullptr;
    for (const KernelOfSet& set : kernels()) {
      if (set.kernel != nullptr) fastest = set.kernel;
    }
    return *fastest;
  }();
  return chosen;
}

}  // namespace dlo::energy_model
