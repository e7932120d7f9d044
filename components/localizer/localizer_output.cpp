// SPDX-License-Identifier: Apache-2.0
// What the localizer publishes after each scan.
#include <cmath>

#include "components/convert/geometry_messages.hpp"
#include "components/convert/map_messages.hpp"
#include "components/convert/scan_messages.hpp"
#include "components/localizer/localizer.hpp"
#include "components/settings/config_writer.hpp"

namespace strata::localizer {
namespace {

/// A sub-map counts as the current one when most particles are in it.
constexpr double kCurrentMass = 0.5;
constexpr double kBytesPerMb = 1e6;

}  // namespace

void Localizer::advertise_topics() {
  publish_pose_ = advertise<geometry_msgs::msg::PoseWithCovarianceStamped>(config_.pose_topic,
                                                                           config_.pose_qos);
  publish_refined_ = advertise<geometry_msgs::msg::PoseWithCovarianceStamped>(config_.refined_topic,
                                                                              config_.pose_qos);
  publish_tf_ = advertise<tf2_msgs::msg::TFMessage>("/tf", "tf");
  if (config_.localizer.global_search.is_used) {
    publish_candidates_ =
        advertise<nav2_msgs::msg::ParticleCloud>(config_.candidates_topic, config_.state_qos);
  }
  publish_states_ =
      advertise<strata_msgs::msg::SubmapStates>(config_.states_topic, config_.state_qos);
  publish_map_ =
      advertise<nav_msgs::msg::OccupancyGrid>(config_.current_map_topic, config_.state_qos);
  advertise_change_mask();
  publish_health_ =
      advertise<strata_msgs::msg::LocalizationHealth>(config_.health_topic, config_.state_qos);
  publish_score_ = advertise<std_msgs::msg::Float64>(config_.score_topic, "default");
  if (!config_.located_topic.empty()) {
    publish_located_ = advertise<strata_msgs::msg::LabeledScan>(config_.located_topic, "lossless");
  }
  particle_writer_ = advertise_raw(resolve(config_.particles_topic),
                                   bus::MessageType<nav2_msgs::msg::ParticleCloud>::name,
                                   bus::qos_profile(config_.sensor_qos));
}

void Localizer::advertise_change_mask() {
  const ChangeMaskConfig& mask = config_.change_mask;
  if (mask.kind == ChangeMaskKind::kOff) return;
  if (!has_change_mask(*maps::map_models().at(config_.model))) {
    say(runtime::LogLevel::kWarn, "change_mask.kind has no effect: the model " + config_.model +
                                      " has no sub-maps; " + resolve(mask.topic) + " is not sent");
    return;
  }
  // Latched, whatever the QoS of others: nav2 reads no mask that is not.
  change_mask_ = advertise_mask(mask.topic, mask.info_topic);
}

FilterMask Localizer::advertise_mask(const std::string& topic, const std::string& info_topic) {
  return {resolve(topic), advertise<nav_msgs::msg::OccupancyGrid>(topic, "latched"),
          advertise<nav2_msgs::msg::CostmapFilterInfo>(info_topic, "latched")};
}

void Localizer::begin_journal() {
  if (lockstep() || config_.restore_point_s <= 0.0) return;
  const std::string name = full_name() + "/";
  auto scans =
      advertise_raw(name + kJournalTopic, bus::MessageType<strata_msgs::msg::LabeledScan>::name,
                    bus::qos_profile("tf"));
  auto points = advertise_raw(name + kRestorePointTopic,
                              bus::MessageType<rcl_interfaces::msg::ParameterEvent>::name,
                              bus::qos_profile("default"));
  journal_.emplace(
      std::move(scans), std::move(points),
      [this] {
        RestorePoint point;
        point.localizer = full_name();
        point.seed = context().seed;
        point.settings = settings::write_yaml(config_, {.with_version = false});
        point.maps = base_.folder.string();
        point.maps_sha256 = base_.sha256;
        if (live_maps_) point.map_messages = live_maps_->taken();
        return point;
      },
      Journal::Limits{
          .period = Duration::from_seconds(config_.restore_point_s),
          .max_learned_bytes = static_cast<std::size_t>(config_.restore_point_mb * kBytesPerMb)});
}

void Localizer::interrupt_journal() {
  if (journal_) journal_->interrupt();
}

void Localizer::publish_pose(const Observation& observation, const Pose2Gaussian& filtered,
                             const std::optional<Pose2Gaussian>& refined) {
  const Stamp stamp = observation.scan.stamp;
  geometry_msgs::msg::PoseWithCovarianceStamped message;
  message.header(convert::make_header(stamp, config_.map_frame));
  if (refined) {
    message.pose(convert::to_pose_with_covariance(*refined));
    publish_refined_(message);
  }
  const Pose2Gaussian& pose = refined && config_.pose == PoseOut::kRefined ? *refined : filtered;
  message.pose(convert::to_pose_with_covariance(pose));
  publish_pose_(message);
  if (!config_.publish_tf || !observation.has_odometry || !was_placed_) return;
  const Pose2 map_from_odom = pose.mean * inverse(observation.odom_from_robot);
  tf2_msgs::msg::TFMessage tf;
  // Dated ahead: who asks for the robot's place now, as a costmap does, would else have to wait for
  // the next scan.
  const Stamp until = stamp + Duration::from_seconds(config_.transform_tolerance);
  tf.transforms().push_back(convert::to_transform_stamped(until, map_from_odom, config_.map_frame,
                                                          config_.odometry_frame));
  publish_tf_(tf);
}

void Localizer::publish_particles(Stamp stamp) {
  if (particle_writer_->matched() == 0) return;
  const localization::ParticleSet& particles = localizer_->particles();
  nav2_msgs::msg::ParticleCloud cloud;
  cloud.header(convert::make_header(stamp, config_.map_frame));
  cloud.particles().resize(particles.size());
  for (std::size_t i = 0; i < particles.size(); ++i) {
    cloud.particles()[i].pose(convert::to_pose(particles.pose(i)));
    cloud.particles()[i].weight(particles.weight[i]);
  }
  particle_writer_->publish(convert::to_cdr(cloud));
}

void Localizer::publish_candidates(Stamp stamp, const localization::LocalizationResult& result) {
  if (!publish_candidates_ || (!result.is_ambiguous && !was_ambiguous_)) return;
  was_ambiguous_ = result.is_ambiguous;
  nav2_msgs::msg::ParticleCloud cloud;
  cloud.header(convert::make_header(stamp, config_.map_frame));
  for (const localization::PlaceBelief& place : result.places) {
    nav2_msgs::msg::Particle particle;
    particle.pose(convert::to_pose(place.map_from_robot));
    particle.weight(place.probability);
    cloud.particles().push_back(particle);
  }
  publish_candidates_(cloud);
}

void Localizer::publish_located(const Observation& observation,
                                const localization::LocalizationResult& result) {
  const LocatedScansConfig& wanted = config_.located;
  const Eigen::Matrix3d& covariance = result.pose.covariance;
  if (levels_ && !levels_->is_level_sure()) return;
  if (!publish_located_ || !result.weighed || result.health.is_in_doubt ||
      result.score < wanted.min_score ||
      !(std::sqrt(covariance.topLeftCorner<2, 2>().trace()) <= wanted.max_stddev_m) ||
      !(std::sqrt(covariance(2, 2)) <= wanted.max_stddev_rad)) {
    return;
  }
  publish_located_(
      convert::to_message(PosedScan{observation.run, observation.scan, result.pose.mean, {}},
                          config_.map_frame, "laser"));
}

void Localizer::publish_states(Stamp stamp,
                               const std::vector<localization::SubmapBelief>& submaps) {
  strata_msgs::msg::SubmapStates message;
  message.header(convert::make_header(stamp, config_.map_frame));
  message.current(-1);
  for (const localization::SubmapBelief& belief : submaps) {
    if (belief.mass > kCurrentMass) message.current(belief.submap);
    strata_msgs::msg::SubmapState state;
    state.submap(belief.submap);
    state.probability(belief.probability);
    message.states().push_back(state);
  }
  publish_states_(message);
}

void Localizer::publish_current_map(Stamp stamp,
                                    const std::vector<localization::SubmapBelief>& submaps) {
  const localization::PatchStates* states = model_.sensor->patch_states();
  std::span<const float> usual;
  if (change_mask_ && states != nullptr) usual = states->usual(localizer_->particles());
  const std::optional<ReflectionGrid> map = current_map_->news(submaps, usual, stamp);
  if (!map) return;
  publish_map_(convert::to_occupancy(*map, stamp, config_.map_frame));
  if (change_mask_) publish_change_mask(stamp, *map, usual);
}

void Localizer::publish_change_mask(Stamp stamp, const ReflectionGrid& occupied,
                                    std::span<const float> usual) {
  const ChangeMaskConfig& config = config_.change_mask;
  const auto outlook = outlook_of(*model_.sensor->patch_states(), usual, current_map_->beliefs());
  const Grid<float> change =
      current_map_->cells().change(outlook, config.horizon_s, config.reach_m);
  change_mask_->send(mask_of(change, occupied, config), meaning_of(config), stamp,
                     config_.map_frame);
}

void Localizer::publish_health(Stamp stamp, const localization::LocalizationResult& result,
                               std::chrono::duration<double> update_time) {
  update_times_.add(update_time.count());
  if (result.relocated_m) {
    ++relocations_;
    last_relocation_m_ = *result.relocated_m;
  }
  health_ = make_health_report(config_.model, result, update_time);
  publish_health_(to_message(*health_, stamp, config_.map_frame));
  std_msgs::msg::Float64 score;
  score.data(result.score);
  publish_score_(score);
}

}  // namespace strata::localizer
