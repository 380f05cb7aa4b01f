#include "batch/read_sweep.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/number.hpp"
#include "dlo/compare/error.hpp"

namespace dlo::compare {
namespace {

/// Takes the parts of a sweep's first line one by one.
class HeadReader {
 public:
  explicit HeadReader(std::string_view line) : line_(line), rest_(line) {}

  bool word(std::string_view expected) {
    if (!rest_.starts_with(expected)) return false;
    rest_.remove_prefix(expected.size());
    return true;
  }

  /// 16 digits of a fingerprint.
  bool hexadecimal() {
    const std::string_view digits = rest_.substr(0, 16);
    rest_.remove_prefix(digits.size());
    return digits.size() == 16 && all_of(digits, "0123456789abcdef");
  }

  /// Of a model.
  bool name() {
    const std::string_view letters = rest_.substr(0, rest_.find(','));
    rest_.remove_prefix(letters.size());
    return !letters.empty() && all_of(letters, "abcdefghijklmnopqrstuvwxyz-");
  }

  /// "2/4"
  bool shard(std::string& text) {
    const std::string_view begin = rest_;
    std::int64_t part = 0;
    if (!number(part) || !word("/") || !number(part)) return false;
    text = begin.substr(0, begin.size() - rest_.size());
    return true;
  }

  /// At most 16 digits, so that sums do not overflow.
  bool number(std::int64_t& value) {
    const std::size_t digits = std::min(rest_.find_first_not_of("0123456789"), rest_.size());
    if (digits == 0 || digits > 16) return false;
    value = leading_number<std::int64_t>(rest_.substr(0, digits)).value;
    rest_.remove_prefix(digits);
    return true;
  }

  /// All that was read behind the `start` of the line.
  bool since(std::string_view start, std::string& text) const {
    text = line_.substr(start.size(), line_.size() - rest_.size() - start.size());
    return true;
  }

  [[nodiscard]] bool at_end() const { return rest_.empty(); }

 private:
  static bool all_of(std::string_view text, std::string_view characters) {
    return text.find_first_not_of(characters) == std::string_view::npos;
  }

  std::string_view line_;
  std::string_view rest_;
};

}  // namespace

std::string SweepHead::line() const {
  return fmt::format("# dlo sweep 1: {}; shard {}; {} rows from {} of {}\n", identity, shard,
                     range.last - range.first, range.first, rows);
}

std::optional<SweepHead> parse_sweep_head(const std::string& line) {
  HeadReader reader(line);
  SweepHead head;
  std::int64_t rows = 0;
  const bool whole = reader.word("# dlo sweep 1: ") && reader.word("scene ") &&
                     reader.hexadecimal() && reader.word(", grid ") && reader.hexadecimal() &&
                     reader.word(", model ") && reader.name() && reader.word(", options ") &&
                     reader.hexadecimal() && reader.since("# dlo sweep 1: ", head.identity) &&
                     reader.word("; shard ") && reader.shard(head.shard) && reader.word("; ") &&
                     reader.number(rows) && reader.word(" rows from ") &&
                     reader.number(head.range.first) && reader.word(" of ") &&
                     reader.number(head.rows) && reader.at_end();
  if (!whole || head.range.first > head.rows || rows > head.rows - head.range.first) {
    return std::nullopt;
  }
  head.range.last = head.range.first + rows;
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
