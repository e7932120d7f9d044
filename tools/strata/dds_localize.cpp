// SPDX-License-Identifier: Apache-2.0
#include "tools/strata/dds_localize.hpp"

#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "components/bus/endpoint.hpp"
#include "components/convert/geometry_messages.hpp"
#include "components/localizer/config.hpp"
#include "components/settings/settings.hpp"
#include "core/base/error.hpp"
#include "tools/strata/particle_clouds.hpp"
#include "tools/strata/replay_session.hpp"

namespace strata::tools {
namespace {

constexpr auto kLongestWait = std::chrono::seconds(20);

/// One localizer that reads a MAPS folder, seen by this process only.
runtime::Composition composition_of(const localizer::LocalizerComponentConfig& config) {
  runtime::ComponentEntry entry;
  entry.type = "strata::Localizer";
  entry.name = "localizer";
  entry.node_namespace = "/";
  entry.place = "--via dds";
  entry.parameters = YAML::Load(settings::write_yaml(config));
  entry.parameters.remove("version");
  runtime::Composition composition;
  composition.place = "--via dds";
  composition.network.transport = bus::Transport::kLoopback;
  composition.network.is_alone = true;
  composition.processes = {{.name = "localizer", .components = {entry}}};
  return composition;
}

/// What the localizer's topics say, scan by scan.
class Listener {
 public:
  Listener(const std::shared_ptr<bus::Participant>& participant,
           const localizer::LocalizerComponentConfig& config, const pipeline::Runs& runs)
      : clouds_(participant, "/" + config.particles_topic, kQos(),
                [this](const auto& message) { add(message); }),
        poses_(participant, "/" + config.pose_topic, kQos(),
               [this](const auto& message) { add(message); }),
        states_(participant, "/" + config.states_topic, kQos(),
                [this](const auto& message) { add(message); }),
        health_(participant, "/" + config.health_topic, kQos(),
                [this](const auto& message) { add(message); }) {
    const std::lock_guard lock(mutex_);
    for (std::size_t i = 0; i < runs.observations.size(); ++i) {
      if (runs.truths[i]) truths_[runs.observations[i].scan.stamp] = *runs.truths[i];
    }
  }

  /// Clouds are made only for those who read them.
  [[nodiscard]] bool wait_until_heard() const {
    return clouds_.raw().wait_for_writers(1, kLongestWait) &&
           poses_.raw().wait_for_writers(1, kLongestWait) &&
           states_.raw().wait_for_writers(1, kLongestWait) &&
           health_.raw().wait_for_writers(1, kLongestWait);
  }

  /// Everything about so many scans; health is published last.
  [[nodiscard]] pipeline::LocalizationRun take(std::size_t scans) {
    std::unique_lock lock(mutex_);
    const bool is_whole = changed_.wait_for(lock, kLongestWait, [&] {
      return run_.update_ms.size() >= scans && run_.trajectory.size() >= scans &&
             heard_clouds_ >= scans;
    });
    if (!is_whole) {
      throw Error("--via dds", "the localizer did not answer every scan",
                  "see whether /dev/shm or the loopback interface is restricted here");
    }
    return std::move(run_);
  }

 private:
  static bus::QosProfile kQos() { return bus::qos_profile("default").lossless(); }

  void add(const nav2_msgs::msg::ParticleCloud& cloud) {
    const std::lock_guard lock(mutex_);
    ++heard_clouds_;
    const auto truth = truths_.find(convert::from_message(cloud.header().stamp()));
    if (truth != truths_.end()) run_.errors.push_back(error_of(cloud, truth->second));
    changed_.notify_all();
  }
  void add(const geometry_msgs::msg::PoseWithCovarianceStamped& message) {
    const std::lock_guard lock(mutex_);
    run_.trajectory.push_back({convert::from_message(message.header().stamp()),
                               convert::from_message(message.pose()).mean});
    changed_.notify_all();
  }
  void add(const strata_msgs::msg::SubmapStates& message) {
    const std::lock_guard lock(mutex_);
    const Stamp stamp = convert::from_message(message.header().stamp());
    for (const auto& state : message.states()) {
      for (std::size_t k = 0; k < state.probability().size(); ++k) {
        run_.states.push_back({stamp, state.submap(), static_cast<int>(k), state.probability()[k]});
      }
    }
  }
  void add(const strata_msgs::msg::LocalizationHealth& message) {
    const std::lock_guard lock(mutex_);
    run_.update_ms.push_back(message.update_time() * 1e3);
    run_.max_particles = std::max<std::size_t>(run_.max_particles, message.particles());
    changed_.notify_all();
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::map<Stamp, Pose2> truths_;
  std::size_t heard_clouds_ = 0;
  pipeline::LocalizationRun run_;
  mutable bus::Reader<nav2_msgs::msg::ParticleCloud> clouds_;
  mutable bus::Reader<geometry_msgs::msg::PoseWithCovarianceStamped> poses_;
  mutable bus::Reader<strata_msgs::msg::SubmapStates> states_;
  mutable bus::Reader<strata_msgs::msg::LocalizationHealth> health_;
};

/// Its map is written as the patch map of a folder of its own.
bool is_by_places(const maps::MapModel& model) {
  return model.descriptor->needs_part(maps::MapPart::kPlacePatches);
}

localizer::LocalizerComponentConfig config_of(const pipeline::LocalizeJob& job,
                                              const std::filesystem::path& maps,
                                              const pipeline::CompareConfig& compared) {
  localizer::LocalizerComponentConfig config;
  config.maps = maps.string();
  const std::string& in_own_folder = job.model.descriptor->in_own_folder;
  config.model = in_own_folder.empty() ? job.model.name : in_own_folder;
  config.start.pose = {job.start.mean.x, job.start.mean.y, job.start.mean.theta};
  config.start.stddev_m = compared.protocol.start_stddev_m;
  config.start.stddev_rad = compared.protocol.start_stddev_rad;
  config.localizer = job.config;
  config.sensor = compared.sensor;
  config.decoding = compared.decoding;
  config.timescale_use = compared.timescale_use;
  return config;
}

pipeline::LocalizationRun localize(VerbContext& context, const pipeline::LocalizeJob& job,
                                   const std::filesystem::path& maps,
                                   const pipeline::CompareConfig& compared) {
  if (!job.model.descriptor->is_learned()) {
    throw ConfigError("--via dds", "the model `" + job.model.name + "` is in no MAPS folder",
                      "leave out --map, or compare without --via dds");
  }
  pipeline::Runs runs;
  runs.observations.assign(job.observations.begin(), job.observations.end());
  runs.truths.assign(job.truths.begin(), job.truths.end());
  const localizer::LocalizerComponentConfig config = config_of(job, maps, compared);
  ReplaySession session(context, composition_of(config), SessionOptions{job.seed, 1, nullptr});
  Listener listener(session.participant(), config, runs);
  for (const std::string& topic :
       {config.particles_topic, config.pose_topic, config.states_topic, config.health_topic}) {
    session.expect_reader("/" + topic);
  }
  session.connect(runs, false);
  if (!listener.wait_until_heard()) {
    throw Error("--via dds", "the localizer's topics are not heard",
                "see whether the loopback interface is restricted here");
  }
  session.play(0, runs.observations.size(), 0.0);
  pipeline::LocalizationRun run = listener.take(runs.observations.size());
  session.stop();
  return run;
}

}  // namespace

pipeline::MakeLocalize localize_over_dds(VerbContext& context, const std::string& out) {
  return [&context, out](const pipeline::LearnResult& learned,
                         const pipeline::CompareConfig& compared) {
    // Never committed: it goes away with the last run.
    const auto maps = std::make_shared<OutputDirectory>(out + "_maps", context.staged());
    maps::write_grid_maps(maps->path(), learned.slam);
    maps::write_patch_map(maps->path(), learned.patches);
    if (learned.timescale) maps::write_timescale(maps->path(), *learned.timescale);
    std::shared_ptr<OutputDirectory> place_maps;
    if (learned.place_patches) {
      place_maps = std::make_shared<OutputDirectory>(out + "_place_maps", context.staged());
      maps::write_grid_maps(place_maps->path(), learned.slam);
      maps::write_patch_map(place_maps->path(), *learned.place_patches);
    }
    const auto one_at_a_time = std::make_shared<std::mutex>();
    return [&context, maps, place_maps, compared, one_at_a_time](const pipeline::LocalizeJob& job) {
      const std::lock_guard lock(*one_at_a_time);
      const auto& folder = is_by_places(job.model) ? place_maps : maps;
      return localize(context, job, folder->path(), compared);
    };
  };
}

}  // namespace strata::tools
