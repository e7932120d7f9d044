// SPDX-License-Identifier: Apache-2.0
#include "components/localizer/amcl_parameters.hpp"

#include <algorithm>
#include <iterator>
#include <numbers>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "components/localizer/config.hpp"
#include "components/maps/map_models.hpp"

namespace strata::localizer {
namespace {

using runtime::Translator;

/// AMCL's own defaults, where one of its parameters only has a meaning with another.
constexpr int kAmclMinParticles = 500;
constexpr double kAmclWeight = 0.5;        // z_hit and z_rand
constexpr double kAmclSmallWeight = 0.05;  // z_short and z_max
/// Of a laser whose range_max no parameter says.
constexpr double kUsualRange_m = 30.0;
/// The number of beams that our likelihood field's tempering is made for.
constexpr double kFieldBeams = 180.0;
constexpr double kFieldTempering = 8.0;

/// tf2 knows no leading slash.
std::string frame(std::string name) {
  if (name.starts_with('/')) name.erase(0, 1);
  return name;
}

void map_frame(Translator& t, const std::string& name, const std::vector<std::string>& paths) {
  const auto given = t.read<std::string>(name);
  if (!given) return;
  for (const std::string& path : paths) t.map(name, path, frame(*given));
}

void translate_names(Translator& t) {
  map_frame(t, "base_frame_id", {"input.robot_frame"});
  map_frame(t, "global_frame_id", {"map_frame"});
  map_frame(t, "odom_frame_id", {"odometry_frame", "input.tf_odometry_frame"});
  t.map_as_it_is<std::string>("scan_topic", "input.scan_topic");
  t.map_as_it_is<std::string>("map_topic", "map_topics.occupancy");
  t.map_as_it_is<double>("transform_tolerance", "transform_tolerance");
  t.map_as_it_is<bool>("tf_broadcast", "publish_tf");
  t.map_as_it_is<bool>("use_sim_time", "use_sim_time");
}

/// Variances per squared motion in both, of the same two turns and a drive.
void translate_motion(Translator& t) {
  t.map_as_it_is<double>("alpha1", "localizer.motion.rotation_from_rotation");
  t.map_as_it_is<double>("alpha2", "localizer.motion.rotation_from_translation");
  t.map_as_it_is<double>("alpha3", "localizer.motion.translation_from_translation");
  t.map_as_it_is<double>("alpha4", "localizer.motion.translation_from_rotation");
  t.ignore("alpha5", "only AMCL's omnidirectional model has sideways noise");
  const auto model = t.read<std::string>("robot_model_type");
  const bool is_omni = model && (model->find("Omni") != std::string::npos ||
                                 model->find("omni") != std::string::npos);
  if (is_omni) {
    t.warn(
        "robot_model_type",
        "there is no omnidirectional motion model: a step sideways counts as a turn, a drive and "
        "a turn back, each with its noise; lower alpha1 for a robot that often does so");
  } else {
    t.ignore("robot_model_type", "there is one motion model, that of a differential drive");
  }
  t.map_as_it_is<double>("update_min_d", "localizer.gating.translation_m");
  t.map_as_it_is<double>("update_min_a", "localizer.gating.rotation_rad");
}

void translate_particles(Translator& t) {
  const auto least = t.read<int>("min_particles");
  const auto most = t.read<int>("max_particles");
  if (least) t.map("min_particles", "localizer.kld.min_particles", *least);
  if (most) {
    // AMCL raises it to the lower limit, and begins with as many.
    const int limit = std::max(*most, least.value_or(kAmclMinParticles));
    t.map("max_particles", "localizer.kld.max_particles", limit);
    t.map("max_particles", "localizer.particles", limit);
  }
  t.map_as_it_is<double>("pf_err", "localizer.kld.epsilon");
  t.map_as_it_is<double>("pf_z", "localizer.kld.quantile");
  t.ignore("resample_interval",
           "it resamples whenever too few particles count: localizer.resample_below");
  t.ignore("random_seed", "it is strata run --seed");
  t.ignore("freespace_downsampling", "free space is kept in little memory anyway");
}

/// AMCL recovers when its fast average falls below its slow one; a rate of 0 keeps the first value.
void translate_recovery(Translator& t) {
  const auto slow = t.read<double>("recovery_alpha_slow");
  const auto fast = t.read<double>("recovery_alpha_fast");
  if (!slow && !fast) return;
  const bool injects = slow.value_or(0.0) > 0.0 || fast.value_or(0.0) > 0.0;
  t.map(fast ? "recovery_alpha_fast" : "recovery_alpha_slow", "localizer.recovery.inject", injects);
  if (injects) {
    t.map_as_it_is<double>("recovery_alpha_slow", "localizer.recovery.slow_rate");
    t.map_as_it_is<double>("recovery_alpha_fast", "localizer.recovery.fast_rate");
  } else if (slow && fast) {
    t.ignore("recovery_alpha_slow", "0 is no recovery, with recovery_alpha_fast");
  }
}

void translate_start(Translator& t) {
  const char* pose[] = {"initial_pose.x", "initial_pose.y", "initial_pose.yaw"};
  const bool is_set = t.read<bool>("set_initial_pose").value_or(false);
  std::vector<double> start;
  for (const char* name : pose) start.push_back(t.read<double>(name).value_or(0.0));
  if (is_set) {
    t.map("set_initial_pose", "start.pose", start);
    for (const char* name : pose) t.map(name, "start.pose", start);
  } else {
    t.warn("set_initial_pose",
           "false: the robot is looked for in the whole map at once; AMCL would wait for "
           "/initialpose");
    for (const char* name : pose) t.ignore(name, "set_initial_pose is not true");
  }
  t.ignore("initial_pose.z", "the map is flat");
  t.ignore("always_reset_initial_pose",
           "configured again it begins at start.pose, or where start.store kept it");
  const auto rate_hz = t.read<double>("save_pose_rate");
  if (rate_hz && *rate_hz > 0.0) {
    t.map("save_pose_rate", "start.store.period_s", 1.0 / *rate_hz);
  } else {
    t.ignore("save_pose_rate", "nothing is kept without start.store.file");
  }
  t.ignore("initialize_at_saved_pose", "start.store.file does that");
  t.ignore("saved_pose_filepath", "start.store.file is ours, of another form");
  t.ignore("first_map_only", "a newer map is taken over, and the pose stays");
}

/// The weights of AMCL's likelihood field: a hit's bell of height z_hit, over z_rand / range_max.
/// Ours are h and 1 - h, so h / (1 - h) = z_hit range_max / z_rand.
void translate_field(Translator& t) {
  t.map_as_it_is<double>("sigma_hit", "likelihood_field.field.hit_stddev_m");
  t.map_as_it_is<double>("laser_likelihood_max_dist", "likelihood_field.field.max_distance_m");
  const auto limit_m = t.read<double>("laser_max_range");
  const double range_m =
      limit_m && *limit_m > 0.0 ? std::min(*limit_m, kUsualRange_m) : kUsualRange_m;
  const auto hit = t.read<double>("z_hit");
  const auto random = t.read<double>("z_rand");
  if (hit || random) {
    const double bell = hit.value_or(kAmclWeight) * range_m;
    const double floor = random.value_or(kAmclWeight);
    if (!(bell >= 0.0 && floor >= 0.0 && bell + floor > 0.0)) {
      t.refuse(hit ? "z_hit" : "z_rand", "z_hit and z_rand are no weights", "make them positive");
    }
    for (const char* name : {"z_hit", "z_rand"}) {
      t.map(name, "likelihood_field.field.hit_weight", bell / (bell + floor));
    }
  }
  t.ignore("laser_max_range",
           "the scan's own range_max counts; this only weighs z_hit against z_rand");
  for (const char* name : {"z_short", "z_max", "lambda_short"}) {
    t.ignore(name, "only beam models have it");
  }
  if (const auto beams = t.read<int>("max_beams")) {
    t.map("max_beams", "likelihood_field.max_beams", *beams);
    // Fewer beams are less alike: what a scan says as a whole stays.
    t.map("max_beams", "likelihood_field.tempering", kFieldTempering * *beams / kFieldBeams);
  }
}

/// AMCL's four weights need not sum to 1.
void translate_mixture(Translator& t) {
  struct Weight {
    const char* name;
    const char* path;
    double usual;
  };
  const Weight weights[] = {{"z_hit", "sensor.beam.mixture.hit_weight", kAmclWeight},
                            {"z_short", "sensor.beam.mixture.short_weight", kAmclSmallWeight},
                            {"z_max", "sensor.beam.mixture.max_weight", kAmclSmallWeight},
                            {"z_rand", "sensor.beam.mixture.random_weight", kAmclWeight}};
  double sum = 0.0;
  const char* first = nullptr;
  for (const Weight& weight : weights) {
    const auto value = t.read<double>(weight.name);
    if (value && first == nullptr) first = weight.name;
    sum += value.value_or(weight.usual);
  }
  if (first == nullptr) return;
  if (!(sum > 0.0)) t.refuse(first, "z_hit, z_short, z_max and z_rand sum to nothing", "raise one");
  for (const Weight& weight : weights) {
    const auto value = t.read<double>(weight.name);
    t.map(value ? weight.name : first, weight.path, value.value_or(weight.usual) / sum);
  }
}

void translate_beams(Translator& t, bool is_amcls_model) {
  const auto limit_m = t.read<double>("laser_max_range");
  if (limit_m) t.map("laser_max_range", "sensor.beam.beams.max_range_m", std::max(*limit_m, 0.0));
  if (const auto beams = t.read<int>("max_beams")) {
    t.map("max_beams", "sensor.beam.beams.min_angle_rad", 2.0 * std::numbers::pi / *beams);
  }
  t.ignore("laser_likelihood_max_dist", "only a likelihood field has it");
  if (is_amcls_model) {
    translate_mixture(t);
    t.map_as_it_is<double>("sigma_hit", "sensor.beam.mixture.hit_stddev_m");
    t.map_as_it_is<double>("lambda_short", "sensor.beam.mixture.short_rate_per_m");
    return;
  }
  for (const char* name : {"z_hit", "z_rand", "z_short", "z_max", "sigma_hit", "lambda_short"}) {
    t.ignore(name,
             "it is of AMCL's likelihood field, and this model traces beams: "
             "sensor.beam.mixture");
  }
}

void translate_laser(Translator& t) {
  const auto type = t.read<std::string>("laser_model_type");
  const bool wants_beams = type && *type == "beam";
  if (type && !wants_beams && *type != "likelihood_field" && *type != "likelihood_field_prob") {
    t.refuse("laser_model_type", "AMCL has no laser model '" + *type + "'",
             settings::detail::suggestion(
                 *type, {"beam", "likelihood_field", "likelihood_field_prob"}, "models"));
  }
  if (const auto beams = t.read<int>("max_beams"); beams && *beams < 2) {
    t.refuse("max_beams", "max_beams is " + std::to_string(*beams) + ", too few", "use 2 or more");
  }
  const LocalizerComponentConfig ours;
  const std::string map = t.own<std::string>("model", ours.model);
  const maps::MapModels::Pointer model = maps::map_models().find(map);
  const bool has_field = model && model->has_likelihood_field();
  const std::string usual = has_field && !wants_beams ? "likelihood_field" : "beam";
  const std::string used = t.own<std::string>("sensor_model", usual);
  if (wants_beams || has_field) {
    t.map("laser_model_type", "sensor_model", usual);
  } else {
    const auto others = maps::map_models().names(&maps::MapModelDescriptor::has_likelihood_field);
    t.ignore("laser_model_type", "the model " + map + " traces beams; " +
                                     maps::join_names(others, " and ") +
                                     " have a likelihood field");
  }
  if (used == "likelihood_field") {
    translate_field(t);
  } else {
    translate_beams(t, wants_beams);
  }
  const auto min_m = t.read<double>("laser_min_range");
  if (min_m && *min_m > 0.0) {
    t.warn("laser_min_range",
           "readings down to the scan's own range_min are used; a filter before "
           "Strata can take others out");
  } else {
    t.ignore("laser_min_range", "the scan's own range_min counts, as here");
  }
  for (const char* name :
       {"do_beamskip", "beam_skip_distance", "beam_skip_error_threshold", "beam_skip_threshold"}) {
    t.ignore(name, "no beam is skipped: maps that know change explain such beams");
  }
}

/// Of every node of nav2 or ROS 2.
void ignore_infrastructure(Translator& t) {
  t.ignore("bond_heartbeat_period", "the bond has its own period, which nav2's manager takes");
  for (const char* name : {"introspection_mode", "service_introspection_mode"}) {
    t.ignore(name, "services are not recorded");
  }
  for (const char* name : {"allow_parameter_qos_overrides", "qos_overrides"}) {
    t.ignore(name, "QoS profiles are sensor_qos, pose_qos and others");
  }
  t.ignore("start_type_description_service", "it has no switch");
}

std::vector<std::string> parameter_names() {
  std::istringstream words(
      "alpha1 alpha2 alpha3 alpha4 alpha5 base_frame_id beam_skip_distance "
      "beam_skip_error_threshold beam_skip_threshold do_beamskip global_frame_id lambda_short "
      "laser_likelihood_max_dist laser_max_range laser_min_range laser_model_type "
      "set_initial_pose initial_pose.x initial_pose.y initial_pose.z initial_pose.yaw max_beams "
      "max_particles min_particles odom_frame_id pf_err pf_z recovery_alpha_fast "
      "recovery_alpha_slow resample_interval robot_model_type save_pose_rate sigma_hit "
      "tf_broadcast transform_tolerance update_min_a update_min_d z_hit z_max z_rand z_short "
      "always_reset_initial_pose scan_topic map_topic first_map_only freespace_downsampling "
      "random_seed initialize_at_saved_pose saved_pose_filepath allow_parameter_qos_overrides "
      "qos_overrides bond_heartbeat_period introspection_mode service_introspection_mode "
      "start_type_description_service use_sim_time");
  return {std::istream_iterator<std::string>(words), {}};
}

}  // namespace

runtime::StandIn amcl_stand_in() {
  return {"amcl", "strata::Localizer", parameter_names(), [](Translator& t) {
            translate_names(t);
            translate_motion(t);
            translate_particles(t);
            translate_recovery(t);
            translate_start(t);
            translate_laser(t);
            ignore_infrastructure(t);
          }};
}

}  // namespace strata::localizer
