#pragma once

#include <string>
#include <utility>
#include <vector>

#include "report/html.hpp"
#include "report/page.hpp"

namespace dlo::compare {

/// How a section is there before anybody has asked for it.
enum class PageSection {
  folded,     ///< its heading
  open,       ///< all of it
  by_script,  ///< not at all, where no script runs
};

/// A report's page while it is written.
class PageWriter {
 public:
  explicit PageWriter(const std::vector<PageFigure>& figures) : figures_(figures) {}

  /// A section with a heading; what is added next is in it.
  void section(const std::string& id, const std::string& heading,
               PageSection kind = PageSection::folded);
  /// What the script finds by its name and fills.
  void filled_by_script(const std::string& id, const std::string& heading);
  void heading(const std::string& text);
  void paragraph(const std::string& text);
  void command(const std::string& what, const std::string& line);
  void commands(const std::string& summary, const std::vector<std::string>& lines);
  /// @param bold  how many of the first ones
  void list(const std::vector<std::string>& items, std::size_t bold = 0);
  /// Its first part is a verdict, with numbers; beside it a figure, which no section shows again.
  void screen(const std::string& verdict, const std::string& figure);
  void folded_list(const std::string& summary, const std::vector<std::string>& items);
  /// A table, or a sentence if nothing is in it.
  void table(const HtmlTable& table);
  void facts(const std::vector<std::pair<std::string, std::string>>& facts);
  /// Figures of a section whose names begin with a text.
  void figures(const std::string& section);

  /// @param data  of its script
  [[nodiscard]] std::string finished(const std::string& title, const std::string& data) const;

 private:
  struct Entry {
    std::string id, heading;
    PageSection kind = PageSection::folded;
  };

  void add_figure(const PageFigure& entry);
  [[nodiscard]] std::string end_of_section() const;

  const std::vector<PageFigure>& figures_;
  std::string out_;
  std::vector<Entry> sections_;
  std::string shown_;  // the figure of the first screen
};

}  // namespace dlo::compare
