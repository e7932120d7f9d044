// SPDX-License-Identifier: Apache-2.0
#include "tools/strata/replay_session.hpp"

#include <chrono>
#include <thread>
#include <utility>

#include "components/log/bag.hpp"
#include "components/player/conducted_outputs.hpp"
#include "core/base/error.hpp"
#include "tools/all_components/all_components.hpp"
#include "tools/strata/paced_time.hpp"
#include "tools/strata/verbs.hpp"

namespace strata::tools {
namespace {

constexpr const char* kRecorder = "strata_replay_recorder";
constexpr double kLongWait_s = 10.0;
constexpr auto kLongestDiscovery = std::chrono::seconds(20);

/// The session plays; a player in the composition would play twice.
void leave_out_players(runtime::Composition& composition) {
  for (runtime::ProcessEntry& process : composition.processes) {
    std::erase_if(process.components,
                  [](const auto& entry) { return entry.type == "strata::Player"; });
  }
  std::erase_if(composition.processes, [](const auto& entry) { return entry.components.empty(); });
  if (composition.processes.empty()) {
    throw ConfigError(composition.place, "has nothing to replay into",
                      "add components other than strata::Player");
  }
}

bool maps_clouds(const runtime::Composition& composition) {
  for (const runtime::ProcessEntry& process : composition.processes) {
    for (const runtime::ComponentEntry& entry : process.components) {
      if (entry.type == "strata::VolumeMapper") return true;
    }
  }
  return false;
}

std::vector<std::string> component_names(const runtime::Composition& composition) {
  std::vector<std::string> names;
  for (const runtime::ProcessEntry& process : composition.processes) {
    for (const runtime::ComponentEntry& entry : process.components) {
      names.push_back(bus::expand_name(entry.name, entry.node_namespace, entry.name));
    }
  }
  return names;
}

runtime::HostOptions host_options(const SessionOptions& session) {
  runtime::HostOptions options;
  options.mode = runtime::FeedMode::kLockstep;
  options.seed = session.seed;
  options.threads = session.threads;
  return options;
}

/// Waits for the domain; nothing for a session that nobody else can hear.
std::optional<bus::DomainClaim> claim_domain(VerbContext& context,
                                             const runtime::Composition& composition) {
  if (composition.network.is_alone) return std::nullopt;
  bool told = false;
  for (;;) {
    if (auto claim = bus::DomainClaim::take("replay", composition.network.domain)) return claim;
    if (!told) {
      context.note("another replay is on domain " + std::to_string(composition.network.domain) +
                   " of this machine: waiting for its end. --set domain=N lets both run");
      told = true;
    }
    if (context.interrupt().wait_for(0.1)) throw Cancelled("replay");
  }
}

/// Waits until a scan is due; throws when interrupted.
class Pace {
 public:
  Pace(double rate, VerbContext& context) : is_paced_(rate > 0.0), time_(rate), context_(context) {}
  void wait_for(double since_begin_s) {
    if (!is_paced_) return;
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin_;
    const double left_s = time_.due_s(since_begin_s) - elapsed.count();
    if (left_s > 0.0 && context_.interrupt().wait_for(left_s)) throw Cancelled("replay");
  }

 private:
  bool is_paced_;
  PacedTime time_;
  VerbContext& context_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

}  // namespace

ReplaySession::ReplaySession(VerbContext& context, runtime::Composition composition,
                             const std::string& file)
    : context_(context),
      options_{context.options.seed, context.options.threads, context.progress()},
      composition_(std::move(composition)),
      claim_(claim_domain(context, composition_)),
      registry_(all_components(composition_)) {
  leave_out_players(composition_);
  names_ = component_names(composition_);
  participant_ = runtime::make_participant(composition_);
  if (composition_.processes.size() == 1) {
    host_all();
    return;
  }
  for (const runtime::ProcessEntry& process : composition_.processes) {
    group_.start(process.name, child_arguments(file, process.name, context, true));
  }
}

ReplaySession::ReplaySession(VerbContext& context, runtime::Composition composition,
                             const SessionOptions& options)
    : context_(context),
      options_(options),
      composition_(std::move(composition)),
      claim_(claim_domain(context, composition_)),
      registry_(all_components(composition_)),
      names_(component_names(composition_)) {
  participant_ = runtime::make_participant(composition_);
  host_all();
}

/// Of the only process.
void ReplaySession::host_all() {
  host_ = std::make_unique<runtime::Host>(composition_, composition_.processes[0], registry_,
                                          participant_, host_options(options_));
  for (const std::string& warning : host_->take_errors()) context_.note("warning: " + warning);
}

bool ReplaySession::keep_waiting() { return !context_.interrupt().requested() && group_.all_run(); }

bool ReplaySession::wait_for(const std::string& what, double waited_s) {
  const bool is_shown = options_.progress != nullptr;  // not one of several at once
  if (is_shown && waited_s > kLongWait_s && told_waits_.insert(what).second) {
    context_.note("replay: has waited " + std::to_string(static_cast<int>(waited_s)) + " s for " +
                  what + ", and goes on waiting; Ctrl-C ends it");
  }
  return keep_waiting();
}

std::string ReplaySession::with_type(const std::string& topic) {
  if (topic.find(':') != std::string::npos) return topic;
  const std::string full = bus::expand_name(topic, composition_.node_namespace, kRecorder);
  const auto deadline = std::chrono::steady_clock::now() + kLongestDiscovery;
  for (;;) {
    const auto published = participant_->published_topics();
    if (const auto found = published.find(full); found != published.end()) {
      return full + ":" + found->second.type;
    }
    // In one process every writer is there by now.
    if (host_ || std::chrono::steady_clock::now() > deadline) {
      throw InputError("--topics " + topic, "nobody in the composition publishes it",
                       "name a topic of its components; docs/reference has a page for each");
    }
    if (!keep_waiting() || context_.interrupt().wait_for(0.05)) throw Cancelled("replay");
  }
}

void ReplaySession::record(const std::vector<std::string>& topics,
                           const std::filesystem::path& bag) {
  runtime::ComponentEntry entry;
  entry.type = "strata::Recorder";
  entry.name = kRecorder;
  entry.node_namespace = composition_.node_namespace;
  entry.place = "--topics";
  entry.parameters["out"] = bag.string();
  entry.parameters["storage"] = "mcap";
  for (const std::string& topic : topics) entry.parameters["topics"].push_back(with_type(topic));
  const runtime::ProcessEntry process{"recorder", runtime::ExecutorKind::kSingleThreaded, {entry}};
  recorder_ = std::make_unique<runtime::Host>(composition_, process, registry_, participant_,
                                              host_options(options_));
  names_.push_back(bus::expand_name(entry.name, entry.node_namespace, entry.name));
}

void ReplaySession::connect(const pipeline::Runs& runs, bool with_poses,
                            const std::optional<std::filesystem::path>& bag) {
  elapsed_s_ = pipeline::elapsed_seconds(runs.observations);
  coordinator_ = std::make_unique<runtime::LockstepCoordinator>(
      participant_, names_,
      [this](const std::string& what, double waited_s) { return wait_for(what, waited_s); });
  player::Outputs outputs =
      player::conducted_outputs(*coordinator_, composition_.node_namespace, with_poses);
  if (bag && maps_clouds(composition_)) {
    const std::string topic = bus::expand_name("points", composition_.node_namespace, "player");
    clouds_ = ReplayClouds::open(
        *bag, {outputs.tf_static, coordinator_->advertise<sensor_msgs::msg::PointCloud2>(topic)});
  }
  player_ = std::make_unique<player::LogPlayer>(runs.observations, std::move(outputs), runs.poses);
  for (const std::string& topic : other_readers_) coordinator_->expect_reader(topic);
  coordinator_->connect();
}

void ReplaySession::play(std::size_t begin, std::size_t end, double rate) {
  Pace pace(rate, context_);
  for (std::size_t i = begin; i < end; ++i) {
    pace.wait_for(elapsed_s_[i] - elapsed_s_[begin]);
    if (clouds_) clouds_->publish_until(player_->observations()[i].scan.stamp);
    player_->publish(i);
    coordinator_->cycle();
    report_progress(options_.progress, "replay", i + 1, elapsed_s_.size());
  }
}

void ReplaySession::finish(const std::filesystem::path& out) {
  coordinator_->finish(std::filesystem::absolute(out));
}

void ReplaySession::stop() {
  if (recorder_) recorder_->stop();
  if (host_) host_->stop();
  try {
    group_.stop({kStopPatience, [this] { return context_.interrupt().requested(); }});
  } catch (const Error&) {
    if (context_.interrupt().requested()) throw Cancelled("replay");
    throw;
  }
}

}  // namespace strata::tools
