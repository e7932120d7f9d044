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

/// Changes with the fields saved: bytes of another version are refused, but for these before: none
/// of them told what beams without return say, and the first counted all scans in one map.
constexpr std::uint64_t kVersion = 0x53'4f'42'46'0000'0004;
constexpr std::uint64_t kWithoutDropOuts = 0x53'4f'42'46'0000'0003;
constexpr std::uint64_t kInOneMap = 0x53'4f'42'46'0000'0002;

}  // namespace

OnlineFilter::OnlineFilter(const BeamFilterConfig& filter, const WindowConfig& window,
                           const NoReturnConfig& no_return)
    : filter_(filter),
      config_(window),
      window_counts_(filter.resolution_m),
      key_counts_(filter.resolution_m),
      drop_outs_(no_return) {
  require_valid(filter, "filter");
  require_valid(window, "window");
  require_valid(no_return, "no_return");
}

std::vector<float> OnlineFilter::add(PosedScan scan) {
  drop_outs_.take(scan);
  const Pose2& pose = scan.map_from_robot;
  const bool moved =
      !last_key_ || has_moved(*last_key_, pose, config_.key_distance_m, config_.key_turn_rad);
  turns_.see(scan.scan, scan.run);
  const bool key = moved && turns_.has_turn();
  if (key) {
    last_key_ = pose;
    turns_.use();
  }
  if (key) {
    key_counts_.add_fading(scan, filter_.counting, BeamWeights::kAllStatic, config_.fade_scans);
  } else {
    count_in_window(scan, 1.0);
  }
  window_.push_back({std::move(scan), key});
  if (window_.size() > static_cast<std::size_t>(config_.scans)) {
    const Entry& oldest = window_.front();
    if (!oldest.key) count_in_window(oldest.scan, -1.0);
    window_.pop_front();
  }
  const PosedScan& newest = window_.back().scan;
  std::vector<float> labels(newest.scan.size(), static_cast<float>(filter_.prior));
  const auto reflection_at = [&](const Cell& cell) {
    CellCounts counts = key_counts_.cells().get(cell);
    const CellCounts& lately = window_counts_.cells().get(cell);
    counts.hits += lately.hits;
    counts.misses += lately.misses;
    return closed_form(counts, filter_.prior, filter_.min_evidence);
  };
  for_each_ray(newest.scan, newest.map_from_laser(), filter_.counting,
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
  writer(window_counts_.cells());
  writer(key_counts_.cells());
  writer(window_);
  writer(last_key_);
  writer(turns_);
  writer(drop_outs_);
  for (const Entry& entry : window_) no_return_state_of(entry.scan.scan, writer);
  return writer.take();
}

void OnlineFilter::restore_state(std::span<const std::uint8_t> bytes, const std::string& place) {
  StateReader reader(bytes, place);
  std::uint64_t version = 0;
  reader(version);
  if (version < kInOneMap || version > kVersion) reader.refuse("is of another version");
  const bool is_in_one_map = version == kInOneMap;
  window_counts_ = CountingMap(filter_.resolution_m);
  if (!is_in_one_map) reader(window_counts_.cells());
  reader(key_counts_.cells());
  if (window_counts_.resolution_m() != filter_.resolution_m ||
      key_counts_.resolution_m() != filter_.resolution_m) {
    reader.refuse("is of another resolution");
  }
  reader(window_);
  reader(last_key_);
  reader(turns_);
  if (version > kWithoutDropOuts) {
    reader(drop_outs_);
    for (Entry& entry : window_) no_return_state_of(entry.scan.scan, reader);
  }
  reader.expect_end();
  if (!is_in_one_map) return;
  for (const Entry& entry : window_) {
    if (entry.key) continue;
    key_counts_.add(entry.scan, filter_.counting, -1.0, BeamWeights::kAllStatic);
    count_in_window(entry.scan, 1.0);
  }
}

void OnlineFilter::count_in_window(const PosedScan& scan, double weight) {
  window_counts_.add(scan, filter_.counting, weight, BeamWeights::kAllStatic);
}

CountingMap OnlineFilter::counts() const {
  CountingMap sum = key_counts_;
  sum.add(window_counts_);
  return sum;
}

ReflectionGrid OnlineFilter::map() const { return filter_counts(counts(), filter_).filtered; }

}  // namespace strata::beam_filter
