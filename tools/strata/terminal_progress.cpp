// SPDX-License-Identifier: Apache-2.0
#include "tools/strata/terminal_progress.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "components/runtime/free_memory.hpp"

namespace strata::tools {
namespace {

double seconds(std::chrono::steady_clock::duration time) {
  return std::chrono::duration<double>(time).count();
}

}  // namespace

std::string format_duration(double seconds) {
  const auto whole = static_cast<long long>(std::llround(std::max(0.0, seconds)));
  char text[64];
  if (whole >= 3600) {
    std::snprintf(text, sizeof text, "%lld:%02lld:%02lld", whole / 3600, whole / 60 % 60,
                  whole % 60);
  } else {
    std::snprintf(text, sizeof text, "%lld:%02lld", whole / 60, whole % 60);
  }
  return text;
}

std::string progress_text(std::string_view stage, std::size_t done, std::size_t total,
                          std::size_t done_since_begin, double elapsed_s) {
  std::string text(stage);
  text += " " + std::to_string(done);
  if (total > 0) {
    const std::size_t percent = std::min<std::size_t>(100, 100 * done / total);
    text += "/" + std::to_string(total) + " (" + std::to_string(percent) + "%)";
  }
  if (elapsed_s <= 0.0 || done_since_begin == 0) return text;
  const double rate = static_cast<double>(done_since_begin) / elapsed_s;
  char number[64];
  std::snprintf(number, sizeof number, rate >= 10.0 ? ", %.0f/s" : ", %.2f/s", rate);
  text += number;
  if (total > done) {
    text += ", " + format_duration(static_cast<double>(total - done) / rate) + " left";
  }
  return text;
}

TerminalProgress::TerminalProgress(std::ostream& out, Style style, const Interrupt* interrupt,
                                   std::function<Time()> now)
    : out_(out),
      style_(style),
      interrupt_(interrupt),
      now_(std::move(now)),
      begin_(now_()),
      stage_begin_(begin_) {}

TerminalProgress::~TerminalProgress() { clear(); }

bool TerminalProgress::cancelled() const {
  return interrupt_ != nullptr && interrupt_->requested();
}

void TerminalProgress::update(std::string_view stage, std::size_t done, std::size_t total) {
  if (stage != stage_) runtime::return_free_memory();
  if (style_ == Style::kQuiet) {
    if (stage != stage_) stage_ = stage;
    return;
  }
  const Time now = now_();
  if (stage != stage_ || (stage_ended_ && done < total)) begin_stage(stage, done, now);
  const bool at_end = total > 0 && done >= total;
  if (at_end && stage_ended_) return;
  stage_ended_ = at_end;
  if (!is_due(at_end, now)) return;
  last_drawn_ = now;
  draw(done, total, seconds(now - stage_begin_));
}

void TerminalProgress::begin_stage(std::string_view stage, std::size_t done, Time now) {
  stage_ = stage;
  first_done_ = done;
  stage_begin_ = now;
  stage_ended_ = false;
  if (style_ == Style::kLines) last_drawn_.reset();
}

bool TerminalProgress::is_due(bool at_end, Time now) const {
  constexpr double kShort_s = 1.0;
  const bool is_bar = style_ == Style::kBar;
  if (!last_drawn_) return seconds(now - (is_bar ? begin_ : stage_begin_)) >= kShort_s;
  const double pause_s = is_bar ? 0.1 : 10.0;
  return at_end || seconds(now - *last_drawn_) >= pause_s;
}

void TerminalProgress::draw(std::size_t done, std::size_t total, double elapsed_s) {
  const std::string text =
      progress_text(stage_, done, total, done - std::min(done, first_done_), elapsed_s);
  if (style_ == Style::kLines) {
    out_ << text << std::endl;
    return;
  }
  constexpr std::size_t kWidth = 24;
  const std::size_t filled = total > 0 ? std::min(kWidth, kWidth * done / total) : 0;
  out_ << "\r\033[K[" << std::string(filled, '#') << std::string(kWidth - filled, '.') << "] "
       << text << std::flush;
  bar_visible_ = true;
}

void TerminalProgress::clear() {
  if (!bar_visible_) return;
  out_ << "\r\033[K" << std::flush;
  bar_visible_ = false;
}

}  // namespace strata::tools
