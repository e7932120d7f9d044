// SPDX-License-Identifier: Apache-2.0
#include "components/fleet/version_maps.hpp"

#include <filesystem>
#include <utility>

#include "components/fleet/scratch.hpp"
#include "components/fleet/versions.hpp"
#include "components/log/content_hash.hpp"
#include "components/maps/maps_folder.hpp"

namespace fs = std::filesystem;

namespace strata::fleet {
namespace {

/// The map that robots localize in, and the one that the gate judges by.
constexpr const char* kGrid = "filtered";

ReflectionGrid grid_in(const fs::path& folder, const std::string& hash, const std::string& place) {
  const memory::Store store = maps::open_for_reading(folder);
  if (store.has_grid(kGrid)) return store.load_reflection_grid(kGrid);
  throw InputError(
      place, "is told relative to version " + log::short_hash(hash) + ", which has no filtered map",
      "set the robot aside (`strata fleet set-aside`); the visit stays on the server");
}

}  // namespace

std::optional<Coding> active_coding(const site::Site& site, double tolerance_cells) {
  const std::optional<std::string> active = site.active();
  if (!active || tolerance_cells <= 0.0) return std::nullopt;
  // A visit that is told relative to something else is lost to whoever reads it.
  const std::string fault = site.fault_of(*active);
  if (!fault.empty()) {
    throw InputError(site.maps_of(*active).string(), "is damaged: " + fault,
                     "take another version, or send visits by themselves");
  }
  const memory::Store store = maps::open_for_reading(site.maps_of(*active));
  if (!store.has_grid(kGrid)) return std::nullopt;
  return Coding{*active, store.load_reflection_grid(kGrid), tolerance_cells};
}

VersionMaps::VersionMaps(Connection& connection, std::string site, const site::Site* local)
    : connection_(connection), site_(std::move(site)), local_(local) {}

const ReflectionGrid& VersionMaps::of(const std::string& hash, const std::string& place) {
  const auto found = maps_.find(hash);
  if (found != maps_.end()) return found->second;
  return maps_.emplace(hash, read(hash, place)).first->second;
}

ReflectionGrid VersionMaps::read(const std::string& hash, const std::string& place) {
  if (local_ != nullptr && local_->has(hash) && local_->fault_of(hash).empty()) {
    return grid_in(local_->maps_of(hash), hash, place);
  }
  if (!version_of(connection_, site_, hash)) {
    throw InputError(place,
                     "is told relative to version " + log::short_hash(hash) +
                         ", which neither the server nor the site here has",
                     "release that version again from a site that has it (`strata fleet release`), "
                     "or set the robot aside (`strata fleet set-aside`); the visit stays on the "
                     "server");
  }
  const Scratch scratch(local_ != nullptr ? local_->folder() / "fetched"
                                          : fs::temp_directory_path() / "strata-fetched");
  fetch(connection_, site_, hash, scratch.folder());
  return grid_in(scratch.folder(), hash, place);
}

}  // namespace strata::fleet
