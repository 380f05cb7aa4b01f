#include "linear/dense_kernel.hpp"

#include "linear/kernel_factor.hpp"
#include "linear/kernel_frames.hpp"
#include "linear/kernel_products.hpp"

// Compiled once for each instruction set, DLO_KERNEL naming the namespace (see CMakeLists.txt).
// Nothing inline from a library that another file might compile too may be used in here but what
// the compiler is sure to inline: of such a function the linker keeps one copy, perhaps one with
// instructions that the machine lacks. The headers of its parts are for this file alone.

namespace dlo::energy_model::DLO_KERNEL {

const DenseKernel& dense_kernel() {
  static constexpr DenseKernel kernel = {multiply,
                                         multiply_symmetric,
                                         multiply_by_two_strains,
                                         multiply_by_conjugate,
                                         add_product,
                                         factor,
                                         solve,
                                         reflect,
                                         turn,
                                         add_weighed};
  return kernel;
}

}  // namespace dlo::energy_model::DLO_KERNEL
