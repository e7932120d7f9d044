// SPDX-License-Identifier: Apache-2.0
/// strata::Localizer: scans, odometry and maps in; where the robot is out.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "components/localizer/building.hpp"
#include "components/localizer/change_mask.hpp"
#include "components/localizer/config.hpp"
#include "components/localizer/current_map.hpp"
#include "components/localizer/filter_mask.hpp"
#include "components/localizer/health_report.hpp"
#include "components/localizer/journal.hpp"
#include "components/localizer/live_maps.hpp"
#include "components/localizer/map_source.hpp"
#include "components/localizer/place_store.hpp"
#include "components/localizer/site_desk.hpp"
#include "components/localizer/zone_topics.hpp"
#include "components/maps/localization_files.hpp"
#include "components/maps/map_model.hpp"
#include "components/runtime/sensor_component.hpp"
#include "components/runtime/time_histogram.hpp"
#include "core/localization/localizer.hpp"

namespace strata::localizer {

/// Out, once a scan: amcl_pose, refined_pose where the filter is sure, map -> odom on /tf (REP 105;
/// as AMCL; not before a pose was told or a first place found), particle_cloud, submap_states (maps
/// with sub-maps only), localization_health, localization_score; place_candidates while several are
/// possible; map_current when what is believed of a sub-map changes, and with each new map,
/// change_mask beside it and once change_mask_info where they are asked for. Services, as AMCL's:
/// reinitialize_global_localization, request_nomotion_update, set_initial_pose. In: initialpose,
/// and the maps when no MAPS folder is named (or map_topics.follow): scans that come before them
/// are passed over, and when one comes again the robot goes on in it, with the particles that it
/// has and what they believe of sub-maps that are still there; so it does when the folder is a
/// site's and another version becomes active: then ~/site_versions tells of it, latched, and
/// ~/list_versions, ~/approve_version, ~/activate_version, ~/roll_back and ~/version_map are
/// answered, and the site's zones go out on zones/KIND, with what they mean on
/// zones/KIND_info, latched, and again when they change. Sub-maps of a folder or a site's version
/// are on ~/patch_map, latched: those that submap_states tells of. Scans with their poses go out
/// where a learner wants them. Of a building the level is found too: it goes out on ~/level,
/// latched, and ~/set_level tells it; the above is about the site of that level. At the end of a
/// log trajectory.tum, refined.tum, states.csv and metrics.json, byte for byte those of `strata
/// localize` without truth but for the cost.
class Localizer final : public runtime::SensorComponent {
 public:
  using SensorComponent::SensorComponent;

 private:
  void on_declare() override { declare_parameters<LocalizerComponentConfig>(); }
  void on_configure() override;
  void on_activate() override;
  void on_deactivate() override;
  void on_cleanup() override;
  void on_diagnose(runtime::Health& health) const override;
  void on_finish(const std::filesystem::path& out_dir) override;
  void on_observation(const Observation& observation) override;
  void on_tick() override;
  /// Reads a MAPS folder and makes the model of it; on any thread.
  [[nodiscard]] static LoadedMaps make_maps(const std::filesystem::path& folder,
                                            const LocalizerComponentConfig& config);
  void use_maps(const maps::Maps& maps, maps::MapModel model,
                std::shared_ptr<refinement::PoseRefiner> refiner,
                const std::optional<Pose2Gaussian>& start);
  void use_maps(const LoadedMaps& loaded, const std::optional<Pose2Gaussian>& start);
  /// Goes on in the maps that the folder's name leads to by now, once they are loaded.
  void take_folder();
  /// Before the filter has them.
  void know_maps(const maps::Maps& maps, maps::MapModel model,
                 std::shared_ptr<refinement::PoseRefiner> refiner);
  /// Where the maps are a building's. Returns those of the likeliest level.
  const LoadedMaps& begin_levels(const std::optional<Pose2Gaussian>& start);
  /// By the kept place, then start.level, then start.pose. Throws InputError.
  void begin_on_level(const std::optional<Pose2Gaussian>& start);
  /// Another level is the likeliest, or it has other maps.
  void use_level();
  void take_levels();
  [[nodiscard]] bool take_level(std::size_t i);
  void offer_levels();
  void publish_level(Stamp stamp);
  void diagnose_level(runtime::Health& health) const;
  void initialize(const Pose2Gaussian& map_from_robot);
  void subscribe_maps();
  void advertise_topics();
  void advertise_change_mask();
  [[nodiscard]] FilterMask advertise_mask(const std::string& topic, const std::string& info_topic);
  void subscribe_topics();
  void offer_services();
  /// Where the maps are a site's.
  void offer_site();
  void offer_zones();
  /// Where the maps have sub-maps.
  void offer_patch_map(const LoadedMaps& loaded);
  void make_patch_map(const LoadedMaps& loaded);
  void send_patch_map();
  /// source: who gave the pose, for errors.
  void restart(const geometry_msgs::msg::PoseWithCovarianceStamped& message,
               const std::string& source);
  void restart_anywhere();
  void load_place();
  /// Begins where the robot was when the process before this one ended, at the first observation
  /// for which there is a map; false when that cannot be told before odometry comes.
  [[nodiscard]] bool resume(const Observation& observation);
  /// As it is configured; nothing: anywhere.
  [[nodiscard]] std::optional<Pose2Gaussian> start_pose() const;
  [[nodiscard]] std::optional<Pose2Gaussian> place_now(const Observation& observation) const;
  void localize(const Observation& observation);
  void begin_journal();
  /// Something else than a scan has changed the filter.
  void interrupt_journal();
  void publish_pose(const Observation& observation, const Pose2Gaussian& filtered,
                    const std::optional<Pose2Gaussian>& refined);
  void publish_particles(Stamp stamp);
  void publish_candidates(Stamp stamp, const localization::LocalizationResult& result);
  void publish_located(const Observation& observation,
                       const localization::LocalizationResult& result);
  void publish_states(Stamp stamp, const std::vector<localization::SubmapBelief>& submaps);
  void publish_current_map(Stamp stamp, const std::vector<localization::SubmapBelief>& submaps);
  void publish_change_mask(Stamp stamp, const ReflectionGrid& occupied,
                           std::span<const float> usual);
  void publish_health(Stamp stamp, const localization::LocalizationResult& result,
                      std::chrono::duration<double> update_time);

  LocalizerComponentConfig config_;
  /// Where the robot was, to carry on from by odometry.
  struct Place {
    Pose2Gaussian map_from_robot;
    Pose2 odom_from_robot;
    bool has_odometry = false;
  };

  /// What was read of the folder, whatever came over topics since.
  struct BaseMaps {
    std::filesystem::path folder;  ///< without links
    std::string sha256;            ///< of the content; empty: it was replaced meanwhile
  };

  std::optional<MapSource> map_source_;  ///< when a folder is named
  BaseMaps base_;
  std::optional<site::MapIdentity> identity_;          ///< of the maps in the folder
  std::string refused_maps_;                           ///< why newer ones are not used; empty: none
  std::map<std::size_t, std::string> refused_levels_;  ///< the same of each level, and of lifts
  std::optional<LiveMaps> live_maps_;
  std::optional<Place> place_;
  std::optional<PlaceStore> store_;  ///< live only
  bool waits_for_odometry_ = false;  ///< to go on from there
  ReflectionGrid kept_map_;          ///< that tells whether odometry went on
  maps::MapModel model_;
  std::optional<CurrentMap> current_map_;
  std::shared_ptr<localization::Localizer> localizer_;
  std::unique_ptr<Building> building_;                    ///< where the maps have levels
  std::unique_ptr<localization::LevelLocalizer> levels_;  ///< the same; it owns localizer_
  std::function<void(const strata_msgs::msg::SiteLevel&)> publish_level_;
  strata_msgs::msg::SiteLevel told_level_;
  std::shared_ptr<refinement::PoseRefiner> refiner_;  ///< of the maps in use
  std::optional<HealthReport> health_;                // as of the last scan
  std::chrono::steady_clock::time_point scanned_at_;  ///< that scan came
  runtime::TimeHistogram update_times_;
  std::uint64_t relocations_ = 0;  // LocalizationResult::relocated_m
  double last_relocation_m_ = 0.0;
  std::uint64_t maps_taken_ = 0;     ///< that it began to localize in
  std::optional<Journal> journal_;   ///< live only
  maps::LocalizationRecord record_;  // lockstep only: live it would grow without end
  std::function<void(const geometry_msgs::msg::PoseWithCovarianceStamped&)> publish_pose_;
  std::function<void(const geometry_msgs::msg::PoseWithCovarianceStamped&)> publish_refined_;
  std::function<void(const tf2_msgs::msg::TFMessage&)> publish_tf_;
  std::function<void(const nav2_msgs::msg::ParticleCloud&)> publish_candidates_;
  bool was_ambiguous_ = false;
  bool was_placed_ = false;  ///< since it was configured: told, or found in a first search
  std::function<void(const strata_msgs::msg::SubmapStates&)> publish_states_;
  /// null: the maps are of no folder, or have no sub-maps
  std::function<void(const strata_msgs::msg::PatchMap&)> publish_patch_map_;
  std::optional<strata_msgs::msg::PatchMap> unsent_patch_map_;
  std::function<void(const nav_msgs::msg::OccupancyGrid&)> publish_map_;
  std::optional<FilterMask> change_mask_;  ///< none: not wanted, or of a model that has none
  std::function<void(const strata_msgs::msg::LocalizationHealth&)> publish_health_;
  std::function<void(const std_msgs::msg::Float64&)> publish_score_;
  std::function<void(const strata_msgs::msg::LabeledScan&)> publish_located_;  // null: not wanted
  std::shared_ptr<bus::RawWriter> particle_writer_;  // raw, to see whether somebody reads
  std::unique_ptr<ZoneTopics> zone_topics_;          ///< live, where the maps are a site's
  std::string zones_fault_;                          ///< as it was told last
  std::unique_ptr<SiteDesk> site_desk_;              ///< the same; it uses the zones
};

}  // namespace strata::localizer
