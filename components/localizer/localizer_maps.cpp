// SPDX-License-Identifier: Apache-2.0
// The maps that the localizer is given, and what it does when others come.
#include <exception>
#include <memory>
#include <string>
#include <system_error>
#include <utility>

#include "components/convert/geometry_messages.hpp"
#include "components/convert/patch_messages.hpp"
#include "components/localizer/filter.hpp"
#include "components/localizer/localizer.hpp"
#include "components/log/content_hash.hpp"
#include "components/maps/maps_folder.hpp"
#include "components/maps/refiner.hpp"

namespace strata::localizer {

LoadedMaps Localizer::make_maps(const std::filesystem::path& folder,
                                const LocalizerComponentConfig& config) {
  LoadedMaps loaded;
  loaded.maps = read_maps(config, folder);
  loaded.model = make_model(config, loaded.maps);
  loaded.refiner = maps::make_refiner(loaded.maps, *loaded.model.descriptor, config.refinement);
  return loaded;
}

void Localizer::on_tick() {
  if (site_desk_) site_desk_->look();
  if (zone_topics_ && zones_fault_ != zone_topics_->fault()) {
    zones_fault_ = zone_topics_->fault();
    if (!zones_fault_.empty()) say(runtime::LogLevel::kError, zones_fault_);
  }
  if (building_) building_->look();
  take_levels();
  if (!map_source_) return;
  if (map_source_->look()) refused_maps_.clear();
  take_folder();
}

void Localizer::take_folder() {
  if (!map_source_) return;
  std::optional<LoadedMaps> loaded;
  try {
    loaded = map_source_->take();
  } catch (const std::exception& error) {  // the maps in use are as good as they were
    refused_maps_ = std::string("newer maps are not used: ") + error.what();
    tell(error);
  }
  if (!loaded) return;
  use_maps(*loaded, std::nullopt);
  make_patch_map(*loaded);
  if (state() == runtime::LifecycleState::kActive) send_patch_map();
  if (live_maps_) live_maps_->begin_with(loaded->maps);
  const std::string name =
      identity_
          ? identity_->version + " (" + log::short_hash(identity_->hash) + ") of " + identity_->id
          : loaded->folder.string();
  say(runtime::LogLevel::kInfo, "localizes in version " + name + " now");
}

void Localizer::offer_patch_map(const LoadedMaps& loaded) {
  if (maps::patches_of(*loaded.model.descriptor, loaded.maps) == nullptr) return;
  publish_patch_map_ = advertise<strata_msgs::msg::PatchMap>("~/patch_map", "latched");
  if (!context().dry_run) make_patch_map(loaded);
}

void Localizer::make_patch_map(const LoadedMaps& loaded) {
  if (!publish_patch_map_) return;
  const patch::PatchMap* patches = maps::patches_of(*loaded.model.descriptor, loaded.maps);
  unsent_patch_map_ = convert::to_message(*patches, now(), config_.map_frame);
}

/// Not before it is active: in a replay, whoever counts on a message has to be there before.
void Localizer::send_patch_map() {
  if (!unsent_patch_map_) return;
  publish_patch_map_(*unsent_patch_map_);
  unsent_patch_map_.reset();
}

void Localizer::offer_site() {
  std::error_code error;
  if (lockstep() || config_.maps.empty() ||
      !std::filesystem::exists(std::filesystem::path(config_.maps) / site::kSiteFile, error)) {
    return;
  }
  const auto publish = advertise<strata_msgs::msg::SiteVersions>("~/site_versions", "latched");
  offer_zones();
  if (context().dry_run) return;
  site_desk_ = std::make_unique<SiteDesk>(
      building_ ? building_->level(levels_->level()).folder : std::filesystem::path(config_.maps),
      full_name(), config_.site_changes, publish);
  if (zone_topics_) {
    site_desk_->watch_with(
        [topics = zone_topics_.get()](const site::Site& site) { topics->tell(site); });
  }
  SiteDesk* desk = site_desk_.get();  // the services end before it
  offer_later<bus::srv::ListSiteVersions>(
      "~/list_versions", [desk](const auto&, auto reply) { desk->list(std::move(reply)); });
  offer_later<bus::srv::ApproveSiteVersion>(
      "~/approve_version",
      [desk](const auto& request, auto reply) { desk->approve(request, std::move(reply)); });
  offer_later<bus::srv::ActivateSiteVersion>(
      "~/activate_version",
      [desk](const auto& request, auto reply) { desk->activate(request, std::move(reply)); });
  offer_later<bus::srv::RollBackSite>("~/roll_back", [desk](const auto& request, auto reply) {
    desk->roll_back(request, std::move(reply));
  });
  offer_later<bus::srv::GetSiteVersionMap>(
      "~/version_map",
      [desk](const auto& request, auto reply) { desk->map_of(request, std::move(reply)); });
}

void Localizer::offer_zones() {
  if (config_.zones.topic.empty()) return;
  zone_topics_ = std::make_unique<ZoneTopics>(
      config_.zones, config_.map_frame,
      [this](site::MaskKind kind) {
        const std::string topic = config_.zones.topic + "/" + site::name_of(kind);
        return advertise_mask(topic, topic + "_info");
      },
      [this] { return now(); });
}

void Localizer::use_maps(const LoadedMaps& loaded, const std::optional<Pose2Gaussian>& start) {
  use_maps(loaded.maps, loaded.model, loaded.refiner, start);
  identity_ = loaded.identity;
  base_ = {loaded.folder, identity_ ? identity_->hash : std::string()};
  refused_maps_.clear();
}

void Localizer::use_maps(const maps::Maps& maps, maps::MapModel model,
                         std::shared_ptr<refinement::PoseRefiner> refiner,
                         const std::optional<Pose2Gaussian>& start) {
  know_maps(maps, std::move(model), std::move(refiner));
  if (localizer_) {
    // A newer map: all that is known of the pose stays, be it one place or many.
    localizer_->set_model(model_.sensor);
    localizer_->set_free_space(maps.filtered);
    return;
  }
  auto filter = make_filter(config_, model_, maps, context().seed, context().threads);
  if (start) {
    filter->initialize(*start);
  } else {
    filter->initialize_global();
  }
  localizer_ = std::move(filter);  // last: in a map without a free cell nothing has begun
}

void Localizer::know_maps(const maps::Maps& maps, maps::MapModel model,
                          std::shared_ptr<refinement::PoseRefiner> refiner) {
  ++maps_taken_;
  identity_.reset();
  model_ = std::move(model);
  interrupt_journal();
  current_map_.emplace(maps, *model_.descriptor, config_.current_map);
  refiner_ = std::move(refiner);
  if (store_ && store_->has_place()) kept_map_ = maps.filtered;
}

std::optional<Pose2Gaussian> Localizer::start_pose() const {
  const std::vector<double>& pose = config_.start.pose;
  if (pose.empty()) return std::nullopt;
  return Pose2Gaussian{Pose2{pose[0], pose[1], pose[2]},
                       pose_covariance(config_.start.stddev_m, config_.start.stddev_rad)};
}

std::optional<Pose2Gaussian> Localizer::place_now(const Observation& observation) const {
  if (!place_) return start_pose();
  Pose2Gaussian place = place_->map_from_robot;
  if (place_->has_odometry && observation.has_odometry) {
    place.mean = place.mean * between(place_->odom_from_robot, observation.odom_from_robot);
  }
  return place;
}

void Localizer::subscribe_maps() {
  live_maps_.emplace(maps::map_models().at(config_.model), config_.map_topics);
  live_maps_->begin_with(no_maps(config_));
  const MapTopicsConfig& topics = config_.map_topics;
  const auto add_from = [this](const std::string& topic) {
    return [this, name = resolve(topic)](const auto& message) {
      live_maps_->keep_apart(journal_ && journal_->is_read());
      // Also while nobody reads: who comes later needs to know what it is.
      live_maps_->add(message, journal_ ? map_message(name, message) : MapMessage{});
    };
  };
  if (live_maps_->needs(maps::MapPart::kOccupancy)) {
    subscribe<nav_msgs::msg::OccupancyGrid>(topics.occupancy, topics.qos,
                                            add_from(topics.occupancy));
  }
  if (live_maps_->needs(maps::MapPart::kFiltered)) {
    subscribe<strata_msgs::msg::ReflectionGrid>(topics.filtered, topics.qos,
                                                add_from(topics.filtered));
  }
  if (live_maps_->needs(maps::MapPart::kPatches)) {
    subscribe<strata_msgs::msg::PatchMap>(topics.patches, topics.qos, add_from(topics.patches));
  }
  if (live_maps_->needs(maps::MapPart::kTimescale)) {
    subscribe<strata_msgs::msg::NodeMap>(topics.nodes, topics.qos, add_from(topics.nodes));
  }
  if (config_.start.pose_topic.empty() || !config_.start.pose.empty()) return;
  subscribe<strata_msgs::msg::ScanPose>(
      config_.start.pose_topic, "default", [this](const auto& message) {
        if (localizer_) return;  // it knows better by now
        if (!is_finite(convert::from_message(message.map_from_robot().mean())) ||
            !is_finite(convert::from_message(message.odom_from_robot()))) {
          throw InputError(resolve(config_.start.pose_topic), "a pose is not finite",
                           "see what publishes it");
        }
        if (store_) store_->forget();  // the mapper has asked its scans
        place_ = Place{{convert::from_message(message.map_from_robot().mean()),
                        pose_covariance(config_.start.stddev_m, config_.start.stddev_rad)},
                       convert::from_message(message.odom_from_robot()),
                       message.has_odometry()};
      });
}

}  // namespace strata::localizer
