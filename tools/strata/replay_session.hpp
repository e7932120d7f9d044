// SPDX-License-Identifier: Apache-2.0
/// The components of a composition in lockstep: started, fed with recorded scans, asked to save.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "components/bus/domain_claim.hpp"
#include "components/player/log_player.hpp"
#include "components/runtime/composition.hpp"
#include "components/runtime/host.hpp"
#include "components/runtime/lockstep_coordinator.hpp"
#include "core/base/progress.hpp"
#include "tools/pipeline/runs_input.hpp"
#include "tools/strata/process_group.hpp"
#include "tools/strata/replay_clouds.hpp"
#include "tools/strata/verb_context.hpp"

namespace strata::tools {

/// What is not the verb's to say.
struct SessionOptions {
  std::uint64_t seed = 1;
  int threads = 0;
  Progress* progress = nullptr;
};

class ReplaySession {
 public:
  /// With processes of a replay that was broken off: nothing of it is kept.
  static constexpr std::chrono::milliseconds kUnfinishedPatience{1500};

  /// Starts the components, in this process or in the several that the composition asks for. file:
  /// the composition's, for processes. Players are left out: the session plays. Waits while another
  /// session of this machine is on the domain: each would hear the other. Throws as Host, and
  /// Cancelled.
  ReplaySession(VerbContext& context, runtime::Composition composition, const std::string& file);
  /// In this process only, with its own seed, threads and progress.
  ReplaySession(VerbContext& context, runtime::Composition composition,
                const SessionOptions& options);

  /// Records these topics ("/map", or "/map:nav_msgs/msg/OccupancyGrid") into a bag. Waits until
  /// somebody publishes those without a type; throws InputError when nobody does.
  void record(const std::vector<std::string>& topics, const std::filesystem::path& bag);
  /// Somebody else reads this topic and must miss nothing; before connect.
  void expect_reader(const std::string& full_topic) { other_readers_.push_back(full_topic); }
  /// Matches everything with everything. runs must outlive the session. with_poses: the runs and
  /// given poses of scans are published too.
  /// bag: whose clouds are sent too when a component maps them; nothing: none.
  void connect(const pipeline::Runs& runs, bool with_poses,
               const std::optional<std::filesystem::path>& bag = std::nullopt);
  /// Sends scans [begin, end) through the components, at `rate` times the pace of the log; 0: as
  /// fast as they are. Throws Cancelled.
  void play(std::size_t begin, std::size_t end, double rate);
  /// Every component does what needs all data and saves below `out`.
  void finish(const std::filesystem::path& out);
  /// The end of a replay that is finished: processes have their time to write, unless the user
  /// interrupts it. Throws Error when one did not end well; Cancelled when that is why.
  void stop();

  [[nodiscard]] const runtime::Composition& composition() const { return composition_; }
  [[nodiscard]] const std::shared_ptr<bus::Participant>& participant() const {
    return participant_;
  }

 private:
  void host_all();
  [[nodiscard]] std::string with_type(const std::string& topic);
  [[nodiscard]] bool keep_waiting();
  /// As keep_waiting; a session with progress says once of each what is waited for long.
  [[nodiscard]] bool wait_for(const std::string& what, double waited_s);

  VerbContext& context_;
  SessionOptions options_;
  runtime::Composition composition_;
  std::optional<bus::DomainClaim> claim_;
  runtime::Registry registry_;
  std::shared_ptr<bus::Participant> participant_;
  ProcessGroup group_{{kUnfinishedPatience}};
  std::unique_ptr<runtime::Host> host_;
  std::unique_ptr<runtime::Host> recorder_;
  std::vector<std::string> names_;  ///< of the components, in the order of work
  std::vector<std::string> other_readers_;
  std::set<std::string> told_waits_;
  std::unique_ptr<runtime::LockstepCoordinator> coordinator_;
  std::unique_ptr<player::LogPlayer> player_;
  std::unique_ptr<ReplayClouds> clouds_;  ///< null without
  std::vector<double> elapsed_s_;         ///< of each scan since the first
};

}  // namespace strata::tools
