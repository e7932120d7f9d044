// SPDX-License-Identifier: Apache-2.0
/// Transforms between frames over time, as /tf tells them.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "components/log/set_back_watch.hpp"
#include "components/log/transform_tree.hpp"
#include "core/base/time.hpp"
#include "core/geometry/pose3.hpp"

namespace strata::log {

class TransformHistory {
 public:
  /// keep_s: transforms older than this behind the latest of their frame are forgotten, and all of
  /// them when its clock is set back; 0 keeps all. max_gap_s: how far apart two transforms may be
  /// between which is interpolated, and how far a single one reaches.
  explicit TransformHistory(double keep_s = 0.0, double max_gap_s = 1.0)
      : keep_s_(keep_s), max_gap_s_(max_gap_s) {}

  /// From /tf_static: holds at all times.
  void add_fixed(const std::string& parent, const std::string& child, const Pose3& pose);
  /// From /tf, in any order. O(log n), O(n) when late.
  void add(const std::string& parent, const std::string& child, Stamp stamp, const Pose3& pose);

  /// target_from_source at a moment, interpolated; nothing when the frames are not connected or a
  /// link says nothing of that moment. O(links log n).
  [[nodiscard]] std::optional<Pose3> find(const std::string& target, const std::string& source,
                                          Stamp stamp) const;
  /// Whether some transform names the frame.
  [[nodiscard]] bool knows(const std::string& frame) const;

 private:
  struct Sample {
    Stamp stamp;
    Pose3 pose;
  };
  struct Link {
    std::string parent;
    std::vector<Sample> samples;  ///< by stamp
    SetBackWatch watch;           ///< unless all is kept
    std::optional<Sample> suspect;
  };
  static void insert(Link& link, const Sample& sample);
  void forget(Link& link) const;
  [[nodiscard]] std::optional<Pose3> at(const Link& link, Stamp stamp) const;
  double keep_s_;
  double max_gap_s_;
  TransformTree fixed_;
  std::map<std::string, std::string> fixed_parents_;
  std::map<std::string, Link> links_;  ///< by child
};

}  // namespace strata::log
