// Fuzz target of one reader, DLO_READER.

#include <cstddef>
#include <cstdint>
#include <string>

#include "readers.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  dlo::fuzz::DLO_READER(std::string(data, data + size));
  return 0;
}
