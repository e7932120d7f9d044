// SPDX-License-Identifier: Apache-2.0
/// The scans of a robot's scanners, in order of time.
#pragma once

#include <cstddef>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "components/log/joined_scan.hpp"
#include "components/log/set_back_watch.hpp"

namespace strata::runtime {

/// A scan that waits to be joined, without its mounting.
struct WaitingScan {
  std::size_t scanner = 0;  ///< in ScanQueue::scanners()
  log::SensedScan sensed;
  Stamp end;  ///< of its sweep

  [[nodiscard]] Stamp stamp() const { return sensed.scan.stamp; }
};

/// One frame on one topic.
struct Scanner {
  std::size_t topic = 0;
  std::string frame;
  Stamp first;             ///< stamp of its first scan
  bool is_silent = false;  ///< it was waited for in vain, and has said nothing since

  log::SetBackWatch watch = {};
  std::optional<Duration> period = {};
  std::optional<WaitingScan> suspect = {};  ///< by its stamp far too old
};

class ScanQueue {
 public:
  /// So many frames of one topic are scanners, where scans are put in order.
  static constexpr std::size_t kMaxFrames = 32;

  /// orders: false in lockstep, where scans come in order.
  explicit ScanQueue(bool orders) : orders_(orders) {}

  /// Whether `add` may be called: false for a frame that is not known where its topic has
  /// kMaxFrames already, as of a driver that counts in its frame_id. O(scanners).
  [[nodiscard]] bool takes(std::size_t topic, const std::string& frame) const;
  /// set_back: called when the clock was set back, with the first stamp by the new clock, while the
  /// scans by the old one are still here. O(waiting).
  void add(std::size_t topic, log::SensedScan sensed, const std::function<void(Stamp)>& set_back);

  [[nodiscard]] std::size_t size() const { return waiting_.size(); }
  /// The oldest; requires one.
  [[nodiscard]] const WaitingScan& front() const { return waiting_.front(); }
  /// The newest; requires one.
  [[nodiscard]] const WaitingScan& back() const { return waiting_.back(); }
  WaitingScan pop();
  /// Whether no scanner is expected to send an older scan than the front. One that is waited for
  /// longer than two periods becomes silent, and is waited for no more. O(scanners).
  [[nodiscard]] bool is_next();

  [[nodiscard]] const std::vector<Scanner>& scanners() const { return scanners_; }
  /// Whether a silent one goes on under another frame: its topic has one that began later.
  /// O(scanners).
  [[nodiscard]] bool is_replaced(const Scanner& scanner) const;
  /// Scanners, but for those that are replaced. O(scanners squared).
  [[nodiscard]] std::size_t expected() const;
  /// Scans that came after younger ones had gone on; they were dropped.
  [[nodiscard]] std::size_t late() const { return late_; }

 private:
  [[nodiscard]] std::size_t place_of(std::size_t topic, const std::string& frame) const;
  [[nodiscard]] std::size_t scanner_of(std::size_t topic, const std::string& frame, Stamp now);
  void put(WaitingScan waiting);

  bool orders_;
  std::vector<Scanner> scanners_;
  std::deque<WaitingScan> waiting_;  ///< by stamp, then topic
  std::optional<Stamp> newest_gone_;
  std::size_t late_ = 0;
};

}  // namespace strata::runtime
