// SPDX-License-Identifier: Apache-2.0
/// What a component does with a saved state that it took: goes on with it.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <stdexcept>
#include <vector>

#include "core/beam_filter/online_filter.hpp"
#include "core/patch/online_learner.hpp"
#include "core/slam/slam.hpp"

namespace strata::fuzz {

enum class Ahead : std::uint8_t { kWall, kOpening, kNothing };

/// A wall 2 m ahead, with an opening or not, or nothing at all.
inline Scan scan_of(int step, Ahead ahead) {
  Scan scan;
  scan.stamp = Stamp::from_seconds(2e9 + 0.5 * step);
  scan.angle_min_rad = -0.7F;
  scan.angle_increment_rad = 0.07F;
  scan.range_max_m = 10.0F;
  for (int beam = 0; beam < 20; ++beam) {
    const float range_m = 2.0F / std::cos(-0.7F + 0.07F * static_cast<float>(beam));
    const bool is_through = ahead == Ahead::kOpening && beam > 6 && beam < 13;
    scan.ranges_m.push_back(ahead == Ahead::kNothing ? std::numeric_limits<float>::infinity()
                            : is_through             ? 4.0F
                                                     : range_m);
  }
  return scan;
}

inline std::unique_ptr<patch::OnlinePatchLearner> new_learner() {
  patch::PatchLearnerConfig config;
  config.sequences.min_scans = 1;
  return std::make_unique<patch::OnlinePatchLearner>(config, patch::OnlineConfig{},
                                                     make_reflection_grid(0.05, CellRect{}));
}
/// The scans of a life see the wall, open in every other visit, unless told what else.
inline Ahead ahead_of(int visit, Ahead fixed) {
  return fixed != Ahead::kOpening || visit % 2 == 1 ? fixed : Ahead::kWall;
}
inline void go_on(patch::OnlinePatchLearner& learner, Ahead ahead = Ahead::kOpening) {
  const int run = learner.last_run() < 1'000'000 ? learner.last_run() + 1 : 0;
  for (int step = 0; step < 24; ++step) {
    const int visit = step / 6;
    (void)learner.add({run, scan_of(step + 100 * visit, ahead_of(visit, ahead)), Pose2{}, {}});
  }
  (void)learner.finish();
}

inline std::unique_ptr<beam_filter::OnlineFilter> new_filter() {
  return std::make_unique<beam_filter::OnlineFilter>();
}
inline void go_on(beam_filter::OnlineFilter& filter, Ahead ahead = Ahead::kOpening) {
  for (int step = 0; step < 6; ++step) {
    const Pose2 pose{0.3 * step, 0.0, 0.1 * step};
    (void)filter.add({0, scan_of(step, ahead_of(step, ahead)), pose, {}});
  }
  (void)filter.map();
}

inline std::unique_ptr<slam::Slam> new_slam() {
  return std::make_unique<slam::Slam>(slam::SlamConfig{});
}
inline void go_on(slam::Slam& slam, Ahead ahead = Ahead::kWall) {
  const auto newest = slam.newest();
  for (int step = 0; step < 6; ++step) {
    Observation observation;
    observation.run = newest && newest->run < 1'000'000 ? newest->run : 0;
    observation.scan = scan_of(step, ahead);
    observation.has_odometry = true;
    observation.odom_from_robot = {0.1 * step, 0.0, 0.0};
    (void)slam.add(observation);
  }
  slam.visit_mapped([](const slam::Slam::Mapped&) {});
}

/// Restores the bytes into a new object, saves and restores that, goes on with it, and saves and
/// restores it again. Throws Error when the bytes are refused; std::logic_error when what it
/// saved itself is.
template <typename Make>
void restore_and_go_on(std::span<const std::uint8_t> bytes, const Make& make) {
  const auto restored = make();
  restored->restore_state(bytes, "fuzzed");
  const auto save = [&] {
    try {
      make()->restore_state(restored->save_state(), "saved");
    } catch (const Error& error) {
      throw std::logic_error(error.what());
    }
  };
  save();
  go_on(*restored);
  save();
}

}  // namespace strata::fuzz
