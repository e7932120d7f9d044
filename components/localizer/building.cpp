// SPDX-License-Identifier: Apache-2.0
#include "components/localizer/building.hpp"

#include <algorithm>
#include <system_error>
#include <utility>

#include "components/site/site.hpp"
#include "core/base/error.hpp"

namespace fs = std::filesystem;

namespace strata::localizer {
namespace {

fs::file_time_type drawn_at(const fs::path& folder) {
  std::error_code error;
  const auto at = fs::last_write_time(folder / site::kZonesFile, error);
  return error ? fs::file_time_type() : at;
}

std::size_t index_of(const std::vector<std::string>& names, const std::string& name) {
  return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
}

}  // namespace

bool is_building(const fs::path& folder) {
  std::error_code error;
  return fs::exists(folder / site::kSiteFile, error) && !site::levels_of(folder).empty();
}

Building::Building(fs::path folder, const MapSource::Make& make)
    : folder_(std::move(folder)), id_(site::Site(folder_).decisions().id) {
  for (site::Level& level : site::levels_of(folder_)) {
    const fs::path place = level.folder;
    levels_.push_back({std::move(level), MapSource(place, make), nullptr});
  }
}

std::vector<std::string> Building::names() const {
  std::vector<std::string> names;
  for (const Floor& floor : levels_) names.push_back(floor.level.name);
  return names;
}

void Building::load() {
  bool has_any = false;
  for (Floor& floor : levels_) {
    if (!site::Site(floor.level.folder).active()) continue;
    floor.maps = std::make_shared<const LoadedMaps>(floor.source.load());
    has_any = true;
  }
  if (!has_any) {
    throw InputError(folder_.string(), "has no level with an active version",
                     "`strata site levels SITE list` says what there is, `strata site activate "
                     "SITE/levels/NAME` takes one");
  }
  drawn_at_ = drawn_at(folder_);
  std::promise<Drawn> drawn;
  drawn.set_value(read_lifts(folder_, names()));
  drawing_ = drawn.get_future();
}

Building::Drawn Building::read_lifts(const fs::path& folder,
                                     const std::vector<std::string>& names) {
  Drawn drawn;
  const auto tell = [&](const std::string& fault) {
    drawn.fault += (drawn.fault.empty() ? "" : "; ") + fault;
  };
  for (const site::Zone& zone : site::Site(folder).zones().zones) {
    if (zone.kind != site::ZoneKind::kLift) {
      tell("zone " + zone.name +
           " of the building does nothing: it is no lift, and belongs to a "
           "level");
      continue;
    }
    localization::Lift lift{zone.shape, {}};
    for (const std::string& name : zone.levels.empty() ? names : zone.levels) {
      const std::size_t level = index_of(names, name);
      if (level < names.size()) {
        lift.levels.push_back(level);
      } else {
        tell("lift " + zone.name + " serves level '" + name + "', which is none");
      }
    }
    drawn.lifts.push_back(std::move(lift));
  }
  return drawn;
}

void Building::look() {
  for (Floor& floor : levels_) (void)floor.source.look();
  if (drawing_.valid()) return;
  const auto now = drawn_at(folder_);
  if (now == drawn_at_) return;
  drawn_at_ = now;
  drawing_ = std::async(std::launch::async, read_lifts, folder_, names());
}

bool Building::take(std::size_t i) {
  std::optional<LoadedMaps> loaded = levels_[i].source.take();
  if (!loaded) return false;
  levels_[i].maps = std::make_shared<const LoadedMaps>(std::move(*loaded));
  return true;
}

std::optional<std::vector<localization::Lift>> Building::take_lifts() {
  if (!drawing_.valid() ||
      drawing_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) {
    return std::nullopt;
  }
  Drawn drawn = drawing_.get();
  lift_fault_ = drawn.fault;
  return std::move(drawn.lifts);
}

localization::LevelMaps Building::filter_maps_of(std::size_t i) const {
  const std::shared_ptr<const LoadedMaps>& maps = levels_[i].maps;
  if (maps == nullptr) return {};
  return {maps->model.sensor, std::shared_ptr<const ReflectionGrid>(maps, &maps->maps.filtered)};
}

std::size_t Building::find(const std::string& name, const std::string& place) const {
  const std::vector<std::string> all = names();
  const std::size_t found = index_of(all, name);
  if (found < all.size()) return found;
  std::string there;
  for (const std::string& one : all) there += (there.empty() ? "" : ", ") + one;
  throw InputError(place, "there is no level '" + name + "'", "choose among " + there);
}

std::optional<std::size_t> Building::with_maps(const std::string& name) const {
  const std::size_t found = index_of(names(), name);
  if (found >= levels_.size() || levels_[found].maps == nullptr) return std::nullopt;
  return found;
}

std::string Building::fault() const {
  std::string fault = lift_fault_;
  for (const Floor& floor : levels_) {
    if (floor.maps != nullptr) continue;
    fault += (fault.empty() ? "" : "; ") + ("level " + floor.level.name + " has no active version");
  }
  return fault;
}

}  // namespace strata::localizer
