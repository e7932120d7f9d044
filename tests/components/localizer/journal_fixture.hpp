// SPDX-License-Identifier: Apache-2.0
/// A live localizer whose journal is read.
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "components/localizer/journal_replay.hpp"
#include "tests/components/localizer/live_fixture.hpp"

namespace strata::localizer {

class LocalizerJournal : public LiveLocalizer {
 protected:
  using LiveLocalizer::LiveLocalizer;
  using ParameterEvent = rcl_interfaces::msg::ParameterEvent;
  using LabeledScan = strata_msgs::msg::LabeledScan;
  using Poses = std::vector<geometry_msgs::msg::PoseWithCovarianceStamped>;

  /// With a restore point a second.
  void begin(const std::string& model, const std::string& more = "") {
    begin_with(parameters_of(model, false), more);
  }
  void begin_with(std::string parameters, const std::string& more = "") {
    parameters.pop_back();
    start(parameters + ", restore_point_s: 1.0" + more + "}");
    points_.emplace(robot_, "/localizer/_restore_point", "default");
    scans_.emplace(robot_, "/localizer/_journal", "tf");
    ASSERT_TRUE(points_->wait_for_writer());
    ASSERT_TRUE(scans_->wait_for_writer());
  }
  /// Plays so many scans, and returns the poses that came.
  Poses drive(int scans) {
    Poses poses;
    for (int n = 0; n < scans; ++n) poses.push_back(next_pose());
    return poses;
  }
  JournalReplay journal(std::size_t scans) {
    JournalReplay journal;
    for (const LabeledScan& scan : scans_->wait_for(scans)) journal.add(scan);
    for (const ParameterEvent& point : points_->wait_for(1)) journal.add(restore_point(point));
    return journal;
  }
  static std::filesystem::path find_maps(const RestorePoint& point) { return point.maps; }
  JournalReplay::Outcome run(const JournalReplay& journal, int threads = 2) {
    replayed_.clear();
    return journal.run(find_maps, threads, [&](const ReplayedScan& scan, const auto&) {
      geometry_msgs::msg::PoseWithCovarianceStamped pose;
      pose.header(convert::make_header(scan.stamp, "map"));
      pose.pose(convert::to_pose_with_covariance(scan.replayed));
      replayed_.push_back(pose);
    });
  }

  std::optional<test::Collector<ParameterEvent>> points_;
  std::optional<test::Collector<LabeledScan>> scans_;
  Poses replayed_;
};

}  // namespace strata::localizer
