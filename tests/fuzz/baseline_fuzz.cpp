// Any text is a baseline or an InputError of one line; what is read is written back and read again.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>

#include "dlo/compare/baseline.hpp"
#include "dlo/compare/error.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(data, data + size);
  try {
    const auto cases = dlo::compare::read_baseline(text, "fuzz.toml");
    const std::string written = dlo::compare::baseline_text(cases);
    const auto again = dlo::compare::read_baseline(written, "written.toml");
    if (dlo::compare::baseline_text(again) != written) std::abort();
  } catch (const dlo::compare::InputError& error) {
    // What we write ourselves has to be good.
    if (std::strncmp(error.what(), "fuzz.toml", 9) != 0) std::abort();
  }
  return 0;
}
