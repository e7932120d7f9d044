// SPDX-License-Identifier: Apache-2.0
// What Slam holds, as bytes and back.
#include <algorithm>
#include <cstdint>

#include "core/geometry/matrix_state.hpp"
#include "core/grid/grid_state.hpp"
#include "core/scan/scan_state.hpp"
#include "core/slam/slam_state.hpp"

namespace strata::slam {
namespace {

/// Changes with the fields of the classes saved: bytes of another version are refused.
constexpr std::uint64_t kVersion = 0x53'53'4c'4d'0000'0005;

}  // namespace

std::vector<std::uint8_t> Slam::save_state() const {
  StateWriter writer;
  writer(kVersion);
  writer(state_->config.beam_filter.resolution_m);
  State::state(std::as_const(*state_), writer);
  writer(state_->tracker.has_value());
  if (state_->tracker) writer(*state_->tracker);
  return writer.take();
}

void Slam::restore_state(std::span<const std::uint8_t> bytes, const std::string& place) {
  StateReader reader(bytes, place);
  reader.expect_version(kVersion);
  const double resolution_m = state_->config.beam_filter.resolution_m;
  double saved_resolution_m = 0.0;
  reader(saved_resolution_m);
  if (saved_resolution_m != resolution_m) reader.refuse("is of another resolution");
  State& state = *state_;
  State::state(state, reader);
  bool has_tracker = false;
  reader(has_tracker);
  if (has_tracker) {
    state.tracker.emplace(state.config.tracking, resolution_m, state.run, Pose2());
    reader(*state.tracker);
  }
  reader.expect_end();
  const auto is_placed = [&](const Record& record) {
    return record.local_map == kNoLocalMap || record.local_map < state.graph.size();
  };
  bool is_sound = state.graph.is_sound() &&
                  (!state.tracker || state.tracker->is_sound(state.accepted)) &&
                  (state.records.empty() || state.records.back().number < state.accepted);
  for (std::size_t i = 0; i < state.graph.size(); ++i) {
    is_sound = is_sound && state.graph.local_map(i).is_of(state.accepted);
  }
  is_sound = is_sound && std::all_of(state.records.begin(), state.records.end(), is_placed) &&
             std::is_sorted(state.records.begin(), state.records.end(),
                            [](const Record& a, const Record& b) { return a.number < b.number; });
  if (!is_sound) reader.fail("does not fit together");
}

std::optional<Slam::Newest> Slam::newest() const {
  if (state_->records.empty()) return std::nullopt;
  const Record& record = state_->records.back();
  Pose2 pose = state_->map_from_run * record.run_from_robot;
  if (record.given) pose = *record.given;
  return Newest{record.posed.run, record.posed.scan.stamp, record.odometry, pose,
                state_->pose_now(record).has_value()};
}

std::optional<Pose2> Slam::State::pose_now(const Record& record) const {
  if (stays(record)) return record.given;
  if (record.local_map != kNoLocalMap) {
    if (!graph.located(record.local_map)) return std::nullopt;
    return graph.map_from_run(record.local_map) * record.run_from_robot;
  }
  // Of a local map under construction.
  const bool begun_there = std::any_of(begun_at.begin(), begun_at.end(), [&](const auto& known) {
    return known.first == record.posed.run;
  });
  const bool has_local_map = graph.size() > 0 && graph.local_map(graph.size() - 1).run == run;
  const bool is_placed = runs == 1 || begun_there || run_is_given ||
                         (has_local_map && graph.located(graph.size() - 1));
  if (record.posed.run != run || !is_placed) return std::nullopt;
  return map_from_run * record.run_from_robot;
}

void Slam::State::visit(bool keys_only, const std::function<void(const Mapped&)>& visit) const {
  for (const Record& record : records) {
    if (keys_only && !record.key) continue;
    const std::optional<Pose2> pose = pose_now(record);
    if (pose) visit({record.number, &record.posed, *pose});
  }
}

void Slam::visit_mapped(const std::function<void(const Mapped&)>& visit) const {
  state_->visit(true, visit);
}

void Slam::visit_kept(const std::function<void(const Mapped&)>& visit) const {
  state_->visit(false, visit);
}

}  // namespace strata::slam
