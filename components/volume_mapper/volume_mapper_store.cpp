// SPDX-License-Identifier: Apache-2.0
// How the live 3-D map outlives its process.
#include <filesystem>
#include <system_error>
#include <utility>

#include "components/log/damaged_file.hpp"
#include "components/log/kept_file.hpp"
#include "components/log/whole_file.hpp"
#include "components/volume_mapper/volume_mapper.hpp"

namespace strata::volume_mapper {
namespace {

/// So long after a start nothing is written while it may be of another frame.
constexpr std::chrono::seconds kLongestDoubt(20);

}  // namespace

volume::VolumeMap VolumeMapper::first_map() {
  std::optional<volume::VolumeMap> stored;
  std::error_code error;
  const bool is_stored =
      !lockstep() && !config_.store.empty() && std::filesystem::exists(config_.store, error);
  if (is_stored) log::require_own_file(config_.store, log::kOctree, "store");
  // What cannot be read must not be written over: then there is no start.
  const auto restore = [&] {
    stored.emplace(volume::VolumeMap::from_file(log::read_whole_file(config_.store), config_.store,
                                                config_.map));
  };
  if (is_stored && restored(config_.store, restore)) {
    if (stored->size().leaves > 0) frame_.emplace(FrameCheck{volume::StoredColumns(*stored), {}});
    return std::move(*stored);
  }
  return volume::VolumeMap(config_.map);
}

std::filesystem::path VolumeMapper::color_store() const {
  std::filesystem::path path = config_.store;
  return path.replace_filename(path.stem().string() + "_color.ot");
}

volume::PointColors VolumeMapper::first_colors() {
  volume::PointColors stored(config_.map);
  std::error_code error;
  const bool is_stored =
      !lockstep() && !config_.store.empty() && std::filesystem::exists(color_store(), error);
  if (!is_stored) return stored;
  const std::string path = color_store().string();
  log::require_own_file(path, log::kOctree, "store");
  const bool is_sound = restored(path, [&] { stored.restore(log::read_whole_file(path), path); });
  return is_sound ? std::move(stored) : volume::PointColors(config_.map);
}

void VolumeMapper::check_frame(const volume::Cloud& cloud) {
  const Eigen::Vector2d place_m = cloud.map_from_sensor.translation.head<2>();
  const auto verdict = frame_->watch.add(place_m, frame_->columns.agreement(cloud));
  if (verdict == FrameWatch::Verdict::kOpen) return;
  frame_.reset();
  if (verdict == FrameWatch::Verdict::kOther) begin_anew();
}

void VolumeMapper::begin_anew() {
  // What was entered since the start is of the other frame, and clouds go on coming.
  map_.emplace(config_.map);
  if (colors_) colors_.emplace(config_.map);
  is_store_foreign_ = true;  // where it cannot be set aside, it stays, and is gone on in RAM only
  guarded([this] {
    std::error_code error;
    if (std::filesystem::exists(color_store(), error)) (void)log::set_aside(color_store());
    warn(log::other_frame(config_.store, log::set_aside(config_.store)));
    is_store_foreign_ = false;
  });
}

bool VolumeMapper::may_keep() const {
  return !frame_ || !frame_->watch.is_in_doubt() ||
         std::chrono::steady_clock::now() - frame_->since > kLongestDoubt;
}

void VolumeMapper::keep() {
  kept_ = std::chrono::steady_clock::now();
  if (lockstep() || config_.store.empty() || is_store_foreign_ || !map_ || kept_clouds_ == clouds_)
    return;
  log::write_whole_file(config_.store, map_->full_file());
  if (has_colors()) log::write_whole_file(color_store(), colors_->file(*map_));
  kept_clouds_ = clouds_;
}

}  // namespace strata::volume_mapper
