// SPDX-License-Identifier: Apache-2.0
/// One process of a composition: its participant, threads and components, from start to stop.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "components/runtime/component.hpp"
#include "components/runtime/composition.hpp"
#include "components/runtime/free_memory.hpp"
#include "components/runtime/registry.hpp"

namespace strata::runtime {

struct HostOptions {
  FeedMode mode = FeedMode::kLive;
  bool dry_run = false;  ///< configure, to be looked at: no file is written
  std::uint64_t seed = 1;
  int threads = 1;
};

/// The participant that a composition asks for.
[[nodiscard]] std::shared_ptr<bus::Participant> make_participant(const Composition& composition);

/// Below the folder that all components save into: two robots of one composition must not overwrite
/// each other's maps, so "/a" saves into a/, what is in the composition's own namespace at the top.
[[nodiscard]] std::filesystem::path out_folder_of(const ComponentEntry& entry,
                                                  const Composition& composition);

class Host {
 public:
  /// Makes the components of `process` and configures them in order. Live, those that start
  /// unconfigured are only put on the domain, to be led by others. Throws ConfigError for an
  /// unknown type (its remedy lists the known ones) and whatever a component's configuration
  /// throws.
  Host(const Composition& composition, const ProcessEntry& process, const Registry& registry,
       std::shared_ptr<bus::Participant> participant, const HostOptions& options);
  /// As stop().
  ~Host();
  Host(const Host&) = delete;
  Host& operator=(const Host&) = delete;

  /// Live: those that start active begin to work. In lockstep the coordinator activates.
  void activate();
  /// To be called several times a second. Where the process has grown, free memory goes back to the
  /// system.
  void tick();
  /// Deactivates and cleans up in reverse order; cancels long work under way. Never throws.
  void stop() noexcept;
  /// As configured, in order.
  [[nodiscard]] const std::vector<std::unique_ptr<Component>>& components() const {
    return components_;
  }
  /// Errors in callbacks since the last call.
  [[nodiscard]] std::vector<std::string> take_errors();

 private:
  class Cancellation;
  void make(const Composition& composition, const ProcessEntry& process, const Registry& registry,
            const HostOptions& options);
  std::unique_ptr<Cancellation> cancellation_;
  std::mutex mutex_;
  std::vector<std::string> errors_;
  std::shared_ptr<bus::Participant> participant_;
  Executor executor_;
  FreeMemoryTurn free_memory_;
  std::vector<std::unique_ptr<Component>> components_;
  std::vector<Start> starts_;  ///< of the components
  bool stopped_ = false;
};

}  // namespace strata::runtime
