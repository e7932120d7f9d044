// SPDX-License-Identifier: Apache-2.0
/// One component in a process of its own participant, and readers that tests can wait on.
#pragma once

#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "components/bus/endpoint.hpp"
#include "components/runtime/host.hpp"
#include "components/settings/yaml_document.hpp"
#include "tests/components/bus/domain.hpp"
#include "tests/support/full_disk.hpp"

namespace strata::test {

/// A live host with the component that `entry` (a YAML flow map, or several with commas) describes.
inline std::unique_ptr<runtime::Host> make_host(const std::string& entry,
                                                const runtime::Registry& registry,
                                                std::shared_ptr<bus::Participant> participant) {
  const std::string text = "processes: [{name: p, components: [" + entry + "]}]\n";
  const auto composition =
      runtime::read_composition(settings::parse_yaml(text, "test.yaml"), "test.yaml");
  return std::make_unique<runtime::Host>(composition, composition.processes[0], registry,
                                         std::move(participant), runtime::HostOptions{});
}

/// Deactivates the host's component while no file can be written; what was told of that. Then
/// activates and deactivates it with room again.
inline std::vector<std::string> deactivate_on_a_full_disk(runtime::Host& host) {
  runtime::Component& component = *host.components().front();
  (void)host.take_errors();
  {
    const FullDisk full;
    component.deactivate();
  }
  EXPECT_EQ(component.state(), runtime::LifecycleState::kInactive);
  std::vector<std::string> told = host.take_errors();
  component.activate();
  component.deactivate();
  EXPECT_TRUE(host.take_errors().empty());
  return told;
}

/// Reads a topic and keeps what comes.
template <typename T>
class Collector {
 public:
  Collector(std::shared_ptr<bus::Participant> participant, const std::string& topic,
            const std::string& qos)
      : reader_(std::move(participant), topic, bus::qos_profile(qos), [this](const T& message) {
          const std::lock_guard lock(mutex_);
          messages_.push_back(message);
          changed_.notify_all();
        }) {}

  [[nodiscard]] bool wait_for_writer() {
    return reader_.raw().wait_for_writers(1, std::chrono::seconds(20));
  }
  /// At least so many messages, or as many as came until patience ends.
  [[nodiscard]] std::vector<T> wait_for(
      std::size_t count, std::chrono::milliseconds patience = std::chrono::seconds(20)) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, patience, [&] { return messages_.size() >= count; });
    return messages_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<T> messages_;
  bus::Reader<T> reader_;  // last: its callback uses the others
};

}  // namespace strata::test
