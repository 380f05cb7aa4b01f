// Any text is a scene or an InputError of one line.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>

#include "dlo/compare/error.hpp"
#include "dlo/compare/scene.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(data, data + size);
  try {
    const dlo::compare::Scene scene = dlo::compare::parse_scene(text, "fuzz.toml");
    if (!(scene.gamma() >= 0) || scene.grippers.empty()) std::abort();
  } catch (const dlo::compare::InputError& error) {
    if (std::strncmp(error.what(), "fuzz.toml", 9) != 0) std::abort();
  }
  return 0;
}
