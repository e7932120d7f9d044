// SPDX-License-Identifier: Apache-2.0
#include "components/log/odometry_track.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "components/log/set_back_clock.hpp"

namespace strata::log {

void mend_odometry_clock(std::vector<OdometrySample>& samples) {
  std::vector<Stamp> stamps;
  for (const OdometrySample& sample : samples) stamps.push_back(sample.stamp);
  const auto same = [&](std::size_t i, std::size_t j) {
    return samples[i].odom_from_robot == samples[j].odom_from_robot;
  };
  if (mend_set_back_clock(stamps, same).times == 0) return;
  for (std::size_t i = 0; i < samples.size(); ++i) samples[i].stamp = stamps[i];
}

OdometryTrack::OdometryTrack(std::vector<OdometrySample> samples) : samples_(std::move(samples)) {
  std::stable_sort(samples_.begin(), samples_.end(),
                   [](const auto& a, const auto& b) { return a.stamp < b.stamp; });
}

std::optional<Pose2> OdometryTrack::at(Stamp stamp, double max_gap_s) const {
  const auto after = std::lower_bound(
      samples_.begin(), samples_.end(), stamp,
      [](const OdometrySample& sample, Stamp moment) { return sample.stamp < moment; });
  if (after != samples_.end() && after->stamp == stamp) return after->odom_from_robot;
  const auto gap_s = [&](const OdometrySample& sample) {
    return std::abs((sample.stamp - stamp).seconds());
  };
  const bool has_after = after != samples_.end() && gap_s(*after) <= max_gap_s;
  const bool has_before = after != samples_.begin() && gap_s(*(after - 1)) <= max_gap_s;
  if (has_before && has_after) {
    const OdometrySample& before = *(after - 1);
    const double t = (stamp - before.stamp).seconds() / (after->stamp - before.stamp).seconds();
    return interpolate(before.odom_from_robot, after->odom_from_robot, t);
  }
  if (has_before) return (after - 1)->odom_from_robot;
  if (has_after) return after->odom_from_robot;
  return std::nullopt;
}

}  // namespace strata::log
