#include "decode/inflate.hpp"

#include <zlib.h>

#include <algorithm>

namespace dlo::compare {

std::optional<std::string> inflated(std::string_view bytes, std::size_t size, Deflated form,
                                    bool part) {
  z_stream stream{};
  if (inflateInit2(&stream, form == Deflated::zlib ? MAX_WBITS : -MAX_WBITS) != Z_OK) {
    return std::nullopt;
  }
  // One byte more tells data that go on. Memory grows with what comes out, not with what is said.
  constexpr std::size_t block = 1 << 16;
  std::string in(bytes);
  std::string out;
  stream.next_in = reinterpret_cast<Bytef*>(in.data());
  stream.avail_in = static_cast<uInt>(in.size());
  int status = Z_OK;
  while (status == Z_OK && out.size() <= size) {
    const std::size_t before = out.size();
    out.resize(std::min(before + block, size + 1));
    stream.next_out = reinterpret_cast<Bytef*>(out.data() + before);
    stream.avail_out = static_cast<uInt>(out.size() - before);
    status = inflate(&stream, Z_NO_FLUSH);
    const std::size_t made = out.size() - before - stream.avail_out;
    out.resize(before + made);
    if (made == 0 && stream.avail_in == 0) break;
  }
  inflateEnd(&stream);
  const bool ended = status == Z_STREAM_END && out.size() == size;
  if (!ended && !(part && out.size() >= size)) return std::nullopt;
  out.resize(size);
  return out;
}

unsigned long crc_of(std::string_view bytes) {
  return crc32(0, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uInt>(bytes.size()));
}

}  // namespace dlo::compare
