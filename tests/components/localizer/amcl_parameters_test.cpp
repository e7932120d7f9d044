// SPDX-License-Identifier: Apache-2.0
#include "components/localizer/amcl_parameters.hpp"

#include <cmath>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/localizer/config.hpp"
#include "core/base/error.hpp"
#include "tests/components/localizer/amcl_fixture.hpp"

namespace strata::localizer {
namespace {

using testing::Contains;
using testing::HasSubstr;

TEST_F(AmclParameters, DefaultsBecomeAFilterLikeAmclsInItsMap) {
  const LocalizerComponentConfig config = read(kDefaults, "model: occupancy");
  EXPECT_EQ(config.input.robot_frame, "base_footprint");
  EXPECT_EQ(config.input.tf_odometry_frame, "odom");
  EXPECT_EQ(config.input.scan_topic, "scan");
  EXPECT_EQ(config.odometry_frame, "odom");
  EXPECT_EQ(config.map_frame, "map");
  EXPECT_EQ(config.map_topics.occupancy, "map");
  EXPECT_TRUE(config.publish_tf);

  const localization::LocalizerConfig& filter = config.localizer;
  EXPECT_EQ(filter.motion.rotation_from_rotation, 0.2);
  EXPECT_EQ(filter.motion.rotation_from_translation, 0.2);
  EXPECT_EQ(filter.motion.translation_from_translation, 0.2);
  EXPECT_EQ(filter.motion.translation_from_rotation, 0.2);
  EXPECT_EQ(filter.gating.translation_m, 0.25);
  EXPECT_EQ(filter.gating.rotation_rad, 0.2);
  EXPECT_EQ(filter.kld.min_particles, 500);
  EXPECT_EQ(filter.kld.max_particles, 2000);
  EXPECT_EQ(filter.particles, 2000) << "AMCL begins with as many as it may have";
  EXPECT_EQ(filter.kld.epsilon, 0.05);
  EXPECT_EQ(filter.kld.quantile, 0.99);
  EXPECT_FALSE(filter.recovery.inject);
  EXPECT_EQ(filter.recovery.slow_rate, localization::RecoveryConfig{}.slow_rate)
      << "the verdict on health needs its averages";
  EXPECT_EQ(filter.recovery.fast_rate, localization::RecoveryConfig{}.fast_rate);

  EXPECT_EQ(config.sensor_model, maps::SensorModelKind::kLikelihoodField);
  EXPECT_EQ(config.likelihood_field.field.hit_stddev_m, 0.2);
  EXPECT_EQ(config.likelihood_field.field.max_distance_m, 2.0);
  EXPECT_EQ(config.likelihood_field.max_beams, 60);
  EXPECT_DOUBLE_EQ(config.likelihood_field.tempering, 8.0 / 3.0) << "8 for 180 beams";
  EXPECT_DOUBLE_EQ(config.likelihood_field.field.hit_weight, 15.0 / 15.5);
  EXPECT_EQ(config.start.store.period_s, 2.0);
  EXPECT_TRUE(config.start.pose.empty());
}

TEST_F(AmclParameters, EveryNameOfAmclIsKnownAndEveryOneIsAccountedFor) {
  for (const char* own : {"model: occupancy", "model: patch", "sensor_model: beam"}) {
    const runtime::Composition composition = compose(kDefaults, own);
    EXPECT_THAT(names_of(composition, Fate::kUnknown), testing::IsEmpty()) << own;
    std::set<std::string> accounted;
    for (const auto& one : composition.processes[0].components[0].translated) {
      accounted.insert(one.name);
      EXPECT_THAT(one.place, HasSubstr("amcl.yaml:")) << one.name;
      EXPECT_NE(one.text, "") << one.name;
    }
    EXPECT_EQ(accounted.size(), 48U) << own;
  }
  // What the table names and nav2's file does not: newer releases, and every ROS 2 node.
  const std::vector<std::string> names = amcl_stand_in().names;
  for (const char* name : {"random_seed", "initialize_at_saved_pose", "saved_pose_filepath",
                           "introspection_mode", "qos_overrides"}) {
    EXPECT_THAT(names, Contains(name));
    EXPECT_THAT(names_of(compose(only(std::string(name) + ": 1")), Fate::kIgnored), Contains(name));
  }
}

TEST_F(AmclParameters, WithSubMapsBeamsAreTracedAndTheFieldsNumbersLeftOut) {
  const runtime::Composition composition = compose(kDefaults, "maps: M, model: patch");
  const LocalizerComponentConfig config = config_of(composition);
  EXPECT_EQ(config.sensor_model, maps::SensorModelKind::kBeam);
  const rays::BeamMixtureConfig usual;
  EXPECT_EQ(config.sensor.beam.mixture.hit_weight, usual.hit_weight);
  EXPECT_EQ(config.sensor.beam.mixture.hit_stddev_m, usual.hit_stddev_m);
  EXPECT_EQ(config.sensor.beam.mixture.short_rate_per_m, usual.short_rate_per_m);
  EXPECT_EQ(config.sensor.beam.beams.max_range_m, 100.0);
  EXPECT_DOUBLE_EQ(config.sensor.beam.beams.min_angle_rad, 2.0 * std::numbers::pi / 60.0);
  for (const char* name : {"laser_model_type", "sigma_hit", "z_hit", "z_rand"}) {
    EXPECT_THAT(names_of(composition, Fate::kIgnored), Contains(name));
  }
  EXPECT_THAT(find(composition, "laser_model_type")->text, HasSubstr("patch traces beams"));
}

TEST_F(AmclParameters, TheBeamModelsWeightsAreMadeToSumToOne) {
  const std::string beam =
      "laser_model_type: beam, z_hit: 0.5, z_short: 0.05, z_max: 0.05, z_rand: 0.5, "
      "sigma_hit: 0.1, lambda_short: 0.2, laser_max_range: -1.0";
  for (const char* own : {"model: patch", "model: occupancy"}) {
    const LocalizerComponentConfig config = read(only(beam), own);
    EXPECT_EQ(config.sensor_model, maps::SensorModelKind::kBeam);
    const rays::BeamMixtureConfig& mixture = config.sensor.beam.mixture;
    EXPECT_DOUBLE_EQ(mixture.hit_weight, 0.5 / 1.1);
    EXPECT_DOUBLE_EQ(mixture.short_weight, 0.05 / 1.1);
    EXPECT_DOUBLE_EQ(mixture.max_weight, 0.05 / 1.1);
    EXPECT_DOUBLE_EQ(mixture.random_weight, 0.5 / 1.1);
    EXPECT_EQ(mixture.hit_stddev_m, 0.1);
    EXPECT_EQ(mixture.short_rate_per_m, 0.2);
    EXPECT_EQ(config.sensor.beam.beams.max_range_m, 0.0) << "the scan's own";
  }
  // One weight alone stands beside AMCL's defaults of the others.
  const auto mixture = read(only("laser_model_type: beam, z_hit: 1.4")).sensor.beam.mixture;
  EXPECT_DOUBLE_EQ(mixture.hit_weight, 0.7);
  EXPECT_DOUBLE_EQ(mixture.random_weight, 0.25);
}

TEST_F(AmclParameters, TheFieldHasTheShapeOfAmcls) {
  const auto field = read(only("z_hit: 0.9, z_rand: 0.1, sigma_hit: 0.3, laser_max_range: 12.0"),
                          "model: filtered, sensor_model: likelihood_field")
                         .likelihood_field.field;
  // AMCL: z_hit exp(-d^2 / 2 s^2) + z_rand / r_max, of which only the ratio counts.
  const auto amcl = [](double d) {
    return 0.9 * std::exp(-d * d / (2.0 * 0.3 * 0.3)) + 0.1 / 12.0;
  };
  const auto ours = [&field](double d) {
    const double s = field.hit_stddev_m;
    return field.hit_weight * std::exp(-d * d / (2.0 * s * s)) + 1.0 - field.hit_weight;
  };
  for (const double d : {0.1, 0.3, 0.7, 2.0}) {
    EXPECT_NEAR(ours(d) / ours(0.0), amcl(d) / amcl(0.0), 1e-12) << d;
  }
}

TEST_F(AmclParameters, NestedAndDottedPosesAreTheStart) {
  const std::vector<double> start = {1.5, -2.0, 0.7};
  EXPECT_EQ(read("amcl:\n  ros__parameters:\n    set_initial_pose: True\n"
                 "    initial_pose: {x: 1.5, y: -2, z: 0.3, yaw: 0.7}\n")
                .start.pose,
            start);
  EXPECT_EQ(read("amcl:\n  ros__parameters:\n    set_initial_pose: true\n    initial_pose.x: 1.5\n"
                 "    initial_pose.y: -2.0\n    initial_pose.yaw: 0.7\n")
                .start.pose,
            start);
  EXPECT_EQ(read(only("set_initial_pose: true")).start.pose, (std::vector<double>{0, 0, 0}))
      << "AMCL's default pose";
  const runtime::Composition unset = compose(only("initial_pose.x: 1.5"));
  EXPECT_TRUE(config_of(unset).start.pose.empty());
  EXPECT_THAT(find(unset, "initial_pose.x")->text, HasSubstr("set_initial_pose is not true"));
}

TEST_F(AmclParameters, TheTransformIsPostDatedAsAmclsIs) {
  EXPECT_EQ(read(only("transform_tolerance: 0.3")).transform_tolerance, 0.3);
}

TEST_F(AmclParameters, RecoveryIsOnWhenItsRatesAre) {
  const auto recovery =
      read(only("recovery_alpha_slow: 0.002, recovery_alpha_fast: 0.2")).localizer.recovery;
  EXPECT_TRUE(recovery.inject);
  EXPECT_EQ(recovery.slow_rate, 0.002);
  EXPECT_EQ(recovery.fast_rate, 0.2);
  EXPECT_THAT(complaint("    recovery_alpha_slow: 0.2\n    recovery_alpha_fast: 0.1\n"),
              HasSubstr("is not below fast_rate"));
}

TEST_F(AmclParameters, LimitsOfParticlesAreAmcls) {
  // AMCL raises the upper limit to the lower.
  const auto raised = read(only("min_particles: 3000, max_particles: 1000")).localizer;
  EXPECT_EQ(raised.kld.min_particles, 3000);
  EXPECT_EQ(raised.kld.max_particles, 3000);
  const auto lower = read(only("min_particles: 5000")).localizer;
  EXPECT_EQ(lower.kld.min_particles, 5000);
  EXPECT_EQ(lower.kld.max_particles, localization::KldConfig{}.max_particles);
  const auto upper = read(only("max_particles: 8000")).localizer;
  EXPECT_EQ(upper.kld.min_particles, localization::KldConfig{}.min_particles);
  EXPECT_EQ(upper.kld.max_particles, 8000);
  EXPECT_EQ(upper.particles, 8000);
  EXPECT_EQ(read(only("max_particles: 400")).localizer.kld.max_particles, 500)
      << "AMCL's default of the lower limit";
}

TEST_F(AmclParameters, FramesLoseASlashThatTf2DoesNotKnow) {
  const LocalizerComponentConfig config =
      read(only("global_frame_id: /floor, odom_frame_id: /wheels, base_frame_id: /base"));
  EXPECT_EQ(config.map_frame, "floor");
  EXPECT_EQ(config.odometry_frame, "wheels");
  EXPECT_EQ(config.input.tf_odometry_frame, "wheels");
  EXPECT_EQ(config.input.robot_frame, "base");
}

TEST_F(AmclParameters, WhatIsGivenInOurNamesWins) {
  const std::string both = std::string(kDefaults) +
                           "localizer:\n  ros__parameters:\n"
                           "    localizer.gating.translation_m: 0.07\n";
  const runtime::Composition composition =
      compose(both, "model: occupancy, localizer: {particles: 77}, map_frame: ours",
              {"localizer.localizer.motion.rotation_from_rotation=0.01",
               "localizer.localizer.kld.quantile=3"});
  const LocalizerComponentConfig config = config_of(composition);
  EXPECT_EQ(config.map_frame, "ours") << "the composition";
  EXPECT_EQ(config.localizer.particles, 77) << "the composition";
  EXPECT_EQ(config.localizer.kld.max_particles, 2000) << "AMCL's other one of that name";
  EXPECT_EQ(config.localizer.gating.translation_m, 0.07) << "an entry in our names";
  EXPECT_EQ(config.localizer.motion.rotation_from_rotation, 0.01) << "--set";
  EXPECT_EQ(config.localizer.motion.rotation_from_translation, 0.2) << "AMCL's";
  const std::vector<std::string> overruled = names_of(composition, Fate::kOverruled);
  EXPECT_THAT(overruled, testing::ElementsAre("alpha1", "global_frame_id", "max_particles", "pf_z",
                                              "update_min_d"));
  // What is set later on the command line decides what AMCL's laser model is worth.
  EXPECT_EQ(read(kDefaults, "model: patch", {"localizer.model=filtered"}).sensor_model,
            maps::SensorModelKind::kLikelihoodField);
}

TEST_F(AmclParameters, AnUnknownNameIsNamedWithWhatWasMeant) {
  const runtime::Composition composition = compose(
      "amcl:\n  ros__parameters:\n    alpha1: 0.1\n    sigma_hitt: 0.2\n    initial_pose: 3\n");
  EXPECT_THAT(composition.notes,
              Contains(folder() + "/amcl.yaml:4: amcl has no parameter 'sigma_hitt'; did you mean "
                                  "'sigma_hit'?"));
  EXPECT_THAT(names_of(composition, Fate::kUnknown),
              testing::ElementsAre("initial_pose", "sigma_hitt"));
  EXPECT_THAT(composition.notes[0], HasSubstr("amcl.yaml: what is for amcl is for /localizer: 1 "
                                              "parameters mapped, 0 given otherwise, 0 without"));
}

TEST_F(AmclParameters, AWrongTypeOrValueIsRefusedAtItsLine) {
  const std::string place = folder() + "/amcl.yaml:3: ";
  EXPECT_THAT(complaint("    sigma_hit: much\n", "model: occupancy"),
              HasSubstr(place + "sigma_hit is 'much', not a number"));
  EXPECT_THAT(complaint("    max_particles: 2000.5\n"), HasSubstr(place + "max_particles is"));
  EXPECT_THAT(complaint("    tf_broadcast: 1\n"), HasSubstr(place + "tf_broadcast is '1'"));
  EXPECT_THAT(complaint("    laser_model_type: beams\n"),
              HasSubstr(place + "AMCL has no laser model 'beams'; did you mean 'beam'?"));
  EXPECT_THAT(complaint("    max_beams: 1\n"), HasSubstr(place + "max_beams is 1, too few"));
  // Ours, at the line of AMCL's.
  EXPECT_THAT(complaint("    alpha1: -0.2\n"), HasSubstr(place));
  EXPECT_THAT(complaint("    alpha1: -0.2\n"), HasSubstr("rotation_from_rotation"));
}

TEST_F(AmclParameters, WhatMayDisappointIsSaidAtEveryStart) {
  EXPECT_THAT(compose(only("robot_model_type: nav2_amcl::OmniMotionModel")).notes,
              Contains(HasSubstr("there is no omnidirectional motion model")));
  EXPECT_THAT(compose(only("laser_min_range: 0.4")).notes, Contains(HasSubstr("laser_min_range")));
  EXPECT_THAT(compose(only("set_initial_pose: false")).notes,
              Contains(HasSubstr("AMCL would wait for /initialpose")));
  EXPECT_THAT(compose(only("laser_min_range: -1.0")).notes, testing::SizeIs(1));
}

TEST_F(AmclParameters, ALocalizerNamedAmclTakesItsOwnParametersInTheSameEntry) {
  const runtime::Composition composition = compose(
      "amcl:\n  ros__parameters: {update_min_d: 0.3, model: filtered, use_sim_time: True}\n",
      "maps: M, model: patch", {}, "amcl");
  const YAML::Node parameters = composition.processes[0].components[0].parameters;
  EXPECT_EQ(parameters["model"].as<std::string>(), "filtered");
  EXPECT_EQ(parameters["use_sim_time"].as<std::string>(), "true");
  EXPECT_EQ(config_of(composition).localizer.gating.translation_m, 0.3);
  const runtime::Composition typo = compose(only("modell: filtered"), "maps: M", {}, "amcl");
  EXPECT_THROW((void)config_of(typo), ConfigError);
}

}  // namespace
}  // namespace strata::localizer
