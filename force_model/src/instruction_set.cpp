#include "dlo/force_model/instruction_set.hpp"

#include <cstdlib>
#include <stdexcept>
#include <string>

#include "step_kernel.hpp"

namespace dlo::force_model {

using KernelOfSet = const StepKernel& (*)(const KernelChoice& choice, std::ptrdiff_t stride);

// One declaration for each compilation of step_kernel.cpp.
namespace kernel_baseline {
const StepKernel& step_kernel(const KernelChoice& choice, std::ptrdiff_t stride);
}
#if defined(__x86_64__)
namespace kernel_avx2 {
const StepKernel& step_kernel(const KernelChoice& choice, std::ptrdiff_t stride);
}
namespace kernel_avx512 {
const StepKernel& step_kernel(const KernelChoice& choice, std::ptrdiff_t stride);
}
#endif

namespace {

/// Returns the kernel function of a set; null if this machine cannot run the set.
KernelOfSet kernel_of(InstructionSet set) {
  switch (set) {
    case InstructionSet::baseline:
      return kernel_baseline::step_kernel;
#if defined(__x86_64__)
    case InstructionSet::avx2: {
      const bool runs = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
      return runs ? kernel_avx2::step_kernel : nullptr;
    }
    case InstructionSet::avx512: {
      const bool runs = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                        __builtin_cpu_supports("avx512vl");
      return runs ? kernel_avx512::step_kernel : nullptr;
    }
#endif
    default:
      return nullptr;
  }
}

constexpr const char* variable = "DLO_INSTRUCTION_SET";

/// Returns the name of a set as DLO_INSTRUCTION_SET spells it.
const char* name_of(InstructionSet set) {
  switch (set) {
    case InstructionSet::avx2:
      return "avx2";
    case InstructionSet::avx512:
      return "avx512";
    case InstructionSet::baseline:
      break;
  }
  return "baseline";
}

}  // namespace

const char* to_string(InstructionSet set) {
  switch (set) {
    case InstructionSet::avx2:
      return "AVX2";
    case InstructionSet::avx512:
      return "AVX-512";
    case InstructionSet::baseline:
      break;
  }
  return "baseline";
}

std::vector<InstructionSet> available_instruction_sets() {
  std::vector<InstructionSet> sets;
  for (const InstructionSet set :
       {InstructionSet::baseline, InstructionSet::avx2, InstructionSet::avx512}) {
    if (kernel_of(set) != nullptr) sets.push_back(set);
  }
  return sets;
}

InstructionSet instruction_set_named(std::string_view name) {
  std::string allowed;
  for (const InstructionSet set : available_instruction_sets()) {
    if (name == name_of(set)) return set;
    allowed += (allowed.empty() ? "" : ", ") + std::string(name_of(set));
  }
  throw std::invalid_argument("instruction_set_named: " + std::string(variable) + " = " +
                              std::string(name) + ", must be one that this machine has (" +
                              allowed + ")");
}

InstructionSet fastest_instruction_set() {
  static const InstructionSet chosen = [] {
    const char* name = std::getenv(variable);
    const bool given = name != nullptr && *name != '\0';
    return given ? instruction_set_named(name) : available_instruction_sets().back();
  }();
  return chosen;
}

const StepKernel& step_kernel(InstructionSet set, const KernelChoice& choice,
                              std::ptrdiff_t stride) {
  const KernelOfSet kernel = kernel_of(set);
  if (kernel == nullptr) {
    throw std::invalid_argument(std::string("step_kernel: instruction set = ") + to_string(set) +
                                ", must be one that this machine has");
  }
  return kernel(choice, stride);
}

}  // namespace dlo::force_model
