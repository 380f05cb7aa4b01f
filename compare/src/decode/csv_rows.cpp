#include "decode/csv_rows.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/input_file.hpp"
#include "base/text.hpp"

namespace dlo::compare {
namespace {

constexpr char any_blanks = '\0';

char separator_of(std::string_view line) {
  for (const char separator : {',', ';', '\t'}) {
    if (line.find(separator) != std::string_view::npos) return separator;
  }
  return any_blanks;
}

std::vector<std::string_view> split_fields(std::string_view line, const CsvForm& form) {
  std::vector<std::string_view> fields;
  for (;;) {
    const bool blanks = form.separator == any_blanks;
    const std::size_t end = blanks ? line.find_first_of(" \t") : line.find(form.separator);
    fields.push_back(trimmed(line.substr(0, end), form.trimmed_characters));
    if (end == std::string_view::npos || fields.size() > form.most_fields) return fields;
    line.remove_prefix(end + 1);
    if (blanks) line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
  }
}

}  // namespace

void for_each_csv_row(std::string_view text, const std::string& file, CsvForm form,
                      const std::function<void(const CsvRow&)>& take) {
  text = after_byte_order_mark(text);
  std::size_t rows = 0;
  for (long number = 1; !text.empty() && rows < form.most_rows; ++number) {
    const std::size_t end = text.find('\n');
    const std::string_view line = trimmed(text.substr(0, end), form.trimmed_characters);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    if (line.empty() || line.front() == '#') continue;
    if (form.separator == CsvForm::detect_from_first_row) form.separator = separator_of(line);
    take({number, fmt::format("{}:{}", file, number), split_fields(line, form)});
    ++rows;
  }
}

}  // namespace dlo::compare
