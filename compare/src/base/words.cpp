#include "base/words.hpp"

#include <algorithm>
#include <cstddef>
#include <sstream>

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

}  // namespace

std::string nearest_word(std::string_view written, const std::vector<std::string>& words) {
  std::string nearest;
  std::size_t least = std::min<std::size_t>(3, (written.size() + 1) / 2);
  for (const std::string& word : words) {
    const std::size_t distance = levenshtein(written, word);
    if (distance >= least) continue;
    least = distance;
    nearest = word;
  }
  return nearest;
}

std::string did_you_mean(std::string_view written, const std::vector<std::string>& words) {
  const std::string nearest = nearest_word(written, words);
  return nearest.empty() ? "" : ", did you mean " + nearest + "?";
}

std::string with_places(std::string_view text,
                        const std::vector<std::pair<std::string_view, std::string>>& values) {
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

}  // namespace dlo::compare
