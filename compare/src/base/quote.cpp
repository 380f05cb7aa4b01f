#include "base/quote.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/text.hpp"

namespace dlo::compare {

std::string xml_text(const std::string& text) {
  std::string result = valid_utf8(text);
  for (char& c : result) {
    if (static_cast<unsigned char>(c) < ' ' || c == '\x7f') c = ' ';
  }
  return replace_placeholders(result,
                              {{"\xef\xbf\xbe", "\xef\xbf\xbd"}, {"\xef\xbf\xbf", "\xef\xbf\xbd"}});
}

std::string escape_markup(const std::string& text) {
  return replace_placeholders(
      xml_text(text),
      {{"&", "&amp;"}, {"<", "&lt;"}, {">", "&gt;"}, {"\"", "&quot;"}, {"'", "&#39;"}});
}

std::string csv_field(const std::string& text) {
  // Quotes protect a line break within a field, but they do not protect a terminal from control
  // characters.
  std::string field;
  bool quoted = false;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find_first_of(",\"\n\r\t", begin), text.size());
    field += display(std::string_view(text).substr(begin, end - begin));
    if (end < text.size()) {
      quoted = quoted || text[end] != '\t';
      field += text[end] == '"' ? "\"\"" : std::string(1, text[end]);
    }
    begin = end + 1;
  }
  return quoted ? "\"" + field + "\"" : field;
}

std::string csv_number(double value, int digits) {
  return std::isfinite(value) ? formatted("{:.{}g}", value, digits) : std::string();
}

std::string toml_string(const std::string& text) {
  // JSON's escapes are also TOML's; JSON does not escape the control characters above 0x7e.
  const std::string json = json_string(text);
  std::string result;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const std::size_t bytes = control_character_length(json, i);
    if (bytes == 0) {
      result += json[i];
      continue;
    }
    i += bytes - 1;
    result += fmt::format("\\u{:04x}", static_cast<unsigned char>(json[i]));
  }
  return result;
}

std::string shell_word(const std::string& word) {
  const bool plain = !word.empty() && word.find_first_not_of(
                                          "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                          "0123456789._/-+:@%,=") == std::string::npos;
  if (plain) return word;
  return "'" + replace_placeholders(display(word), {{"'", "'\\''"}}) + "'";
}

std::string printable_piece(std::string_view piece) {
  constexpr std::size_t longest = 40;
  std::string shown(piece.substr(0, longest));
  std::replace_if(
      shown.begin(), shown.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return piece.size() > longest ? shown + "..." : shown;
}

std::string quoted_piece(std::string_view piece) {
  return fmt::format("\"{}\"", printable_piece(piece));
}

}  // namespace dlo::compare
