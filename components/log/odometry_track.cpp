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

void OdometryTrack::add(const OdometrySample& sample) {
  const auto place =
      std::upper_bound(samples_.begin(), samples_.end(), sample.stamp,
                       [](Stamp moment, const auto& other) { return moment < other.stamp; });
  samples_.insert(place, sample);
}

void OdometryTrack::forget(double keep_s) {
  if (samples_.empty()) return;
  const Duration keep = Duration::from_seconds(keep_s);
  const Stamp oldest = samples_.back().stamp - keep;
  if (samples_.front().stamp >= oldest - keep) return;
  std::erase_if(samples_, [&](const OdometrySample& sample) { return sample.stamp < oldest; });
}

OdometryTrack::Neighbours OdometryTrack::neighbours(Stamp stamp, double max_gap_s) const {
  const auto after = std::lower_bound(
      samples_.begin(), samples_.end(), stamp,
      [](const OdometrySample& sample, Stamp moment) { return sample.stamp < moment; });
  if (after != samples_.end() && after->stamp == stamp) return {&*after, &*after};
  const auto is_near = [&](const OdometrySample& sample) {
    return std::abs((sample.stamp - stamp).seconds()) <= max_gap_s;
  };
  Neighbours found;
  if (after != samples_.end() && is_near(*after)) found.after = &*after;
  if (after != samples_.begin() && is_near(*(after - 1))) found.before = &*(after - 1);
  return found;
}

std::optional<Pose2> OdometryTrack::between_samples(Stamp stamp, double max_gap_s) const {
  const auto [before, after] = neighbours(stamp, max_gap_s);
  if (before == nullptr || after == nullptr) return std::nullopt;
  if (before == after) return before->odom_from_robot;
  const double t = (stamp - before->stamp).seconds() / (after->stamp - before->stamp).seconds();
  return interpolate(before->odom_from_robot, after->odom_from_robot, t);
}

std::optional<Pose2> OdometryTrack::at(Stamp stamp, double max_gap_s) const {
  if (const auto pose = between_samples(stamp, max_gap_s)) return pose;
  const auto [before, after] = neighbours(stamp, max_gap_s);
  const OdometrySample* nearest = before != nullptr ? before : after;
  return nearest == nullptr ? std::nullopt : std::optional(nearest->odom_from_robot);
}

}  // namespace strata::log
