#include <fmt/format.h>

#include "reading/read_scene.hpp"

#define XXH_INLINE_ALL  // header-only, nothing to link
#include <xxhash.h>

namespace dlo::compare {

std::string fingerprint(const std::string& text) {
  return fmt::format("{:016x}", XXH3_64bits(text.data(), text.size()));
}

}  // namespace dlo::compare
