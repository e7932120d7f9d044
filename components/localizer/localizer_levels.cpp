// SPDX-License-Identifier: Apache-2.0
// What the localizer does where its maps are those of a building.
#include <exception>
#include <utility>

#include "components/convert/geometry_messages.hpp"
#include "components/localizer/localizer.hpp"
#include "core/base/error.hpp"

namespace strata::localizer {

const LoadedMaps& Localizer::begin_levels(const std::optional<Pose2Gaussian>& start) {
  if (config_.map_topics.follow) {
    throw ConfigError("map_topics.follow", "does not go with maps that have levels",
                      "leave it out, or name the folder of one level");
  }
  building_ = std::make_unique<Building>(
      config_.maps,
      [config = config_](const std::filesystem::path& f) { return make_maps(f, config); });
  building_->load();
  std::vector<localization::LevelMaps> maps;
  for (std::size_t i = 0; i < building_->size(); ++i) maps.push_back(building_->filter_maps_of(i));
  levels_ = std::make_unique<localization::LevelLocalizer>(
      config_.localizer, config_.levels, std::move(maps), context().seed, context().threads);
  begin_on_level(start);
  if (auto lifts = building_->take_lifts()) levels_->set_lifts(std::move(*lifts));
  use_level();
  return *building_->maps_of(levels_->level());
}

void Localizer::begin_on_level(const std::optional<Pose2Gaussian>& start) {
  std::optional<std::size_t> level;
  if (!config_.start.level.empty()) level = building_->find(config_.start.level, "start.level");
  const std::string kept = store_ ? store_->level() : std::string();
  if (!kept.empty()) {
    level = building_->with_maps(kept);
    if (!level) {  // it may well be there still, and no map can tell
      tell(InputError(config_.start.store.file,
                      "the robot was on level '" + kept + "', which has no active version",
                      "activate one, or tell where the robot is by " + resolve("~/set_level")));
      store_->forget();
      levels_->initialize_global();
      levels_->doubt_level();
      return;
    }
  }
  if (level && building_->maps_of(*level) == nullptr) {
    throw InputError("start.level",
                     "level '" + config_.start.level +
                         "' has no active version: the robot would be taken to be on another one",
                     "activate one with `strata site activate SITE/levels/" + config_.start.level +
                         "`, or leave it out");
  }
  if (start) {
    levels_->initialize(*start, level);
  } else {
    levels_->initialize_global(level);
  }
}

void Localizer::use_level() {
  const LoadedMaps& loaded = *building_->maps_of(levels_->level());
  know_maps(loaded.maps, loaded.model, loaded.refiner);
  identity_ = loaded.identity;
  base_ = {loaded.folder, identity_ ? identity_->hash : std::string()};
  localizer_ = levels_->filter();
  make_patch_map(loaded);
  if (state() == runtime::LifecycleState::kActive) send_patch_map();
  if (site_desk_) site_desk_->move_to(building_->level(levels_->level()).folder);
}

void Localizer::take_levels() {
  if (!building_) return;
  // What is in use is as good as it was; and one level's fault is not another's.
  const auto take = [this](std::size_t i, const auto& body) {
    try {
      if (body()) refused_levels_.erase(i);
    } catch (const std::exception& error) {
      refused_levels_[i] = std::string("newer maps or lifts are not used: ") + error.what();
      tell(error);
    }
  };
  const std::size_t levels = building_->size();
  for (std::size_t i = 0; i < levels; ++i) take(i, [this, i] { return take_level(i); });
  take(levels, [this] {
    auto lifts = building_->take_lifts();
    if (lifts) levels_->set_lifts(std::move(*lifts));
    return lifts.has_value();
  });
  refused_maps_.clear();
  for (const auto& [level, why] : refused_levels_) {
    refused_maps_ += (refused_maps_.empty() ? "" : "; ") + why;
  }
}

bool Localizer::take_level(std::size_t i) {
  if (!building_->take(i)) return false;
  levels_->set_maps(i, building_->filter_maps_of(i));
  if (i == levels_->level()) use_level();
  say(runtime::LogLevel::kInfo, "has other maps of level " + building_->level(i).name + " now");
  return true;
}

void Localizer::offer_levels() {
  if (!building_) return;
  publish_level_ = advertise<strata_msgs::msg::SiteLevel>("~/level", "latched");
  offer<bus::srv::SetSiteLevel>("~/set_level", [this](const auto& request) {
    strata_msgs::srv::SetSiteLevel_Response response;
    try {
      if (request.level().empty()) {
        restart_anywhere();
      } else {
        levels_->tell_level(building_->find(request.level(), resolve("~/set_level")));
        use_level();
      }
      response.success(true);
      response.message(request.level().empty() ? "looks on all levels"
                                               : "is on level " + request.level());
    } catch (const InputError& error) {
      response.message(error.what());
    }
    return response;
  });
}

void Localizer::publish_level(Stamp stamp) {
  if (!levels_) return;
  const site::Level& level = building_->level(levels_->level());
  strata_msgs::msg::SiteLevel message;
  message.site(building_->id());
  message.level(level.name);
  if (identity_) message.map_id(identity_->id);
  message.elevation(level.elevation_m);
  message.certain(levels_->is_level_sure());
  message.in_lift(levels_->is_in_lift());
  if (message == told_level_) return;
  told_level_ = message;
  message.header(convert::make_header(stamp, config_.map_frame));
  for (const localization::LevelBelief& belief : levels_->beliefs()) {
    message.candidates().push_back(building_->level(belief.level).name);
    message.probabilities().push_back(belief.probability);
  }
  publish_level_(message);
}

void Localizer::diagnose_level(runtime::Health& health) const {
  if (!levels_) return;
  health.add("level", building_->level(levels_->level()).name);
  health.add("level_certain", std::string(levels_->is_level_sure() ? "true" : "false"));
  health.add("in_lift", std::string(levels_->is_in_lift() ? "true" : "false"));
  if (!levels_->is_level_sure()) {
    std::string names;
    for (const localization::LevelBelief& belief : levels_->beliefs()) {
      names += (names.empty() ? "" : ", ") + building_->level(belief.level).name;
    }
    const std::string text = "the level is not certain, the likeliest first: " + names;
    if (levels_->is_in_lift()) {
      health.add("levels", text);
    } else {
      health.warn(text);
    }
  }
  if (const std::string fault = building_->fault(); !fault.empty()) health.warn(fault);
}

}  // namespace strata::localizer
