#pragma once

#include <vector>

namespace dlo::force_model {

/// Instructions that the step kernel is compiled for. The results of two sets differ by rounding.
enum class InstructionSet {
  baseline,  ///< what every processor of the platform has (x86-64: SSE2)
  avx2,      ///< x86-64 with AVX2 and FMA: four numbers at a time
  avx512,    ///< x86-64 with AVX-512 F, DQ and VL: eight numbers at a time
};

/// Its name.
[[nodiscard]] const char* to_string(InstructionSet set);

/// Those that this machine can run, the fastest last.
[[nodiscard]] std::vector<InstructionSet> available_instruction_sets();

/// The fastest of them.
[[nodiscard]] InstructionSet fastest_instruction_set();

}  // namespace dlo::force_model
