// SPDX-License-Identifier: Apache-2.0
/// What a component is given, and what is told of it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <set>
#include <string>

#include <yaml-cpp/yaml.h>

#include "components/bus/names.hpp"
#include "components/bus/participant.hpp"
#include "components/bus/qos.hpp"
#include "components/runtime/executor.hpp"
#include "core/base/progress.hpp"

namespace strata::runtime {

class Component;

enum class FeedMode { kLive, kLockstep };

/// Topics on which the coordinator and the components talk in lockstep.
inline constexpr const char* kStepTopic = "/strata_lockstep/step";
inline constexpr const char* kAckTopic = "/strata_lockstep/ack";

/// Everything a component is given.
struct ComponentContext {
  std::shared_ptr<bus::Participant> participant;
  std::shared_ptr<Mailbox> mailbox;
  std::string name;
  std::string node_namespace = "/";
  /// Folder of its own below the folder that all save into; empty: that folder itself.
  std::filesystem::path out_folder;
  bus::Remappings remappings;
  YAML::Node parameters;
  YAML::Node common_parameters;  ///< for all components: each takes those that it knows
  std::string place;             ///< the composition file, for errors
  FeedMode mode = FeedMode::kLive;
  std::uint64_t seed = 1;
  int threads = 1;
  bool use_sim_time = false;     ///< unless the parameters say otherwise
  Progress* progress = nullptr;  ///< cancels long work when the process ends
  /// Makes another component of the same type; null: parameters cannot be tried out.
  std::function<std::unique_ptr<Component>(ComponentContext)> make;
  /// Only configured, to be looked at: writes no files.
  bool dry_run = false;
  /// Folders that the component made, in this life and those before: it may go on beside them.
  std::shared_ptr<std::set<std::filesystem::path>> own_folders =
      std::make_shared<std::set<std::filesystem::path>>();
  /// Told of an error in a live callback; called on the component's thread.
  std::function<void(const std::string&)> on_error;
};

/// A topic that a component reads or writes.
struct TopicUse {
  std::string topic;  ///< full name
  std::string type;
  bus::QosProfile qos;
  bool writes = false;
};

/// Every message is counted once: what is received and nowhere else yet, waits.
struct MessageCounts {
  std::uint64_t received = 0;
  std::uint64_t processed = 0;
  std::uint64_t skipped = 0;  ///< were no messages, or the callback threw
  std::uint64_t dropped = 0;  ///< came faster than they were worked on
  std::uint64_t ignored = 0;  ///< came while the component was not active
  [[nodiscard]] std::uint64_t done() const { return processed + skipped + dropped + ignored; }
};

}  // namespace strata::runtime
