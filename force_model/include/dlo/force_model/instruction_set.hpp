#pragma once

#include <string_view>
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

/// One of them by its name: "baseline", "avx2" or "avx512".
/// @throws std::invalid_argument naming the value and those that this machine has
[[nodiscard]] InstructionSet instruction_set_named(std::string_view name);

/// The fastest of them or, for tests and to compare machines, the one that the environment variable
/// DLO_INSTRUCTION_SET names, which is read once; empty, it counts as not set.
/// @throws std::invalid_argument as instruction_set_named
[[nodiscard]] InstructionSet fastest_instruction_set();

}  // namespace dlo::force_model
