#include "report/page_writer.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/quote.hpp"
#include "report/style.hpp"

namespace dlo::compare {
namespace {

/// Contents open the section that they lead to, and paper has all of them open.
constexpr const char* open_sections = R"~~~((() => {
  const open = hash => {
    const section = hash && document.getElementById(hash.slice(1));
    const fold = section && section.querySelector(":scope > details.section");
    if (fold) fold.open = true;
    return section;
  };
  for (const a of document.querySelectorAll("nav a")) a.addEventListener("click", () => open(a.hash));
  const follow = () => { const section = open(location.hash); if (section) section.scrollIntoView(); };
  addEventListener("hashchange", follow);
  follow();
  let closed = [];
  addEventListener("beforeprint", () => {
    closed = [...document.querySelectorAll("details:not([open])")];
    for (const fold of closed) fold.open = true;
  });
  addEventListener("afterprint", () => { for (const fold of closed) fold.open = false; });
})();
)~~~";

const char* hidden(PageSection kind) {
  return kind == PageSection::by_script ? " data-needs-script hidden" : "";
}

}  // namespace

void PageWriter::section(const std::string& id, const std::string& heading, PageSection kind) {
  out_ += end_of_section();
  const std::string head = "<h2>" + escape_markup(heading) + "</h2>";
  out_ += fmt::format("<section id=\"{}\"{}>\n", id, hidden(kind));
  out_ += kind == PageSection::folded
              ? "<details class=\"section\"><summary>" + head + "</summary>\n"
              : head + "\n";
  sections_.push_back({id, heading, kind});
}

std::string PageWriter::end_of_section() const {
  if (sections_.empty()) return {};
  return sections_.back().kind == PageSection::folded ? "</details>\n</section>\n" : "</section>\n";
}

void PageWriter::filled_by_script(const std::string& id, const std::string& heading) {
  out_ += fmt::format("<div id=\"{}\" hidden>\n<h3>{}</h3>\n</div>\n", id, escape_markup(heading));
}

void PageWriter::heading(const std::string& text) {
  out_ += "<h3>" + escape_markup(text) + "</h3>\n";
}

void PageWriter::paragraph(const std::string& text) {
  out_ += "<p>" + escape_markup(text) + "</p>\n";
}

void PageWriter::command(const std::string& what, const std::string& line) {
  out_ += fmt::format("<p class=\"faint\">{} <code>{}</code></p>\n", escape_markup(what),
                      escape_markup(line));
}

void PageWriter::commands(const std::string& summary, const std::vector<std::string>& lines) {
  if (lines.empty()) return;
  out_ += "<details open><summary>" + escape_markup(summary) + "</summary>\n<ul>\n";
  for (const std::string& line : lines) {
    out_ += "<li><code>" + escape_markup(line) + "</code></li>\n";
  }
  out_ += "</ul>\n</details>\n";
}

void PageWriter::list(const std::vector<std::string>& items, std::size_t bold) {
  if (items.empty()) return;
  out_ += "<ul>\n";
  for (std::size_t i = 0; i < items.size(); ++i) {
    const std::string text = escape_markup(items[i]);
    out_ += "<li>" + (i < bold ? "<strong>" + text + "</strong>" : text) + "</li>\n";
  }
  out_ += "</ul>\n";
}

void PageWriter::screen(const std::string& verdict, const std::string& figure) {
  out_ += "<div class=\"screen\">\n<div>\n" + verdict + "</div>\n<div class=\"figures\">\n";
  for (const PageFigure& entry : figures_) {
    if (entry.figure.name != figure) continue;
    add_figure(entry);
    shown_ = figure;
  }
  out_ += "</div>\n</div>\n";
}

void PageWriter::folded_list(const std::string& summary, const std::vector<std::string>& items) {
  out_ += "<details><summary>" + escape_markup(summary) + "</summary>\n";
  list(items);
  out_ += "</details>\n";
}

void PageWriter::table(const HtmlTable& table) {
  if (!table.rows.empty()) {
    out_ += to_html(table);
  } else {
    paragraph(table.caption + ": none. What failed is named at the top of the page.");
  }
}

void PageWriter::facts(const std::vector<std::pair<std::string, std::string>>& facts) {
  out_ += "<dl>\n";
  for (const auto& [name, value] : facts) {
    out_ += fmt::format("<dt>{}</dt><dd>{}</dd>\n", escape_markup(name), escape_markup(value));
  }
  out_ += "</dl>\n";
}

void PageWriter::figures(const std::string& section) {
  if (std::none_of(figures_.begin(), figures_.end(),
                   [&](const PageFigure& entry) { return entry.figure.section == section; })) {
    return;
  }
  out_ += "<div class=\"figures\">\n";
  for (const PageFigure& entry : figures_) {
    if (entry.figure.section == section && entry.figure.name != shown_) add_figure(entry);
  }
  out_ += "</div>\n";
}

std::string PageWriter::finished(const std::string& title, const std::string& data) const {
  std::string page = html_begin("dlo report", title);
  page += "<header>\n<h1>" + escape_markup(title) + "</h1>\n</header>\n";
  page += "<nav aria-label=\"Sections\"><ul>\n";
  for (const auto& [id, heading, kind] : sections_) {
    page += fmt::format("<li{}><a href=\"#{}\">{}</a></li>\n", hidden(kind), id,
                        escape_markup(heading));
  }
  page += "</ul></nav>\n<main>\n" + out_ + end_of_section() + "</main>\n";
  page += "<script type=\"application/json\" id=\"page-data\">" + data + "</script>\n";
  return page + "<script>\n" + std::string(builtin::interactive_js) + "</script>\n<script>\n" +
         open_sections + "</script>\n</body>\n</html>\n";
}

void PageWriter::add_figure(const PageFigure& entry) {
  const Figure& figure = entry.figure;
  out_ += fmt::format("<figure id=\"figure-{}\">\n", figure.name);
  out_ += entry.failure.empty()
              ? entry.svg
              : fmt::format(
                    "<p class=\"missing\">This figure is missing: {}. Its numbers are in "
                    "the tables and in {}.</p>\n",
                    escape_markup(entry.failure), figure.csv_file);
  out_ += fmt::format(
      "<figcaption><strong>{0}</strong><br>{1}<br>Numbers: <a href=\"{2}\">{2}</a>{3} again by "
      "<code>{4}</code>; picture: <code>gnuplot {5}.gp</code></figcaption>\n</figure>\n",
      escape_markup(figure.title), escape_markup(figure.description), figure.csv_file,
      figure.given.empty() ? "," : "; " + escape_markup(figure.given),
      escape_markup(figure.command), figure.name);
}

}  // namespace dlo::compare
