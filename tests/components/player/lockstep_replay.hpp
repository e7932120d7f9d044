// SPDX-License-Identifier: Apache-2.0
/// Components of this process in lockstep with a log.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <memory>
#include <string>
#include <vector>

#include "components/player/conducted_outputs.hpp"
#include "components/player/log_player.hpp"
#include "components/runtime/composition.hpp"
#include "components/runtime/host.hpp"
#include "components/runtime/lockstep_coordinator.hpp"

namespace strata::test {

class LockstepReplay {
 public:
  using Register = void (*)(runtime::Registry&);

  /// composition: of one process, without namespaces.
  LockstepReplay(const runtime::Composition& composition, std::initializer_list<Register> kinds,
                 std::uint64_t seed, int threads = 1)
      : participant(runtime::make_participant(composition)),
        host_(composition, composition.processes[0], registry_of(kinds), participant,
              {.mode = runtime::FeedMode::kLockstep, .seed = seed, .threads = threads}),
        coordinator_(participant, names_of(composition),
                     [](const std::string&, double) { return true; }),
        outputs_(player::conducted_outputs(coordinator_)) {}

  /// To advertise more, and expect readers, before `play`.
  [[nodiscard]] runtime::LockstepCoordinator& coordinator() { return coordinator_; }
  /// Plays the log to its end; before each scan calls `before` with its index.
  void play(
      const std::vector<Observation>& log,
      const std::function<void(std::size_t)>& before = [](std::size_t) {}) {
    player::LogPlayer player(log, outputs_);
    coordinator_.connect();
    for (std::size_t i = 0; i < log.size(); ++i) {
      before(i);
      player.publish(i);
      coordinator_.cycle();
    }
  }
  /// The components write their files.
  void finish(const std::filesystem::path& out) {
    coordinator_.finish(out);
    host_.stop();
  }

  const std::shared_ptr<bus::Participant> participant;

 private:
  static runtime::Registry registry_of(std::initializer_list<Register> kinds) {
    runtime::Registry registry;
    for (const Register kind : kinds) kind(registry);
    return registry;
  }
  static std::vector<std::string> names_of(const runtime::Composition& composition) {
    std::vector<std::string> names;
    for (const runtime::ComponentEntry& entry : composition.processes[0].components) {
      names.push_back("/" + entry.name);
    }
    return names;
  }
  runtime::Host host_;
  runtime::LockstepCoordinator coordinator_;
  player::Outputs outputs_;
};

}  // namespace strata::test
