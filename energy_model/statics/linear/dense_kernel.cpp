#include "linear/dense_kernel.hpp"

#include "linear/kernel_factor.hpp"
#include "linear/kernel_frames.hpp"
#include "linear/kernel_products.hpp"

// This file is compiled once for each instruction set, and DLO_KERNEL names the namespace (see
// CMakeLists.txt). It must not call inline functions of a library that another file might compile
// too, unless the compiler certainly inlines them: the linker keeps one copy of such a function,
// possibly one with instructions that the machine lacks. The headers of its parts are for this file
// alone.

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
