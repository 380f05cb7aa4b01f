#include "batch/read_sweep.hpp"

#include <fmt/format.h>

#include <regex>

#include "base/number.hpp"
#include "dlo/compare/error.hpp"

namespace dlo::compare {
namespace {

/// More than any first line of a sweep has: the stack that a match takes grows with the line.
constexpr std::size_t longest_head = 400;

}  // namespace

std::string SweepHead::line() const {
  return fmt::format("# dlo sweep 1: {}; shard {}; {} rows from {} of {}\n", identity, shard,
                     range.last - range.first, range.first, rows);
}

std::optional<SweepHead> parse_sweep_head(const std::string& line) {
  // Numbers of at most 16 digits, so that sums do not overflow.
  static const std::regex form(
      "# dlo sweep 1: (scene [0-9a-f]{16}, grid [0-9a-f]{16}, model [a-z-]+, options "
      "[0-9a-f]{16}); "
      "shard ([0-9]{1,16}/[0-9]{1,16}); "
      "([0-9]{1,16}) rows from ([0-9]{1,16}) of ([0-9]{1,16})");
  std::smatch parts;
  if (line.size() > longest_head || !std::regex_match(line, parts, form)) return std::nullopt;
  const auto number = [&](std::size_t part) { return *as_number<std::int64_t>(parts[part].str()); };
  const std::int64_t rows = number(3);
  SweepHead head{parts[1], parts[2], {number(4), number(4)}, number(5)};
  if (head.range.first > head.rows || rows > head.rows - head.range.first) return std::nullopt;
  head.range.last += rows;
  return head;
}

LineReader::LineReader(const std::string& path) : path_(path), file_(path) {}

bool LineReader::next(std::string& line) {
  std::size_t end = text_.find('\n', begin_);
  while (!ended_ && end == std::string::npos) {
    if (text_.size() - begin_ > longest_line) {
      throw InputError(fmt::format("{}:{}: the line is too long (allowed: {} characters)", path_,
                                   number_ + 1, longest_line));
    }
    text_.erase(0, begin_);
    begin_ = 0;
    const std::size_t known = text_.size();
    ended_ = !file_.read_some(text_, longest_line);
    end = text_.find('\n', known);
  }
  if (end == std::string::npos) {
    line = text_.substr(begin_);
    torn_ = !line.empty();
    return false;
  }
  line = text_.substr(begin_, end - begin_);
  begin_ = end + 1;
  bytes_ += static_cast<std::int64_t>(line.size()) + 1;
  ++number_;
  return true;
}

std::int64_t fields_of(std::string_view line) {
  std::int64_t fields = 1;
  bool quoted = false;
  for (const char c : line) {
    if (c == '"') quoted = !quoted;
    if (c == ',' && !quoted) ++fields;
  }
  return fields;
}

bool row_is_whole(std::string_view line, std::string_view start, std::int64_t fields) {
  if (!line.starts_with(start) || fields_of(line) != fields) return false;
  if (row_is_ok(line)) return true;
  // Without results only a status is left, which says why.
  const auto empty = static_cast<std::size_t>(fields - fields_of(start));
  line.remove_prefix(start.size());
  return line.size() > empty && line.starts_with(std::string(empty, ','));
}

bool row_is_ok(std::string_view line) {
  constexpr std::string_view status = ",ok";
  return line.size() >= status.size() && line.substr(line.size() - status.size()) == status;
}

}  // namespace dlo::compare
