// SPDX-License-Identifier: Apache-2.0
/// Progress on a terminal as a bar, elsewhere as a few plain lines.
#pragma once

#include <chrono>
#include <cstddef>
#include <ostream>
#include <string>
#include <string_view>

#include "core/base/progress.hpp"
#include "tools/strata/interrupt.hpp"

namespace strata::tools {

/// On a terminal: one line, redrawn at most ten times a second, with rate and time left. Otherwise
/// a line at the start and the end of each stage and every ten seconds between. Quiet: nothing, but
/// interrupts still cancel.
class TerminalProgress : public Progress {
 public:
  enum class Style { kBar, kLines, kQuiet };

  /// interrupt may be null. Both must outlive this.
  TerminalProgress(std::ostream& out, Style style, const Interrupt* interrupt);
  ~TerminalProgress() override;

  void update(std::string_view stage, std::size_t done, std::size_t total) override;
  [[nodiscard]] bool cancelled() const override;
  /// Wipes the bar, so that other text can follow.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;
  void draw(std::size_t done, std::size_t total, double elapsed_s);

  std::ostream& out_;
  Style style_;
  const Interrupt* interrupt_;
  std::string stage_;
  std::size_t first_done_ = 0;
  bool stage_ended_ = false;
  bool bar_visible_ = false;
  Clock::time_point stage_begin_;
  Clock::time_point last_drawn_;
};

/// "3:07" or "1:02:45".
[[nodiscard]] std::string format_duration(double seconds);
/// "match scans 120/4934 (2%), 35/s, 2:17 left".
[[nodiscard]] std::string progress_text(std::string_view stage, std::size_t done, std::size_t total,
                                        std::size_t done_since_begin, double elapsed_s);

}  // namespace strata::tools
