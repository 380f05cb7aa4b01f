#pragma once

#include <concepts>
#include <string>
#include <vector>

namespace dlo::compare {

/// A value of an enumeration, its name in files and options, and its meaning in a few words.
template <typename Value>
struct Choice {
  Value value;          ///< value of the enumeration
  const char* name;     ///< name in files and options
  const char* meaning;  ///< description for help; may be empty
};

/// The only table of an enumeration's values, shared by files, options, help and output. It is
/// specialised next to the enumeration (those of force_model in force_model_settings.hpp), with a
/// constexpr array `all` of a Choice for each value.
template <typename Value>
struct Choices;

/// An enumeration for which Choices is specialised.
template <typename Value>
concept Chosen = requires {
  Choices<Value>::all;
};

/// Throws an InputError that names the allowed values.
[[noreturn]] void refuse_choice(const std::string& name, const std::vector<std::string>& allowed);

/// Returns "a, b or c", for help.
[[nodiscard]] std::string one_of(const std::vector<std::string>& names);

/// Returns the name of a value in files and options; empty if the table lacks the value.
template <Chosen Value>
[[nodiscard]] constexpr const char* to_string(Value value) {
  for (const auto& choice : Choices<Value>::all) {
    if (choice.value == value) return choice.name;
  }
  return "";
}

/// Returns all names, in the order of the table.
template <Chosen Value>
[[nodiscard]] std::vector<std::string> names() {
  std::vector<std::string> result;
  for (const auto& choice : Choices<Value>::all) result.emplace_back(choice.name);
  return result;
}

/// Returns all values, in the order of the table.
template <Chosen Value>
[[nodiscard]] std::vector<Value> values() {
  std::vector<Value> result;
  for (const auto& choice : Choices<Value>::all) result.push_back(choice.value);
  return result;
}

/// Returns "a, b or c" of all names.
template <Chosen Value>
[[nodiscard]] std::string one_of() {
  return one_of(names<Value>());
}

/// Returns all names, each with its meaning if it has one: "a, b (second) or c (third)".
template <Chosen Value>
[[nodiscard]] std::string meanings() {
  std::vector<std::string> result;
  for (const auto& choice : Choices<Value>::all) {
    result.emplace_back(choice.name);
    if (*choice.meaning != '\0') result.back() += std::string(" (") + choice.meaning + ")";
  }
  return one_of(result);
}

/// Returns the value with a name. @throws InputError if there is no such name
template <Chosen Value>
[[nodiscard]] Value from_name(const std::string& name) {
  for (const auto& choice : Choices<Value>::all) {
    if (name == choice.name) return choice.value;
  }
  refuse_choice(name, names<Value>());
}

}  // namespace dlo::compare
