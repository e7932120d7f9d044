// SPDX-License-Identifier: Apache-2.0
/// What is odd about a log, noticed while it is mapped, and said in a sentence each.
#pragma once

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/geometry/pose2.hpp"
#include "core/scan/scan.hpp"
#include "core/tracking/scan_findings.hpp"

namespace strata::slam {

/// Counts over all runs. O(1) a scan.
class LogChecks {
 public:
  /// A scan that was left out.
  enum class Skip { kOutOfOrder, kRepeated, kNothing, kNotFinite };
  /// Why an observation cannot be used, by itself; nothing when it can.
  [[nodiscard]] static std::optional<Skip> reason_to_skip(const Observation& observation,
                                                          const Pose2* given_pose);
  /// Whether two scans read the same to the bit; where both read nothing (NaN), too.
  [[nodiscard]] static bool are_same_readings(std::span<const float> a, std::span<const float> b);
  void skip(Skip reason) { ++skips_[static_cast<std::size_t>(reason)]; }
  /// Takes over the scans that another pass over the same log left out.
  void skip_as(const LogChecks& other) {
    std::copy(std::begin(other.skips_), std::end(other.skips_), std::begin(skips_));
  }
  /// A scan that was used; new_run: the first of its run.
  void add(const Scan& scan, bool new_run, const ScanFindings& findings);
  [[nodiscard]] std::size_t skipped() const;
  /// One sentence for each thing that a user should know; empty for a healthy log.
  [[nodiscard]] std::vector<std::string> warnings() const;

  /// For saved states.
  template <class Self, class Archive>
  static void state(Self& self, Archive& archive) {
    for (auto& count : self.skips_) archive(count);
    for (auto* seen : {&self.gaps_, &self.jumps_, &self.stuck_, &self.ambiguous_, &self.unmatched_,
                       &self.empty_, &self.reversed_, &self.few_, &self.heading_open_}) {
      archive(*seen);
    }
    archive(self.scans_);
    archive(self.run_begin_);
    archive(self.last_);
    archive(self.longest_gap_s_);
    archive(self.last_ranges_);
    for (auto* sum :
         {&self.forward_match_, &self.forward_odometry_, &self.turn_match_, &self.turn_odometry_}) {
      archive(*sum);
    }
  }

 private:
  struct Seen {
    std::size_t count = 0;
    double first_s = 0.0;  ///< since the first scan of its run
    void add(double at_s) {
      if (count++ == 0) first_s = at_s;
    }
  };
  std::size_t skips_[4] = {0, 0, 0, 0};
  std::size_t scans_ = 0;
  Stamp run_begin_;
  Stamp last_;
  double longest_gap_s_ = 0.0;
  Seen gaps_;
  Seen jumps_;
  Seen stuck_;
  Seen ambiguous_;
  Seen unmatched_;
  Seen empty_;
  Seen reversed_;
  Seen few_;
  Seen heading_open_;
  std::vector<float> last_ranges_;
  // Agreement of odometry with the matches: sums of odometry x match, and odometry squared.
  double forward_match_ = 0.0;
  double forward_odometry_ = 0.0;
  double turn_match_ = 0.0;
  double turn_odometry_ = 0.0;
};

}  // namespace strata::slam
