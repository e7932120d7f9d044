// SPDX-License-Identifier: Apache-2.0
// The levels of a building.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <system_error>
#include <tuple>

#include <nlohmann/json.hpp>

#include "components/log/whole_file.hpp"
#include "components/site/site_change.hpp"
#include "core/base/error.hpp"

namespace fs = std::filesystem;

namespace strata::site {
namespace {

constexpr std::size_t kMaxNameBytes = 64;
constexpr double kMaxElevation_m = 10'000.0;
constexpr const char* kElevation = "elevation_m";

void require_level_name(const std::string& name) {
  const auto fits = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-' || c == '.';
  };
  if (!name.empty() && name.size() <= kMaxNameBytes && name.front() != '.' &&
      std::all_of(name.begin(), name.end(), fits)) {
    return;
  }
  throw InputError("NAME", "'" + name.substr(0, kMaxNameBytes) + "' cannot name a level",
                   "use letters, digits, '-', '_' and '.'");
}

Level read_level(const fs::path& folder) {
  const fs::path file = folder / kLevelFile;
  std::ifstream in(file);
  const auto read = nlohmann::json::parse(in, nullptr, false);
  const bool is_whole = read.is_object() && read.contains(kElevation) &&
                        read[kElevation].is_number() &&
                        std::abs(read[kElevation].get<double>()) <= kMaxElevation_m;
  if (!is_whole) {
    throw InputError(file.string(), "does not say how high the level is",
                     "write {\"elevation_m\": 0.0} there");
  }
  return {folder.filename().string(), read[kElevation].get<double>(), folder};
}

}  // namespace

std::vector<Level> levels_of(const fs::path& site) {
  std::vector<Level> levels;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(site / kLevelsFolder, error)) {
    const bool is_hidden = entry.path().filename().string().starts_with(".");
    std::error_code none;
    if (is_hidden || !fs::exists(entry.path() / kSiteFile, none)) continue;
    levels.push_back(read_level(entry.path()));
  }
  std::sort(levels.begin(), levels.end(), [](const Level& a, const Level& b) {
    return std::tie(a.elevation_m, a.name) < std::tie(b.elevation_m, b.name);
  });
  return levels;
}

std::vector<Level> Site::levels() const { return levels_of(folder_); }

Level Site::add_level(const std::string& name, double elevation_m, const std::string& id,
                      const Actor& actor) {
  require_level_name(name);
  if (!(std::abs(elevation_m) <= kMaxElevation_m)) {
    throw InputError("--elevation", "is no height of a floor", "give metres");
  }
  Change decided(*this);
  std::error_code error;
  if (fs::exists(folder_ / kLevelFile, error)) {
    throw InputError(folder_.string(), "is a level itself", "add levels to the building");
  }
  if (!versions(decided.decisions).empty()) {
    throw InputError(folder_.string(), "has maps of its own, and no levels",
                     "make another site for the building, and add " +
                         (folder_ / kActiveLink).string() + " to a level of it");
  }
  const fs::path place = folder_ / kLevelsFolder / name;
  if (fs::exists(place, error)) {
    throw InputError(place.string(), "is there already", "name the level otherwise");
  }
  // Made aside: a level that cannot say how high it is would be none.
  const fs::path aside = log::staged_name(place);
  log::remove_left_over(place);
  fs::create_directories(place.parent_path(), error);
  (void)Site::create(aside, id, decided.decisions.frame, actor, *disk_);
  log::WholeFile file(aside / kLevelFile, *disk_);
  file.stream() << nlohmann::json{{kElevation, elevation_m}}.dump() << "\n";
  file.commit();
  disk_->rename(aside, place);
  disk_->sync(place.parent_path());
  add_event(decided.decisions, "level", "", actor, "added " + name);
  decided.commit();
  return {name, elevation_m, place};
}

void Site::remove_level(const std::string& name, const Actor& actor) {
  require_level_name(name);
  Change decided(*this);
  const fs::path place = folder_ / kLevelsFolder / name;
  std::error_code error;
  if (!fs::exists(place / kSiteFile, error)) {
    throw InputError(folder_.string(), "has no level '" + name + "'",
                     "`strata site levels SITE list` says which there are");
  }
  if (!Site(place, *disk_).versions().empty()) {
    throw InputError(place.string(), "has versions of maps",
                     "move the folder away by hand if nobody needs them");
  }
  const fs::path aside = log::staged_name(place);
  disk_->rename(place, aside);
  disk_->sync(place.parent_path());
  disk_->remove(aside);
  add_event(decided.decisions, "level", "", actor, "removed " + name);
  decided.commit();
}

}  // namespace strata::site
