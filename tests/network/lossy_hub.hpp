// SPDX-License-Identifier: Apache-2.0
/// An Ethernet hub made of TAP devices, which loses and delays frames as it is told. It takes the
/// place of `tc netem`, which many kernels are built without, and loses the same share everywhere.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <queue>
#include <random>
#include <thread>
#include <vector>

namespace strata::test {

struct LinkQuality {
  double loss = 0.0;  ///< share of the frames that do not arrive
  std::chrono::milliseconds delay{0};
};

class LossyHub {
 public:
  /// Takes the TAP devices over; every frame of one goes to all others.
  explicit LossyHub(std::vector<int> taps);
  ~LossyHub();
  LossyHub(const LossyHub&) = delete;
  LossyHub& operator=(const LossyHub&) = delete;

  /// For frames from now on.
  void set(const LinkQuality& quality);
  /// Whether it passes frames to groups on; those to everybody (ARP) it does in any case.
  void set_multicast(bool passes);
  [[nodiscard]] std::size_t lost() const;
  /// Of all frames that were not lost, once each.
  [[nodiscard]] std::uint64_t carried_bytes() const;

 private:
  using Clock = std::chrono::steady_clock;
  struct Frame {
    Clock::time_point due;
    std::uint64_t number = 0;  // keeps the order of frames that are due at once
    std::size_t from = 0;
    std::vector<char> bytes;
    bool operator>(const Frame& other) const {
      return due != other.due ? due > other.due : number > other.number;
    }
  };
  void run(const std::stop_token& stop);
  void take(std::size_t tap);
  void deliver();

  std::vector<int> taps_;
  mutable std::mutex mutex_;  // of the next four
  LinkQuality quality_;
  bool passes_multicast_ = true;
  std::size_t lost_ = 0;
  std::uint64_t carried_bytes_ = 0;
  std::mt19937 random_{7};  // NOLINT(cert-msc32-c,cert-msc51-cpp): the same losses every time
  std::uint64_t frames_ = 0;
  std::priority_queue<Frame, std::vector<Frame>, std::greater<>> under_way_;
  std::jthread thread_;
};

}  // namespace strata::test
