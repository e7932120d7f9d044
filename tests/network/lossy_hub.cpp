// SPDX-License-Identifier: Apache-2.0
#include "tests/network/lossy_hub.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include <poll.h>
#include <unistd.h>

namespace strata::test {

LossyHub::LossyHub(std::vector<int> taps)
    : taps_(std::move(taps)), thread_([this](const std::stop_token& stop) { run(stop); }) {}

LossyHub::~LossyHub() {
  thread_.request_stop();
  thread_.join();
  for (const int tap : taps_) close(tap);
}

void LossyHub::set(const LinkQuality& quality) {
  const std::lock_guard lock(mutex_);
  quality_ = quality;
}

void LossyHub::set_multicast(bool passes) {
  const std::lock_guard lock(mutex_);
  passes_multicast_ = passes;
}

std::uint64_t LossyHub::carried_bytes() const {
  const std::lock_guard lock(mutex_);
  return carried_bytes_;
}

std::size_t LossyHub::lost() const {
  const std::lock_guard lock(mutex_);
  return lost_;
}

void LossyHub::run(const std::stop_token& stop) {
  std::vector<pollfd> waits;
  for (const int tap : taps_) waits.push_back({tap, POLLIN, 0});
  while (!stop.stop_requested()) {
    int patience_ms = 20;
    if (!under_way_.empty()) {
      const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(under_way_.top().due -
                                                                              Clock::now());
      patience_ms = static_cast<int>(std::clamp<long>(left.count(), 0, patience_ms));
    }
    if (poll(waits.data(), waits.size(), patience_ms) > 0) {
      for (std::size_t i = 0; i < waits.size(); ++i) {
        if ((waits[i].revents & POLLIN) != 0) take(i);
      }
    }
    deliver();
  }
}

/// Every frame that waits in a device.
void LossyHub::take(std::size_t tap) {
  std::array<char, 2048> buffer;
  for (ssize_t got = 0; (got = read(taps_[tap], buffer.data(), buffer.size())) > 0;) {
    const std::lock_guard lock(mutex_);
    // The first byte of the addressee: odd for groups, 255 for everybody.
    const auto addressee = static_cast<unsigned char>(buffer[0]);
    if (!passes_multicast_ && addressee % 2 == 1 && addressee != 255) continue;
    const double draw = static_cast<double>(random_()) / static_cast<double>(std::mt19937::max());
    if (draw < quality_.loss) {
      ++lost_;
      continue;
    }
    carried_bytes_ += static_cast<std::uint64_t>(got);
    under_way_.push(
        {Clock::now() + quality_.delay, frames_++, tap, {buffer.data(), buffer.data() + got}});
  }
}

void LossyHub::deliver() {
  while (!under_way_.empty() && under_way_.top().due <= Clock::now()) {
    const Frame& frame = under_way_.top();
    for (std::size_t i = 0; i < taps_.size(); ++i) {
      if (i == frame.from) continue;
      // A host that is down takes none.
      [[maybe_unused]] const ssize_t written =
          write(taps_[i], frame.bytes.data(), frame.bytes.size());
    }
    under_way_.pop();
  }
}

}  // namespace strata::test
