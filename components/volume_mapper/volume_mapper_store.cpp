// SPDX-License-Identifier: Apache-2.0
// How the live 3-D map outlives its process.
#include <filesystem>
#include <utility>

#include "components/log/kept_file.hpp"
#include "components/log/whole_file.hpp"
#include "components/volume_mapper/volume_mapper.hpp"

namespace strata::volume_mapper {

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
  if (is_stored && restored(config_.store, restore)) return std::move(*stored);
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

void VolumeMapper::keep() {
  kept_ = std::chrono::steady_clock::now();
  if (lockstep() || config_.store.empty() || !map_ || kept_clouds_ == clouds_) return;
  log::write_whole_file(config_.store, map_->full_file());
  if (has_colors()) log::write_whole_file(color_store(), colors_->file(*map_));
  kept_clouds_ = clouds_;
}

}  // namespace strata::volume_mapper
