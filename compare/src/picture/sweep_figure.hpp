#pragma once

#include <string>
#include <vector>

#include "figure/layout.hpp"

namespace dlo::compare {

/// A field of a sweep.
struct SweptField {
  std::string column;               ///< its name in the table
  std::vector<std::string> values;  ///< as the table spells them, in the sweep's order
  bool logarithmic = false;         ///< the values are spread so
};

/// What can be told of a picture before the sweep is computed.
/// @throws InputError if there are other than one or two fields, or the first of two and a single
/// one has values that are no numbers
void require_drawable(const std::vector<SweptField>& fields);

/// A sweep over one field as lines, over two as lines for each value of the second where these are
/// few or no numbers, else as maps.
/// @param fields   one or two;  @param header, rows  of the table (CSV), with their line ends
/// @param results  columns that are drawn, a figure each
/// @throws InputError as require_drawable(), or if there is no such column
[[nodiscard]] Picture sweep_picture(const std::vector<SweptField>& fields,
                                    const std::string& header, const std::vector<std::string>& rows,
                                    const std::vector<std::string>& results);

}  // namespace dlo::compare
