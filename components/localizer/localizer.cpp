// SPDX-License-Identifier: Apache-2.0
#include "components/localizer/localizer.hpp"

#include "components/convert/geometry_messages.hpp"
#include "components/localizer/filter.hpp"
#include "components/log/kept_file.hpp"
#include "components/maps/maps_folder.hpp"

namespace strata::localizer {
namespace {

/// A scanner that sends nothing for so long has died, or lost its cable.
constexpr auto kScanPatience = std::chrono::seconds(5);
constexpr const char* kNoScans = "no scan has come for 5 s";

}  // namespace

void Localizer::on_configure() {
  config_ = read_parameters<LocalizerComponentConfig>();
  keep_live(config_, {"publish_tf", "transform_tolerance"});
  if (!lockstep()) load_place();
  std::optional<LoadedMaps> loaded;
  const LoadedMaps* known = nullptr;
  if (!config_.maps.empty() && is_building(config_.maps)) {
    known = &begin_levels(start_pose());
  } else if (!config_.maps.empty()) {
    map_source_.emplace(config_.maps, [config = config_](const std::filesystem::path& folder) {
      return make_maps(folder, config);
    });
    loaded = map_source_->load();
    known = &*loaded;
    use_maps(*known, start_pose());
  }
  advertise_topics();
  begin_journal();
  if (known == nullptr || config_.map_topics.follow) {
    subscribe_maps();
    if (known != nullptr) live_maps_->begin_with(known->maps);
  }
  subscribe<geometry_msgs::msg::PoseWithCovarianceStamped>(
      config_.initial_pose_topic, config_.initial_pose_qos,
      [this](const auto& message) { restart(message, resolve(config_.initial_pose_topic)); },
      {.until_active = true});  // scripts and people tell it once, whether it is active yet or not
  offer_services();
  offer_site();
  offer_levels();
  if (known != nullptr) offer_patch_map(*known);
  subscribe_sensors(config_.input, config_.sensor_qos,
                    config_.publish_tf ? config_.odometry_frame : "");
}

void Localizer::load_place() {
  store_.emplace(config_.start.store,
                 pose_covariance(config_.start.stddev_m, config_.start.stddev_rad));
  log::require_own_file(config_.start.store.file, log::kLastPose, "start.store.file");
  try {
    (void)restored(config_.start.store.file, [this] { store_->load(); });
  } catch (const InputError& error) {
    tell(error);  // the robot must start nevertheless
  }
}

bool Localizer::resume(const Observation& observation) {
  waits_for_odometry_ = false;
  if (!store_ || !store_->has_place()) return true;
  waits_for_odometry_ = store_->waits_for_odometry(observation, config_.input.use_odometry);
  if (waits_for_odometry_) return false;
  store_->hear(observation);
  if (!localizer_) return true;  // the map tells
  const auto resumed = store_->resume(observation, kept_map_);
  kept_map_ = ReflectionGrid(1.0, CellRect{});
  place_ = Place{resumed->map_from_robot, observation.odom_from_robot, observation.has_odometry};
  initialize(resumed->map_from_robot);
  interrupt_journal();
  if (!resumed->fits) {
    tell(InputError(
        full_name(), "the first scan does not look as the map does where the robot is taken to be",
        "where it was carried meanwhile, tell its place by " + resolve(config_.initial_pose_topic) +
            " or call reinitialize_global_localization"));
  }
  return true;
}

void Localizer::on_observation(const Observation& observation) {
  if (!localizer_ && place_ && !place_->has_odometry && observation.has_odometry) {
    place_->odom_from_robot = observation.odom_from_robot;  // it drives on before the map comes
    place_->has_odometry = true;
  }
  take_folder();
  take_levels();
  if (live_maps_ && live_maps_->has_news()) {
    const maps::Maps& maps = live_maps_->take();
    maps::MapModel model = make_model(config_, maps);
    auto refiner = maps::make_refiner(maps, *model.descriptor, config_.refinement);
    use_maps(maps, std::move(model), std::move(refiner), place_now(observation));
  }
  if (!resume(observation)) return;
  if (localizer_) localize(observation);
}

void Localizer::offer_services() {
  offer<bus::srv::SetInitialPose>("set_initial_pose", [this](const auto& request) {
    restart(request.pose(), resolve("set_initial_pose"));
    return nav2_msgs::srv::SetInitialPose_Response();
  });
  offer<bus::srv::Empty>("reinitialize_global_localization", [this](const auto&) {
    restart_anywhere();
    return std_srvs::srv::Empty_Response();
  });
  offer<bus::srv::Empty>("request_nomotion_update", [this](const auto&) {
    if (localizer_) localizer_->weigh_next();
    interrupt_journal();
    return std_srvs::srv::Empty_Response();
  });
}

void Localizer::restart_anywhere() {
  if (!localizer_) {
    throw InputError(resolve("reinitialize_global_localization"), "no map has come yet",
                     "ask again when the localizer has its map");
  }
  if (store_) store_->forget();
  if (levels_) {
    levels_->initialize_global();
    use_level();
  } else {
    localizer_->initialize_global();
  }
  interrupt_journal();
}

/// Of a building on the level that is known, or on any.
void Localizer::initialize(const Pose2Gaussian& map_from_robot) {
  if (!levels_) return localizer_->initialize(map_from_robot);
  std::optional<std::size_t> level;
  if (levels_->is_level_sure()) level = levels_->level();
  levels_->initialize(map_from_robot, level);
  use_level();
}

void Localizer::restart(const geometry_msgs::msg::PoseWithCovarianceStamped& message,
                        const std::string& source) {
  const std::string& frame = message.header().frame_id();
  if (!frame.empty() && frame != config_.map_frame && frame != "/" + config_.map_frame) {
    throw InputError(source, "the pose is in the frame '" + frame + "'",
                     "give it in " + config_.map_frame);
  }
  Pose2Gaussian pose = convert::from_message(message.pose());
  if (!is_finite(pose.mean) || !pose.covariance.allFinite() ||
      pose.covariance.diagonal().minCoeff() < 0.0) {
    throw InputError(source, "the pose is not finite or has a negative variance", "send another");
  }
  // It may be of a moment ago, as a marker's that a camera has seen: the robot has driven on.
  const Stamp stamp = convert::from_message(message.header().stamp());
  const std::optional<Pose2> moved =
      lockstep() || stamp.ns == 0 ? std::nullopt : moved_since(stamp);
  if (moved) pose = pose * Pose2Gaussian{*moved, Eigen::Matrix3d::Zero()};
  // All zero means unknown, as many tools leave it.
  if (pose.covariance.isZero(0.0))
    pose.covariance = pose_covariance(config_.start.stddev_m, config_.start.stddev_rad);
  place_ = Place{pose, Pose2(), false};
  if (store_) store_->forget();
  if (localizer_) initialize(pose);
  interrupt_journal();
}

void Localizer::localize(const Observation& observation) {
  const Stamp stamp = observation.scan.stamp;
  if (journal_) journal_->before(observation, *localizer_);
  const auto begin = std::chrono::steady_clock::now();
  const localization::LocalizationResult result =
      levels_ ? levels_->update(observation) : localizer_->update(observation);
  const bool is_other_filter = levels_ && levels_->filter() != localizer_;
  if (is_other_filter) use_level();
  const std::optional<Pose2Gaussian> refined = refiner_->refine(observation.scan, result);
  scanned_at_ = std::chrono::steady_clock::now();
  const auto update_time = scanned_at_ - begin;
  if (live_maps_) {
    place_ = Place{result.pose, observation.odom_from_robot, observation.has_odometry};
  }
  if (lockstep()) record_.add(stamp, result, *localizer_, refined);
  if (journal_ && is_other_filter) {
    journal_->leave_out();
  } else if (journal_) {
    journal_->after(observation, result.pose, config_.map_frame);
  }
  // Of a building the filter's own: that of all levels tells a place on each.
  const localization::LocalizationResult& own = localizer_->result();
  was_placed_ |= !own.is_ambiguous || !own.places.empty();
  publish_level(stamp);
  publish_pose(observation, result.pose, refined);
  publish_particles(stamp);
  publish_candidates(stamp, result);
  publish_located(observation, result);
  if (!result.submaps.empty()) publish_states(stamp, result.submaps);
  publish_current_map(stamp, result.submaps);
  publish_health(stamp, result, update_time);
  if (store_ && result.converged && !result.health.is_in_doubt) {
    const bool is_known = levels_ && levels_->is_level_sure();
    store_->keep(observation, result.pose,
                 is_known ? building_->level(levels_->level()).name : std::string());
  }
}

void Localizer::on_diagnose(runtime::Health& health) const {
  diagnose_input(health);
  if (waits_for_odometry_) health.warn("waits for odometry, to go on from its store");
  health.add("maps", config_.maps.empty() ? std::string("topics") : config_.maps);
  health.add("maps taken", maps_taken_);
  if (config_.change_mask.kind != ChangeMaskKind::kOff && !change_mask_) {
    health.add("change mask", "none: the model " + config_.model + " has no sub-maps");
  }
  if (identity_) {
    health.add("mapId", identity_->id);
    health.add("mapVersion", identity_->version);
    health.add("mapHash", identity_->hash);
  }
  diagnose_level(health);
  if (!refused_maps_.empty()) health.warn(refused_maps_);
  if (zone_topics_ && !zone_topics_->fault().empty()) health.warn(zone_topics_->fault());
  if (journal_ && journal_->lacks_points()) {
    health.add("incidents", std::string("cannot be replayed: the model has learned more than "
                                        "restore_point_mb"));
  }
  if (health_) {
    describe(*health_, health);
    health.add("update times", update_times_.text());
    health.add("relocations", relocations_);
    if (relocations_ > 0) health.add("last relocation [m]", last_relocation_m_);
    const std::chrono::duration<double> silent = std::chrono::steady_clock::now() - scanned_at_;
    if (!lockstep() && silent > kScanPatience) health.fail(kNoScans);
  } else {
    health.warn("no scan has come yet");
    describe_unknown_place(health);
  }
}

void Localizer::on_finish(const std::filesystem::path& out_dir) {
  // Before the learners are done there is nothing to tell; the end of the log asks again.
  if (record_.trajectory.empty()) return;
  const std::filesystem::path folder = out_dir / config_.out_subfolder;
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) {
    throw OutputError(folder.string(), "cannot be made: " + error.message(),
                      "check out_subfolder and the permissions");
  }
  maps::write_localization_files(folder, record_,
                                 maps::localization_metrics(record_, config_.model, context().seed,
                                                            config_.localizer.particles));
}

void Localizer::on_activate() { send_patch_map(); }

void Localizer::on_deactivate() {
  if (store_) store_->flush();
}

void Localizer::on_cleanup() {
  localizer_.reset();
  levels_.reset();
  building_.reset();
  told_level_ = {};
  refiner_.reset();
  journal_.reset();
  current_map_.reset();
  change_mask_.reset();
  publish_patch_map_ = nullptr;
  unsent_patch_map_.reset();
  live_maps_.reset();
  map_source_.reset();
  base_ = {};
  identity_.reset();
  refused_maps_.clear();
  refused_levels_.clear();
  place_.reset();  // its odometry may begin anew before the next configure
  store_.reset();
  waits_for_odometry_ = false;
  was_ambiguous_ = was_placed_ = false;
  health_.reset();
  update_times_ = {};
  maps_taken_ = 0;
  record_ = {};
  particle_writer_.reset();
  site_desk_.reset();
  zone_topics_.reset();
  zones_fault_.clear();
}

}  // namespace strata::localizer
