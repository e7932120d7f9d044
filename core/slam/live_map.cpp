// SPDX-License-Identifier: Apache-2.0
#include "core/slam/live_map.hpp"

#include <utility>

#include "core/beam_filter/beam_filter.hpp"

namespace strata::slam {
namespace {

/// A turn counts as a step of what is so far away.
constexpr double kLever_m = 10.0;

}  // namespace

LiveMap::LiveMap(const beam_filter::BeamFilterConfig& config)
    : config_(config), counts_(config.resolution_m) {
  require_valid(config_, "beam_filter");
}

void LiveMap::count(const PosedScan& scan, const Pose2& map_from_robot, double weight) {
  scratch_.scan = scan.scan;
  scratch_.map_from_robot = map_from_robot;
  counts_.add(scratch_, config_.counting, weight, BeamWeights::kAllStatic);
  has_news_ = true;
}

bool LiveMap::update(const Slam& slam, std::size_t max_moved) {
  std::vector<Counted> now;
  now.reserve(counted_.size() + 1);
  auto before = counted_.cbegin();
  std::size_t moved = 0;
  bool is_done = true;
  slam.visit_mapped([&](const Slam::Mapped& mapped) {
    while (before != counted_.cend() && before->number < mapped.number) ++before;  // forgotten
    if (before == counted_.cend() || before->number != mapped.number) {
      count(*mapped.scan, mapped.map_from_robot, 1.0);
      now.push_back({mapped.number, mapped.map_from_robot});
      return;
    }
    now.push_back(*before++);
    Pose2& counted = now.back().map_from_robot;
    if (displacement_m(counted, mapped.map_from_robot, kLever_m) < 0.5 * config_.resolution_m) {
      return;
    }
    if (moved == max_moved) {
      is_done = false;
      return;
    }
    ++moved;
    has_moves_ = true;
    count(*mapped.scan, counted, -1.0);
    count(*mapped.scan, mapped.map_from_robot, 1.0);
    counted = mapped.map_from_robot;
  });
  counted_ = std::move(now);
  return is_done;
}

bool LiveMap::take_news() { return std::exchange(has_news_, false); }

bool LiveMap::take_moves() { return std::exchange(has_moves_, false); }

ReflectionGrid LiveMap::occupancy() const { return counts_.reflection(config_.min_evidence); }

ReflectionGrid LiveMap::filtered() const {
  return beam_filter::filter_counts(counts_, config_).filtered;
}

}  // namespace strata::slam
