#pragma once

#include <cstdlib>
#include <exception>
#include <functional>
#include <iostream>
#include <map>
#include <stdexcept>
#include <string>
#include <type_traits>

namespace dlo::test {

/// Functions that read the value of an option, by its name. They throw for a wrong value.
using OptionReaders = std::map<std::string, std::function<void(const std::string&)>>;

/// Returns a function that reads a number; one with a fraction must be > 0.
template <typename Number>
auto number_reader(Number& number) {
  return [&number](const std::string& value) {
    std::size_t used = 0;
    if constexpr (std::is_floating_point_v<Number>) {
      number = std::stod(value, &used);
      if (!(number > 0)) throw std::invalid_argument(value + " must be > 0");
    } else {
      number = static_cast<Number>(std::stoul(value, &used));
    }
    if (used != value.size()) throw std::invalid_argument("not a number: " + value);
  };
}

/// Reads pairs of an option and its value; prints an error and ends the program with 2 if they are
/// wrong.
inline void read_options(int argc, char** argv, const OptionReaders& readers) {
  try {
    for (int i = 1; i < argc; i += 2) {
      const auto reader = readers.find(argv[i]);
      if (reader == readers.end()) throw std::invalid_argument("unknown option");
      if (i + 1 == argc) throw std::invalid_argument("a value is missing");
      reader->second(argv[i + 1]);
    }
  } catch (const std::exception& error) {
    std::cerr << argv[0] << ": " << error.what() << "\n";
    std::exit(2);
  }
}

}  // namespace dlo::test
