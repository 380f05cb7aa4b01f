#include "points/vtk_array.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "base/input_file.hpp"
#include "base/number.hpp"
#include "base/quote.hpp"
#include "decode/base64.hpp"
#include "decode/inflate.hpp"
#include "dlo/compare/shape_file.hpp"

namespace dlo::compare {
namespace {

/// More numbers than a polyline of most_shape_points has in any array.
constexpr std::size_t most_numbers = 16 * static_cast<std::size_t>(most_shape_points);

/// Reads one DataArray.
class ArrayReader {
 public:
  ArrayReader(const XmlFile& xml, const pugi::xml_node& array, const VtkEncoding& encoding)
      : xml_(xml), array_(array), encoding_(encoding) {}

  /// All numbers that it has.
  [[nodiscard]] std::vector<double> read() const {
    const std::string_view format = array_.attribute("format").as_string("ascii");
    if (format == "ascii") return from_text(array_.child_value());
    const NumberFormat numbers = number_format();
    std::string bytes;
    if (format == "binary") {
      bytes = decoded(array_.child_value());
    } else if (format == "appended") {
      bytes = appended();
    } else {
      xml_.fail(array_, "format", "unknown (allowed: ascii, binary, appended)");
    }
    const std::string data = encoding_.packed ? unpacked(bytes) : plain(bytes);
    if (data.size() % numbers.bytes != 0) fail("ends within a number");
    return numbers_from(data, data.size() / numbers.bytes, numbers);
  }

  [[noreturn]] void fail(const std::string& problem) const {
    xml_.fail(array_,
              fmt::format("{}: {}", quoted_piece(array_.attribute("Name").value()), problem));
  }

 private:
  [[nodiscard]] NumberFormat number_format() const {
    const std::string_view type = array_.attribute("type").value();
    struct Type {
      std::string_view name;
      NumberFormat::Kind kind;
    };
    constexpr Type types[] = {{"Float", NumberFormat::Kind::floating},
                              {"Int", NumberFormat::Kind::integer},
                              {"UInt", NumberFormat::Kind::natural}};
    for (const Type& each : types) {
      if (!type.starts_with(each.name)) continue;
      const auto bits = as_number<std::size_t>(type.substr(each.name.size())).value_or(0);
      const NumberFormat format{each.kind, bits / 8, encoding_.big_endian};
      if (bits % 8 == 0 && is_known(format)) return format;
    }
    xml_.fail(array_, "type",
              "unknown (allowed: Float32, Float64, and Int8 to Int64, UInt8 to UInt64)");
  }

  [[nodiscard]] std::vector<double> from_text(std::string_view text) const {
    constexpr const char* blanks = " \t\r\n";
    std::vector<double> numbers;
    for (text.remove_prefix(std::min(text.find_first_not_of(blanks), text.size())); !text.empty();
         text.remove_prefix(std::min(text.find_first_not_of(blanks), text.size()))) {
      const std::string_view word = text.substr(0, text.find_first_of(blanks));
      const std::optional<double> number = shape_number(word);
      if (!number) fail(fmt::format("{} is not a number", quoted_piece(word)));
      numbers.push_back(*number);
      if (numbers.size() > most_numbers) fail(fmt::format("more than {} numbers", most_numbers));
      text.remove_prefix(word.size());
    }
    return numbers;
  }

  [[nodiscard]] std::string decoded(std::string_view code) const {
    const std::optional<std::string> bytes = from_base64(code, InputFile::largest_file);
    if (!bytes) fail("not base64");
    return *bytes;
  }

  [[nodiscard]] std::string appended() const {
    const auto offset = as_number<std::size_t>(array_.attribute("offset").value());
    if (!offset || *offset > encoding_.appended.size()) {
      xml_.fail(
          array_, "offset",
          fmt::format("not within the {} bytes that are appended", encoding_.appended.size()));
    }
    const std::string_view rest = encoding_.appended.substr(*offset);
    if (!encoding_.appended_base64) return std::string(rest);
    // The next array's code follows on, and may be any.
    const std::optional<std::string> bytes = from_base64(rest, InputFile::largest_file);
    if (!bytes) fail("not base64");
    return *bytes;
  }

  [[nodiscard]] std::size_t header(std::string_view bytes, std::size_t index) const {
    const std::size_t width = encoding_.header_bytes;
    const auto value = natural_at(bytes, index * width, width, encoding_.big_endian);
    if (!value) fail("is cut off in its header");
    if (*value > InputFile::largest_file) {
      fail(fmt::format("{} bytes or blocks (allowed: up to {})", *value, InputFile::largest_file));
    }
    return static_cast<std::size_t>(*value);
  }

  [[nodiscard]] std::string plain(std::string_view bytes) const {
    const std::size_t size = header(bytes, 0);
    if (bytes.size() - encoding_.header_bytes < size) fail("is cut off");
    return std::string(bytes.substr(encoding_.header_bytes, size));
  }

  /// Of blocks: their number, size, the last one's size (0: as the others), and packed sizes.
  [[nodiscard]] std::string unpacked(std::string_view bytes) const {
    const std::size_t blocks = header(bytes, 0);
    if (blocks == 0) return {};
    const std::size_t size = header(bytes, 1);
    const std::size_t last = header(bytes, 2);
    if (blocks > bytes.size() || size > InputFile::largest_file / blocks) {
      fail(fmt::format("{} blocks of {} bytes (allowed: {} bytes, in the file)", blocks, size,
                       InputFile::largest_file));
    }
    std::string data;
    std::size_t at = (3 + blocks) * encoding_.header_bytes;
    for (std::size_t i = 0; i < blocks; ++i) {
      const std::size_t packed = header(bytes, 3 + i);
      if (at > bytes.size() || bytes.size() - at < packed) fail("is cut off");
      const std::size_t whole = i + 1 == blocks && last > 0 ? last : size;
      const auto block = inflated(bytes.substr(at, packed), whole, Deflated::zlib);
      if (!block) fail(fmt::format("block {} is damaged", i + 1));
      data += *block;
      at += packed;
    }
    return data;
  }

  const XmlFile& xml_;
  const pugi::xml_node& array_;
  const VtkEncoding& encoding_;
};

}  // namespace

std::vector<double> vtk_numbers(const XmlFile& xml, const pugi::xml_node& array,
                                const VtkEncoding& encoding, std::size_t count) {
  const ArrayReader reader(xml, array, encoding);
  std::vector<double> numbers = reader.read();
  if (numbers.size() != count) {
    reader.fail(fmt::format("has {} numbers (allowed: {})", numbers.size(), count));
  }
  return numbers;
}

std::vector<std::size_t> vtk_indices(const XmlFile& xml, const pugi::xml_node& array,
                                     const VtkEncoding& encoding, std::size_t end) {
  const ArrayReader reader(xml, array, encoding);
  const std::vector<double> numbers = reader.read();
  std::vector<std::size_t> indices;
  indices.reserve(numbers.size());
  for (const double number : numbers) {
    // The negation makes a NaN out of range.
    if (!(number >= 0 && number < static_cast<double>(end))) {
      reader.fail(fmt::format("{:g} (allowed: 0 to {})", number, end - 1));
    }
    indices.push_back(static_cast<std::size_t>(number));
  }
  return indices;
}

}  // namespace dlo::compare
