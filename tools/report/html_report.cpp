// SPDX-License-Identifier: Apache-2.0
#include "tools/report/html_report.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>

namespace strata::report {
namespace {

constexpr const char* kStyle = R"(
:root{--ink:#1d2126;--paper:#fff;--soft:#f2f4f7;--grid:#dde1e6;--accent:#0072b2}
@media(prefers-color-scheme:dark){:root{--ink:#e8eaed;--paper:#16191d;--soft:#22272e;--grid:#3a414a;--accent:#56b4e9}}
*{box-sizing:border-box}
body{margin:0 auto;max-width:84rem;padding:1rem;background:var(--paper);color:var(--ink);font:16px/1.5 'DejaVu Sans',system-ui,sans-serif}
h1{font-size:1.6rem;margin:.5rem 0}h2{font-size:1.2rem;margin:2rem 0 .5rem;border-bottom:1px solid var(--grid)}
.verdict{font-size:1.15rem;background:var(--soft);border-left:.4rem solid var(--accent);padding:.8rem 1rem}
p,li,figcaption{overflow-wrap:anywhere}figure{margin:1rem 0;padding:0}figcaption{font-size:.9rem;opacity:.85;margin-top:.3rem}
img,svg{max-width:100%;height:auto;display:block}img{border:1px solid var(--grid);image-rendering:pixelated;background:#fff}
.scroll{overflow-x:auto}.scroll>.plot{min-width:36rem}table{border-collapse:collapse;font-size:.9rem}
a{color:var(--accent)}
.note{font-size:.9rem;opacity:.85;margin:1.2rem 0 .3rem}
.terms{display:grid;grid-template-columns:repeat(auto-fill,minmax(min(100%,26rem),1fr));gap:.2rem 1.5rem;font-size:.85rem;margin:.6rem 0 1.2rem}
.terms dt{display:inline;font-weight:600}.terms dt::after{content:":"}.terms dd{display:inline;margin:0;opacity:.85}
th,td{padding:.3rem .5rem;border-bottom:1px solid var(--grid);text-align:right;white-space:nowrap}
th:first-child,td:first-child{text-align:left}
pre{background:var(--soft);padding:.8rem;overflow-x:auto;font-size:.8rem}
.slider{position:relative}.slider .after{position:absolute;inset:0;clip-path:inset(0 0 0 var(--at,50%))}
.slider .after img{width:100%}.slider>img{width:100%}
input[type=range]{width:100%;accent-color:var(--accent)}
:focus-visible{outline:3px solid var(--accent)}
)";

/// A path as part of a URL (RFC 3986): only what is never special stays.
std::string percent_encoded(const std::string& path) {
  constexpr const char* kDigits = "0123456789ABCDEF";
  std::string url;
  for (const char c : path) {
    const auto byte = static_cast<unsigned char>(c);
    const bool stays = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                       c == '/' || c == '.' || c == '-' || c == '_';
    url += stays ? std::string(1, c) : std::string{'%', kDigits[byte >> 4U], kDigits[byte & 15U]};
  }
  return url;
}

std::string data_uri(const std::string& png) { return "data:image/png;base64," + base64(png); }

/// size: attributes with a space before each; may be empty.
std::string figure(const std::string& png, const std::string& alt, const std::string& size,
                   const std::string& caption) {
  return "<figure><img src=\"" + data_uri(png) + "\" alt=\"" + escape(alt) + "\"" + size +
         "><figcaption>" + escape(caption) + "</figcaption></figure>\n";
}

}  // namespace

std::string base64(const std::string& bytes) {
  constexpr const char* kAlphabet =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string result;
  result.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t word = 0;
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    for (std::size_t k = 0; k < 3; ++k) {
      word = word << 8U | (k < count ? static_cast<std::uint8_t>(bytes[i + k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      result += k <= count ? kAlphabet[(word >> (18U - 6U * k)) & 63U] : '=';
    }
  }
  return result;
}

HtmlReport::HtmlReport(std::filesystem::path folder, std::string title, Drawings* drawings)
    : folder_(std::move(folder)), title_(std::move(title)), drawings_(drawings) {}

void HtmlReport::heading(const std::string& text) { body_ += "<h2>" + escape(text) + "</h2>\n"; }

void HtmlReport::paragraph(const std::string& text) { body_ += "<p>" + escape(text) + "</p>\n"; }

void HtmlReport::link(const std::filesystem::path& file, const std::string& text) {
  body_ += "<p><a href=\"" + escape(percent_encoded(file.generic_string())) + "\">" + escape(text) +
           "</a></p>\n";
}

void HtmlReport::verdict(const std::string& text) {
  body_ += "<p class=\"verdict\">" + escape(text) + "</p>\n";
}

void HtmlReport::table(const Table& table) {
  // The caption stays outside: within a table that scrolls sideways it would be cut.
  const std::string id = "table" + std::to_string(++tables_);
  body_ += "<p class=\"note\" id=\"" + id + "\">" + escape(table.caption) +
           "</p><div class=\"scroll\" role=\"group\" aria-labelledby=\"" + id +
           "\" tabindex=\"0\"><table aria-describedby=\"" + id + "\"><thead><tr>";
  for (const std::string& cell : table.header)
    body_ += "<th scope=\"col\">" + escape(cell) + "</th>";
  body_ += "</tr></thead><tbody>\n";
  for (const auto& row : table.rows) {
    body_ += "<tr>";
    for (std::size_t i = 0; i < row.size(); ++i) {
      body_ += i == 0 ? "<th scope=\"row\">" + escape(row[i]) + "</th>"
                      : "<td>" + escape(row[i]) + "</td>";
    }
    body_ += "</tr>\n";
  }
  body_ += "</tbody></table></div>\n";
  if (table.terms.empty()) return;
  body_ += "<dl class=\"terms\">";
  for (const Term& term : table.terms) {
    body_ += "<div><dt>" + escape(term.word) + "</dt> <dd>" + escape(term.meaning) + "</dd></div>";
  }
  body_ += "</dl>\n";
}

void HtmlReport::picture(const std::string& name, const Image& image, const std::string& alt,
                         const std::string& caption) {
  std::string png;
  const auto file = folder_ / (name + ".png");
  draw(drawings_, file, [&] {
    png = encode_png(image);
    write_file(file, png);
  });
  body_ += figure(png, alt,
                  " width=\"" + std::to_string(image.width()) + "\" height=\"" +
                      std::to_string(image.height()) + "\"",
                  caption);
}

void HtmlReport::png(const std::string& name, const std::string& bytes, const std::string& alt,
                     const std::string& caption) {
  const auto file = folder_ / (name + ".png");
  draw(drawings_, file, [&] { write_file(file, bytes); });
  body_ += figure(bytes, alt, "", caption);
}

void HtmlReport::before_after(const std::string& name, const Image& before, const Image& after,
                              const std::string& before_label, const std::string& after_label,
                              const std::string& caption) {
  std::string first;
  std::string second;
  const auto write = [&](const std::string& ending, const Image& image, std::string& png) {
    const auto file = folder_ / (name + ending);
    draw(drawings_, file, [&] {
      png = encode_png(image);
      write_file(file, png);
    });
  };
  write("_before.png", before, first);
  write("_after.png", after, second);
  const std::string label =
      before_label + " on the left of the border, " + after_label + " on the right";
  body_ += "<figure><div class=\"slider\"><img src=\"" + data_uri(first) + "\" alt=\"" +
           escape(before_label) + "\"><div class=\"after\"><img src=\"" + data_uri(second) +
           "\" alt=\"" + escape(after_label) +
           "\"></div></div><input type=\"range\" min=\"0\" max=\"100\" value=\"50\" aria-label=\"" +
           escape(label) +
           "\" oninput=\"this.previousElementSibling.style.setProperty('--at',this.value+'%')\">"
           "<figcaption>" +
           escape(caption + " " + label + ".") + "</figcaption></figure>\n";
}

void HtmlReport::plot(const std::string& name, const LinePlot& plot, const std::string& caption) {
  const std::string standalone = to_svg(plot, true);
  write_file(folder_ / (name + ".svg"), standalone);
  const auto file = folder_ / (name + ".png");
  draw(drawings_, file, [&] { write_file(file, render_svg_to_png(standalone, 1.5)); });
  write_file(folder_ / (name + ".csv"), to_csv(plot));
  // Narrow windows scroll the plot, so that its text stays readable.
  body_ += "<figure><div class=\"scroll\" role=\"group\" aria-label=\"" + escape(plot.title) +
           "\" tabindex=\"0\">" + to_svg(plot, false) + "</div><figcaption>" + escape(caption) +
           "</figcaption></figure>\n";
}

void HtmlReport::details(const std::string& summary, const std::string& preformatted) {
  body_ += "<details><summary>" + escape(summary) + "</summary><pre>" + escape(preformatted) +
           "</pre></details>\n";
}

std::string HtmlReport::html() const {
  return "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
         "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n"
         "<meta name=\"color-scheme\" content=\"light dark\">\n<link rel=\"icon\" "
         "href=\"data:,\">\n"
         "<title>" +
         escape(title_) + "</title>\n<style>" + kStyle + plot_style() +
         "</style>\n</head>\n<body>\n<main>\n<h1>" + escape(title_) + "</h1>\n" + body_ +
         "</main>\n</body>\n</html>\n";
}

void HtmlReport::write() const { write_file(folder_ / "report.html", html()); }

}  // namespace strata::report
