// SPDX-License-Identifier: Apache-2.0
#include "tools/strata/terminal_progress.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace strata::tools {

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

TerminalProgress::TerminalProgress(std::ostream& out, Style style, const Interrupt* interrupt)
    : out_(out), style_(style), interrupt_(interrupt) {}

TerminalProgress::~TerminalProgress() { clear(); }

bool TerminalProgress::cancelled() const {
  return interrupt_ != nullptr && interrupt_->requested();
}

void TerminalProgress::update(std::string_view stage, std::size_t done, std::size_t total) {
  if (style_ == Style::kQuiet) return;
  const auto now = Clock::now();
  const bool new_stage = stage != stage_ || (stage_ended_ && done < total);
  if (new_stage) {
    clear();
    stage_ = stage;
    first_done_ = done;
    stage_begin_ = now;
    stage_ended_ = false;
  }
  const bool at_end = total > 0 && done >= total;
  if (at_end && stage_ended_) return;
  const double pause_s = style_ == Style::kBar ? 0.1 : 10.0;
  const double since_drawn_s = std::chrono::duration<double>(now - last_drawn_).count();
  if (!new_stage && !at_end && since_drawn_s < pause_s) return;
  last_drawn_ = now;
  stage_ended_ = at_end;
  draw(done, total, std::chrono::duration<double>(now - stage_begin_).count());
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
  if (stage_ended_) {
    out_ << std::endl;
    bar_visible_ = false;
  }
}

void TerminalProgress::clear() {
  if (!bar_visible_) return;
  out_ << "\r\033[K" << std::flush;
  bar_visible_ = false;
}

}  // namespace strata::tools
