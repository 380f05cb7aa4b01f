#include "linear/dense_products.hpp"

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

const DenseKernel& dense_kernel() {
#if defined(__x86_64__)
  static const bool runs_avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  static const bool runs_avx512 = runs_avx2 && __builtin_cpu_supports("avx512f") &&
                                  __builtin_cpu_supports("avx512dq") &&
                                  __builtin_cpu_supports("avx512vl");
  if (runs_avx512) return kernel_avx512::dense_kernel();
  if (runs_avx2) return kernel_avx2::dense_kernel();
#endif
  return kernel_baseline::dense_kernel();
}

}  // namespace dlo::energy_model
