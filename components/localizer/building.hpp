// SPDX-License-Identifier: Apache-2.0
/// The levels of a building as a localizer uses them: their maps, which may change while it drives,
/// and the lifts between them.
#pragma once

#include <cstddef>
#include <filesystem>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "components/localizer/map_source.hpp"
#include "components/site/level.hpp"
#include "core/localization/level_localizer.hpp"

namespace strata::localizer {

/// Whether a folder is a site with levels. Throws InputError for a damaged level.
[[nodiscard]] bool is_building(const std::filesystem::path& folder);

class Building {
 public:
  /// Throws InputError as site::levels_of.
  Building(std::filesystem::path folder, const MapSource::Make& make);

  /// Reads the maps of every level that has an active version, and the lifts. Throws InputError
  /// where none has one, and what `make` throws.
  void load();
  /// Begins to load what others have activated, or drawn, since. Returns at once.
  void look();
  /// Whether the level has other maps since the last call, which it does not have without one.
  /// Throws, once, what loading them threw; then it keeps those that it has.
  [[nodiscard]] bool take(std::size_t i);
  /// The lifts, where they were drawn anew since the last call. Throws InputError, once.
  [[nodiscard]] std::optional<std::vector<localization::Lift>> take_lifts();

  [[nodiscard]] const std::string& id() const { return id_; }  ///< VDA 5050's mapId
  [[nodiscard]] std::size_t size() const { return levels_.size(); }
  [[nodiscard]] const site::Level& level(std::size_t i) const { return levels_[i].level; }
  /// Null while it has none.
  [[nodiscard]] const LoadedMaps* maps_of(std::size_t i) const { return levels_[i].maps.get(); }
  [[nodiscard]] localization::LevelMaps filter_maps_of(std::size_t i) const;
  /// Throws InputError at `place` where there is no such level.
  [[nodiscard]] std::size_t find(const std::string& name, const std::string& place) const;
  /// The level of that name, where there is one and it has maps.
  [[nodiscard]] std::optional<std::size_t> with_maps(const std::string& name) const;
  /// For people: what levels lack maps, and what lifts serve levels that are none; may be empty.
  [[nodiscard]] std::string fault() const;

 private:
  struct Floor {
    site::Level level;
    MapSource source;
    std::shared_ptr<const LoadedMaps> maps;
  };
  struct Drawn {
    std::vector<localization::Lift> lifts;
    std::string fault;
  };
  [[nodiscard]] static Drawn read_lifts(const std::filesystem::path& folder,
                                        const std::vector<std::string>& names);
  [[nodiscard]] std::vector<std::string> names() const;

  std::filesystem::path folder_;
  std::string id_;
  std::vector<Floor> levels_;
  std::string lift_fault_;
  std::filesystem::file_time_type drawn_at_;  ///< of the zones that were read last
  std::future<Drawn> drawing_;                ///< last: its thread is waited for first
};

}  // namespace strata::localizer
