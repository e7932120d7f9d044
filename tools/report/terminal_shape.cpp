// SPDX-License-Identifier: Apache-2.0
#include "tools/report/terminal_shape.hpp"

#include <algorithm>
#include <cctype>
#include <cstdlib>

#include <sys/ioctl.h>
#include <unistd.h>

namespace strata::report {
namespace {

/// Lines that what is said needs, and the prompt after it.
constexpr int kOtherLines = 5;
constexpr int kLeastRows = 4;
constexpr int kLeastColumns = 20;
constexpr int kUsualColumns = 80;

std::string variable(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

bool is_utf8(std::string locale) {
  std::transform(locale.begin(), locale.end(), locale.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return locale.find("utf-8") != std::string::npos || locale.find("utf8") != std::string::npos;
}

}  // namespace

TerminalFacts facts_of_stdout() {
  TerminalFacts facts;
  facts.is_terminal = isatty(STDOUT_FILENO) != 0;
  winsize size{};
  if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0) {
    facts.columns = size.ws_col;
    facts.lines = size.ws_row;
  }
  facts.term = variable("TERM");
  for (const char* name : {"LC_ALL", "LC_CTYPE", "LANG"}) {
    if (facts.locale.empty()) facts.locale = variable(name);
  }
  facts.no_color = variable("NO_COLOR");
  return facts;
}

std::optional<TerminalShape> shape_for(const TerminalFacts& facts) {
  // The console of Linux has no braille.
  const bool has_braille =
      !facts.term.empty() && facts.term != "dumb" && facts.term != "linux" && is_utf8(facts.locale);
  if (!facts.is_terminal || !has_braille) return std::nullopt;
  TerminalShape shape;
  shape.columns = std::min(kMapColumns, facts.columns > 0 ? facts.columns : kUsualColumns);
  shape.rows = facts.lines > 0 ? std::min(kMapRows, facts.lines - kOtherLines) : kMapRows;
  if (shape.columns < kLeastColumns || shape.rows < kLeastRows) return std::nullopt;
  shape.color = facts.no_color.empty();
  return shape;
}

}  // namespace strata::report
