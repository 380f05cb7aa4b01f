#pragma once

#include <concepts>
#include <string>
#include <vector>

namespace dlo::compare {

/// A value of an enumeration as files and options spell it, and in a few words what it means.
template <typename Value>
struct Choice {
  Value value;          ///< of the enumeration
  const char* name;     ///< as it is spelt
  const char* meaning;  ///< for help; may be empty
};

/// The one table of an enumeration that files, options, help and output share. Specialised beside
/// the enumeration (those of force_model in force_model_settings.hpp), with a constexpr array `all`
/// of a Choice for each value.
template <typename Value>
struct Choices;

/// An enumeration that has such a table.
template <typename Value>
concept Chosen = requires {
  Choices<Value>::all;
};

/// @throws InputError that names what is allowed
[[noreturn]] void refuse_choice(const std::string& name, const std::vector<std::string>& allowed);

/// "a, b or c", for help.
[[nodiscard]] std::string one_of(const std::vector<std::string>& names);

/// As files and options spell it.
template <Chosen Value>
[[nodiscard]] constexpr const char* to_string(Value value) {
  for (const auto& choice : Choices<Value>::all) {
    if (choice.value == value) return choice.name;
  }
  return "";
}

/// All names, in the table's order.
template <Chosen Value>
[[nodiscard]] std::vector<std::string> names() {
  std::vector<std::string> result;
  for (const auto& choice : Choices<Value>::all) result.emplace_back(choice.name);
  return result;
}

/// All values, in the table's order.
template <Chosen Value>
[[nodiscard]] std::vector<Value> values() {
  std::vector<Value> result;
  for (const auto& choice : Choices<Value>::all) result.push_back(choice.value);
  return result;
}

/// "a, b or c" of all names.
template <Chosen Value>
[[nodiscard]] std::string one_of() {
  return one_of(names<Value>());
}

/// All names with what they mean, if more than themselves: "a, b (second) or c (third)".
template <Chosen Value>
[[nodiscard]] std::string meanings() {
  std::vector<std::string> result;
  for (const auto& choice : Choices<Value>::all) {
    result.emplace_back(choice.name);
    if (*choice.meaning != '\0') result.back() += std::string(" (") + choice.meaning + ")";
  }
  return one_of(result);
}

/// The value of a name. @throws InputError if there is no such name
template <Chosen Value>
[[nodiscard]] Value from_name(const std::string& name) {
  for (const auto& choice : Choices<Value>::all) {
    if (name == choice.name) return choice.value;
  }
  refuse_choice(name, names<Value>());
}

}  // namespace dlo::compare
