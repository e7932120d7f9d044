// SPDX-License-Identifier: Apache-2.0
/// The maps that a folder's name leads to, while the robot drives: when a link leads elsewhere, as
/// a site's does when another version is activated, they are loaded beside and taken when ready.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <future>
#include <memory>
#include <optional>

#include "components/maps/map_model.hpp"
#include "components/maps/maps_folder.hpp"
#include "components/maps/refiner.hpp"
#include "components/site/active_maps.hpp"

namespace strata::localizer {

/// Maps, and all that takes long to make of them.
struct LoadedMaps {
  maps::Maps maps;
  maps::MapModel model;
  std::shared_ptr<refinement::PoseRefiner> refiner;
  std::filesystem::path folder;  ///< without links
  std::optional<site::MapIdentity> identity;
};

class MapSource {
 public:
  /// What is made of a folder of maps; called on a thread of its own.
  using Make = std::function<LoadedMaps(const std::filesystem::path& folder)>;

  /// named: a MAPS folder, a link to one, or a site.
  MapSource(std::filesystem::path named, Make make)
      : named_(std::move(named)), make_(std::move(make)) {}

  /// What it leads to now. Throws InputError and what `make` throws.
  [[nodiscard]] LoadedMaps load();
  /// Begins to load when the name leads elsewhere than to what was loaded last; what could not be
  /// loaded is tried again after a while. Whether it leads to what was loaded last. Returns at
  /// once.
  bool look();
  /// What was loaded since, when it is ready. Throws what loading it threw, once. Returns at once.
  [[nodiscard]] std::optional<LoadedMaps> take();

 private:
  [[nodiscard]] static LoadedMaps load(const std::filesystem::path& folder, const Make& make);

  std::filesystem::path named_;
  Make make_;
  std::filesystem::path taken_;    ///< the folder that the robot is localized in
  std::filesystem::path refused_;  ///< that could not be loaded
  std::chrono::steady_clock::time_point refused_at_;
  std::future<LoadedMaps> loading_;  ///< last: its thread is waited for first
};

}  // namespace strata::localizer
