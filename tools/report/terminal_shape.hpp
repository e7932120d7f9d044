// SPDX-License-Identifier: Apache-2.0
/// Whether the terminal that stdout is can show a small map, and how large.
#pragma once

#include <optional>
#include <string>

#include "tools/report/terminal_map.hpp"

namespace strata::report {

inline constexpr int kMapColumns = 100;
inline constexpr int kMapRows = 20;

/// What is known of an output and of who looks at it.
struct TerminalFacts {
  bool is_terminal = false;
  int columns = 0;  ///< 0: not known
  int lines = 0;    ///< 0: not known
  std::string term;
  std::string locale;    ///< the first that is set of LC_ALL, LC_CTYPE, LANG
  std::string no_color;  ///< no-color.org: set to anything
};

/// Of this process's stdout and environment. Not while another thread changes the environment.
[[nodiscard]] TerminalFacts facts_of_stdout();

/// At most kMapColumns x kMapRows, with room for a few lines more. Nothing for files and pipes,
/// terminals without braille (TERM dumb, linux or not set; locales that are not UTF-8), and those
/// with too few lines or columns to show anything.
[[nodiscard]] std::optional<TerminalShape> shape_for(const TerminalFacts& facts);

}  // namespace strata::report
