#include "base/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <sstream>

#include "base/number.hpp"
#include "dlo/compare/error.hpp"

namespace dlo::compare {
namespace {

std::size_t levenshtein(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({replaced, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row.back();
}

constexpr std::string_view three_quotes = "\"\"\"";
constexpr std::string_view three_apostrophes = "'''";

/// Returns the length of the string literal with which `rest` begins. An unterminated literal ends
/// with its line, or with the file; the parser then reports it.
std::size_t toml_string_length(std::string_view rest) {
  const char quote = rest.front();
  const std::string_view three = quote == '"' ? three_quotes : three_apostrophes;
  const bool many_lines = rest.starts_with(three);
  const std::string_view end = many_lines ? three : three.substr(0, 1);
  std::size_t at = end.size();
  while (at < rest.size() && !rest.substr(at).starts_with(end)) {
    if (rest[at] == '\n' && !many_lines) return at;
    at += quote == '"' && rest[at] == '\\' ? 2 : 1;
  }
  at += end.size();
  // Up to two quotes before the three closing ones belong to the string.
  for (int more = 0; many_lines && more < 2 && at < rest.size() && rest[at] == quote; ++more) ++at;
  return std::min(at, rest.size());
}

/// Returns the problem of an unquoted number that no double can represent, which a parser would
/// read as zero or report unclearly; else an empty text.
std::string number_problem(std::string_view rest) {
  if (std::string_view("0123456789+-.").find(rest.front()) == std::string_view::npos) return "";
  std::string number(rest.substr(0, rest.find_first_of(" \t\r\n,]}#=")));
  number.erase(std::remove(number.begin(), number.end(), '_'), number.end());
  const std::string_view digits = std::string_view(number).substr(number.front() == '+' ? 1 : 0);
  const auto [value, length, error] = leading_number<double>(digits);
  const bool beyond = length == digits.size() && error == std::errc::result_out_of_range;
  return beyond ? out_of_range_message(number) : "";
}

}  // namespace

std::string json_string(std::string_view text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string_view trimmed(std::string_view text, std::string_view characters) {
  const std::size_t begin = text.find_first_not_of(characters);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(characters) - begin + 1);
}

std::string valid_utf8(std::string_view text) {
  return nlohmann::json::parse(json_string(text)).get<std::string>();
}

std::string display(std::string_view text) {
  std::string result;
  const std::string valid = valid_utf8(text);
  for (std::size_t i = 0; i < valid.size(); ++i) {
    if (const std::size_t bytes = control_character_length(valid, i); bytes > 0) {
      result += '?';
      i += bytes - 1;
    } else {
      result += valid[i];
    }
  }
  return result;
}

std::size_t control_character_length(std::string_view text, std::size_t at) {
  const auto byte = static_cast<unsigned char>(text[at]);
  if (byte < 0x20 || byte == 0x7f) return 1;
  return byte == 0xc2 && static_cast<unsigned char>(text[at + 1]) < 0xa0 ? 2 : 0;
}

std::string did_you_mean(std::string_view written, const std::vector<std::string>& words) {
  std::string nearest;
  std::size_t least = std::min<std::size_t>(3, (written.size() + 1) / 2);
  for (const std::string& word : words) {
    const std::size_t distance = levenshtein(written, word);
    if (distance >= least) continue;
    least = distance;
    nearest = word;
  }
  return nearest.empty() ? "" : ", did you mean " + nearest + "?";
}

std::string replace_placeholders(
    std::string_view text, const std::vector<std::pair<std::string_view, std::string>>& values) {
  std::string result;
  while (!text.empty()) {
    const auto value = std::find_if(values.begin(), values.end(),
                                    [&](const auto& one) { return text.starts_with(one.first); });
    result += value != values.end() ? std::string_view(value->second) : text.substr(0, 1);
    text.remove_prefix(value != values.end() ? value->first.size() : 1);
  }
  return result;
}

std::string wrap(const std::string& text, std::size_t indent, std::size_t width) {
  std::istringstream words(text);
  std::string out;
  std::size_t column = indent;
  for (std::string word; words >> word;) {
    if (!out.empty() && column + 1 + word.size() > width) {
      out += "\n" + std::string(indent, ' ');
      column = indent;
    } else if (!out.empty()) {
      out += ' ';
      ++column;
    }
    out += word;
    column += word.size();
  }
  return out;
}

void require_toml_limits(std::string_view text, const std::string& file) {
  long line = 1;
  int depth = 0;
  int dots = 0;
  bool begins = true;
  const auto require = [&](bool holds, const char* problem) {
    if (holds) return;
    throw InputError(
        fmt::format("{}:{}: {} (allowed: {} levels)", file, line, problem, deepest_nesting));
  };
  for (std::size_t length = 1; !text.empty(); text.remove_prefix(length)) {
    const char c = text.front();
    length = 1;
    if (const std::string problem = begins ? number_problem(text) : ""; !problem.empty()) {
      throw InputError(fmt::format("{}:{}: {}", file, line, problem));
    }
    begins = std::string_view(" \t\r\n=,[]{}").find(c) != std::string_view::npos;
    if (c == '"' || c == '\'') {
      length = toml_string_length(text);
    } else if (c == '#') {
      length = std::min(text.find('\n'), text.size());
    } else if (c == '.') {
      require(++dots < deepest_nesting, "a key of too many dotted parts");
    } else if (std::string_view("\n=,[]{}").find(c) != std::string_view::npos) {
      dots = 0;
      if (c == '[' || c == '{') ++depth;
      if (c == ']' || c == '}') --depth;
      require(depth <= deepest_nesting, "brackets within brackets");
    }
    line += std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(length), '\n');
  }
}

}  // namespace dlo::compare
