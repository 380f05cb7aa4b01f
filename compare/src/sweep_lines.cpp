#include "sweep_lines.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <regex>

#include "dlo/compare/error.hpp"

namespace dlo::compare {

std::string SweepHead::line() const {
  return fmt::format("# dlo sweep 1: {}; shard {}; {} rows from {} of {}\n", identity, shard,
                     range.last - range.first, range.first, rows);
}

std::optional<SweepHead> parse_sweep_head(const std::string& line) {
  static const std::regex pattern(
      "# dlo sweep 1: (scene [0-9a-f]{16}, grid [0-9a-f]{16}, model [a-z-]+, options [0-9a-f]{16}); "
      "shard ([0-9]{1,10}/[0-9]{1,10}); ([0-9]{1,16}) rows from ([0-9]{1,16}) of ([0-9]{1,16})");
  std::smatch part;
  if (!std::regex_match(line, part, pattern)) return std::nullopt;
  const std::int64_t first = std::stoll(part[4]);
  SweepHead head{part[1], part[2], {first, first + std::stoll(part[3])}, std::stoll(part[5])};
  if (head.range.last > head.rows) return std::nullopt;
  return head;
}

LineReader::LineReader(const std::string& path) : stream_(path, std::ios::binary) {
  errno = 0;
  if (!stream_ || (stream_.peek() == std::ifstream::traits_type::eof() && errno != 0)) {
    throw InputError(fmt::format("{}: cannot be read ({})", path,
                                 errno != 0 ? std::strerror(errno) : "no such file"));
  }
  stream_.clear();
}

bool LineReader::next(std::string& line) {
  if (torn_ || !std::getline(stream_, line)) return false;
  torn_ = stream_.eof();
  if (torn_) return false;
  bytes_ += static_cast<std::int64_t>(line.size()) + 1;
  ++number_;
  return true;
}

bool row_is_ok(std::string_view line) {
  constexpr std::string_view status = ",ok";
  return line.size() >= status.size() && line.substr(line.size() - status.size()) == status;
}

}  // namespace dlo::compare
