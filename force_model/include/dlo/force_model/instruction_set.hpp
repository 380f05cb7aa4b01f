#pragma once

#include <string_view>
#include <vector>

namespace dlo::force_model {

/// Instruction sets for which the step kernel is compiled. The results of two sets differ by
/// rounding.
enum class InstructionSet {
  baseline,  ///< available on every processor of the platform (x86-64: SSE2)
  avx2,      ///< x86-64 with AVX2 and FMA: four numbers at a time
  avx512,    ///< x86-64 with AVX-512 F, DQ and VL: eight numbers at a time
};

/// Returns the name of an instruction set for people: "baseline", "AVX2" or "AVX-512".
[[nodiscard]] const char* to_string(InstructionSet set);

/// Returns the sets that this machine can run, the fastest last.
[[nodiscard]] std::vector<InstructionSet> available_instruction_sets();

/// Returns the set with a name: "baseline", "avx2" or "avx512".
/// @throws std::invalid_argument naming the value and the sets that this machine has
[[nodiscard]] InstructionSet instruction_set_named(std::string_view name);

/// Returns the fastest set or, for tests and to compare machines, the one that the environment
/// variable DLO_INSTRUCTION_SET names. The variable is read once; if it is empty, it counts as not
/// set.
/// @throws std::invalid_argument as instruction_set_named
[[nodiscard]] InstructionSet fastest_instruction_set();

}  // namespace dlo::force_model
