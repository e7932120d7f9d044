// SPDX-License-Identifier: Apache-2.0
/// Progress on a terminal as a bar, elsewhere as a few plain lines.
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <optional>
#include <ostream>
#include <string>
#include <string_view>

#include "core/base/progress.hpp"
#include "tools/strata/interrupt.hpp"

namespace strata::tools {

/// On a terminal: one line, redrawn at most ten times a second, with rate and time left, and gone
/// at the end. Otherwise a line every ten seconds, and the first and the last of each stage. What
/// is over within a second is not shown: on a terminal all of the work, else the stage. Quiet:
/// nothing, but interrupts still cancel. Where a stage ends, what it freed goes back to the system:
/// glibc keeps it, and the next stage takes other pieces.
class TerminalProgress : public Progress {
 public:
  enum class Style { kBar, kLines, kQuiet };

  using Time = std::chrono::steady_clock::time_point;

  /// interrupt may be null; `out` and it must outlive this. now: the clock.
  TerminalProgress(std::ostream& out, Style style, const Interrupt* interrupt,
                   std::function<Time()> now = std::chrono::steady_clock::now);
  ~TerminalProgress() override;

  void update(std::string_view stage, std::size_t done, std::size_t total) override;
  [[nodiscard]] bool cancelled() const override;
  [[nodiscard]] const std::string& stage() const { return stage_; }
  /// Wipes the bar, so that other text can follow.
  void clear();

 private:
  void begin_stage(std::string_view stage, std::size_t done, Time now);
  [[nodiscard]] bool is_due(bool at_end, Time now) const;
  void draw(std::size_t done, std::size_t total, double elapsed_s);

  std::ostream& out_;
  Style style_;
  const Interrupt* interrupt_;
  std::function<Time()> now_;
  std::string stage_;
  std::size_t first_done_ = 0;
  bool stage_ended_ = false;
  bool bar_visible_ = false;
  Time begin_;
  Time stage_begin_;
  std::optional<Time> last_drawn_;  ///< lines: in this stage
};

/// "3:07" or "1:02:45".
[[nodiscard]] std::string format_duration(double seconds);
/// "match scans 120/4934 (2%), 35/s, 2:17 left".
[[nodiscard]] std::string progress_text(std::string_view stage, std::size_t done, std::size_t total,
                                        std::size_t done_since_begin, double elapsed_s);

}  // namespace strata::tools
