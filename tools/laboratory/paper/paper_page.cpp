// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/paper/paper_page.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "tools/report/drawings.hpp"
#include "tools/report/html_report.hpp"

namespace strata::paper {
namespace {

std::string shown(const std::optional<double>& value, int digits) {
  if (!value || !std::isfinite(*value)) return "–";
  return report::fixed(*value, digits);
}

/// A cell of a Markdown table.
std::string cell(std::string text) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\n') text[i] = ' ';
    if (text[i] == '|') text.insert(i++, 1, '\\');
  }
  return text;
}

nlohmann::json json_of(const std::optional<double>& value) {
  if (!value || !std::isfinite(*value)) return nullptr;
  return *value;
}

void add_pictures(report::HtmlReport& page, const std::vector<Picture>& pictures) {
  for (const Picture& picture : pictures) {
    if (const auto* plot = std::get_if<report::LinePlot>(&picture.content)) {
      page.plot(picture.name, *plot, picture.caption);
    } else {
      page.png(picture.name, std::get<std::string>(picture.content), picture.caption,
               picture.caption);
    }
  }
}

void add_row(report::HtmlReport& page, const Row& row) {
  const Figure& figure = row.figure;
  page.heading(figure.id + ": " + figure.title);
  page.paragraph("The paper shows: " + figure.shows);
  page.verdict(word(row.outcome.verdict) +
               (row.outcome.reason.empty() ? "" : ": " + row.outcome.reason));
  page.paragraph("Holds if: " + figure.criterion + " Made of: " + figure.material + ".");
  if (!row.outcome.numbers.empty()) {
    report::Table table;
    table.header = {"measure", "the paper's form", "ours"};
    table.caption = figure.id + ", " + report::fixed(row.took_s, 0) + " s";
    for (const Number& number : row.outcome.numbers) {
      table.rows.push_back({number.label, shown(number.papers_form, number.digits),
                            shown(number.ours, number.digits)});
    }
    page.table(table);
  }
  add_pictures(page, row.outcome.pictures);
}

/// "label ours (the paper's form 1.23); ...".
std::string numbers_in_words(const Outcome& outcome) {
  std::string words;
  for (const Number& number : outcome.numbers) {
    words += (words.empty() ? "" : "; ") + number.label + " " + shown(number.ours, number.digits);
    if (number.papers_form) {
      words += " (the paper's form " + shown(number.papers_form, number.digits) + ")";
    }
  }
  return words;
}

report::Table overview(std::span<const Row> rows) {
  report::Table table;
  table.header = {"figure", "verdict", "title", "time [s]"};
  table.caption = sum_of(rows);
  for (const Row& row : rows) {
    table.rows.push_back(
        {row.figure.id, word(row.outcome.verdict), row.figure.title, report::fixed(row.took_s, 0)});
  }
  return table;
}

}  // namespace

std::string sum_of(std::span<const Row> rows) {
  const auto count = [&](Verdict verdict) {
    return std::to_string(std::count_if(
        rows.begin(), rows.end(), [&](const Row& row) { return row.outcome.verdict == verdict; }));
  };
  return count(Verdict::kHeld) + " held, " + count(Verdict::kNotHeld) + " not held, " +
         count(Verdict::kNotMade) + " not made, of " + std::to_string(rows.size());
}

std::string text_table(std::span<const Row> rows) {
  std::string text = "| figure | what | verdict | numbers | why |\n|---|---|---|---|---|\n";
  for (const Row& row : rows) {
    text += "| " + row.figure.id + " | " + cell(row.figure.title) + " | " +
            word(row.outcome.verdict) + " | " + cell(numbers_in_words(row.outcome)) + " | " +
            cell(row.outcome.reason) + " |\n";
  }
  return text + "\n" + sum_of(rows) + "\n";
}

nlohmann::json to_json(std::span<const Row> rows) {
  nlohmann::json all = nlohmann::json::array();
  for (const Row& row : rows) {
    nlohmann::json numbers = nlohmann::json::array();
    for (const Number& number : row.outcome.numbers) {
      numbers.push_back({{"label", number.label},
                         {"papers_form", json_of(number.papers_form)},
                         {"ours", json_of(number.ours)}});
    }
    nlohmann::json pictures = nlohmann::json::array();
    for (const Picture& picture : row.outcome.pictures) pictures.push_back(picture.name + ".png");
    all.push_back({{"id", row.figure.id},
                   {"paper", row.figure.paper},
                   {"title", row.figure.title},
                   {"shows", row.figure.shows},
                   {"criterion", row.figure.criterion},
                   {"material", row.figure.material},
                   {"verdict", word(row.outcome.verdict)},
                   {"reason", row.outcome.reason},
                   {"took_s", row.took_s},
                   {"pictures", std::move(pictures)},
                   {"numbers", std::move(numbers)}});
  }
  return all;
}

std::string write_page(const std::filesystem::path& folder, std::span<const Row> rows) {
  report::Drawings drawings;
  report::HtmlReport page(folder, "Figures and tables of the papers", &drawings);
  page.verdict(sum_of(rows));
  page.table(overview(rows));
  for (const Row& row : rows) add_row(page, row);
  report::write_file(folder / "index.html", page.html());
  report::write_file(folder / "results.json", to_json(rows).dump(2) + "\n");
  return drawings.what_is_missing();
}

}  // namespace strata::paper
