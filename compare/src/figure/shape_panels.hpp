#pragma once

#include <string>
#include <vector>

#include "figure/layout.hpp"
#include "figure/series.hpp"

namespace dlo::compare {

/// Shapes in one or two views at equal aspect, by construction: both axes have the same number of
/// pixels a metre.
[[nodiscard]] std::vector<Panel> shape_panels(const std::string& csv_file,
                                              const std::vector<Series>& all,
                                              const std::vector<View>& views);

/// Curvature of the series that have one against arc length.
[[nodiscard]] Panel curvature_panel(const std::string& csv_file, const std::vector<Series>& all,
                                    bool planar);

/// 1, 2 or 5 times a power of ten, such that five to ten fit into a range > 0.
[[nodiscard]] double tic_step(double range);

/// "'FILE' using (strcol(1) eq 'ID' ? X : NaN):Y", of a CSV file whose first column is the series.
[[nodiscard]] std::string series_data(const std::string& csv_file, const std::string& id,
                                      const std::string& x, const std::string& y);

}  // namespace dlo::compare
