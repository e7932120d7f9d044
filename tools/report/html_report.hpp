// SPDX-License-Identifier: Apache-2.0
/// One self-contained report.html: opens offline, pictures inside, light and dark, narrow and wide.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/report/drawings.hpp"
#include "tools/report/image.hpp"
#include "tools/report/plot.hpp"

namespace strata::report {

/// A word of a table, and what it means in one short sentence.
struct Term {
  std::string word;
  std::string meaning;
};

/// A table with a header row; cells are plain text. Its words are explained below it.
struct Table {
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;
  std::string caption;
  std::vector<Term> terms = {};
};

/// Collects the parts of a report in order, and writes beside it a PNG and a CSV of every figure.
class HtmlReport {
 public:
  /// folder: where figures are written (it must exist); title: the page's heading; drawings: told
  /// of pictures that cannot be drawn. Null: they throw.
  HtmlReport(std::filesystem::path folder, std::string title, Drawings* drawings = nullptr);

  void heading(const std::string& text);
  void paragraph(const std::string& text);
  /// A link to a file beside the report, by its path from there, and what is to be seen in it.
  void link(const std::filesystem::path& file, const std::string& text);
  /// The verdict: shown large, above the rest.
  void verdict(const std::string& text);
  void table(const Table& table);
  /// A picture; writes NAME.png. alt: what a reader who cannot see it must know.
  void picture(const std::string& name, const Image& image, const std::string& alt,
               const std::string& caption);
  /// A picture that is encoded already, as the bytes of a PNG; writes NAME.png.
  void png(const std::string& name, const std::string& bytes, const std::string& alt,
           const std::string& caption);
  /// Two pictures of the same size with a slider between them; writes both PNGs.
  void before_after(const std::string& name, const Image& before, const Image& after,
                    const std::string& before_label, const std::string& after_label,
                    const std::string& caption);
  /// A plot; writes NAME.png, NAME.svg and NAME.csv.
  void plot(const std::string& name, const LinePlot& plot, const std::string& caption);
  /// A list of key and value in small print, folded away.
  void details(const std::string& summary, const std::string& preformatted);

  /// What was added so far, to be added to another page; its figures' files lie in this folder.
  [[nodiscard]] const std::string& body() const { return body_; }
  /// A body of a page without tables, whose numbers would be there twice.
  void append(const std::string& body) { body_ += body; }

  /// The whole page.
  [[nodiscard]] std::string html() const;
  /// Writes report.html into the folder. Throws OutputError.
  void write() const;

 private:
  std::filesystem::path folder_;
  std::string title_;
  Drawings* drawings_;
  std::string body_;
  int tables_ = 0;
};

/// Base64 of bytes, for data URIs.
[[nodiscard]] std::string base64(const std::string& bytes);

}  // namespace strata::report
