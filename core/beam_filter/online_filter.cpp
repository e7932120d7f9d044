// SPDX-License-Identifier: Apache-2.0
#include "core/beam_filter/online_filter.hpp"

#include <cmath>
#include <limits>
#include <utility>

#include "core/beam_filter/beam_filter.hpp"
#include "core/grid/grid_state.hpp"
#include "core/scan/scan_state.hpp"

namespace strata::beam_filter {
namespace {

/// Changes with the fields saved: bytes of another version are refused.
constexpr std::uint64_t kVersion = 0x53'4f'42'46'0000'0002;

}  // namespace

OnlineFilter::OnlineFilter(const BeamFilterConfig& filter, const WindowConfig& window)
    : filter_(filter), config_(window), counts_(filter.resolution_m) {
  require_valid(filter, "filter");
  require_valid(window, "window");
}

std::vector<float> OnlineFilter::add(const PosedScan& scan) {
  const Pose2& pose = scan.map_from_robot;
  const bool moved =
      !last_key_ || has_moved(*last_key_, pose, config_.key_distance_m, config_.key_turn_rad);
  turns_.see(scan.scan, scan.run);
  const bool key = moved && turns_.has_turn();
  if (key) {
    last_key_ = pose;
    turns_.use();
  }
  counts_.add(scan, filter_.counting, 1.0, BeamWeights::kAllStatic);
  window_.push_back({scan, key});
  if (window_.size() > static_cast<std::size_t>(config_.scans)) {
    const Entry& oldest = window_.front();
    if (!oldest.key) counts_.add(oldest.scan, filter_.counting, -1.0, BeamWeights::kAllStatic);
    window_.pop_front();
  }
  std::vector<float> labels(scan.scan.size(), static_cast<float>(filter_.prior));
  const auto reflection_at = [&](const Cell& cell) {
    return closed_form(counts_.cells().get(cell), filter_.prior, filter_.min_evidence);
  };
  for_each_ray(scan.scan, scan.map_from_laser(), filter_.counting,
               [&](std::size_t beam, const Ray& ray) {
                 if (!ray.is_hit) return;
                 const double m = judging_reflection(cell_at(ray.to_m, filter_.resolution_m),
                                                     filter_.endpoint_tolerance, reflection_at);
                 if (std::isnan(m)) return;
                 labels[beam] = static_cast<float>(expectation(m, filter_.prior));
               });
  return labels;
}

std::vector<std::uint8_t> OnlineFilter::save_state() const {
  StateWriter writer;
  writer(kVersion);
  writer(counts_.cells());
  writer(window_);
  writer(last_key_);
  writer(turns_);
  return writer.take();
}

void OnlineFilter::restore_state(std::span<const std::uint8_t> bytes, const std::string& place) {
  StateReader reader(bytes, place);
  reader.expect_version(kVersion);
  reader(counts_.cells());
  if (counts_.resolution_m() != filter_.resolution_m) reader.refuse("is of another resolution");
  reader(window_);
  reader(last_key_);
  reader(turns_);
  reader.expect_end();
}

ReflectionGrid OnlineFilter::map() const { return filter_counts(counts_, filter_).filtered; }

}  // namespace strata::beam_filter
