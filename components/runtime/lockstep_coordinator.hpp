// SPDX-License-Identifier: Apache-2.0
/// Drives components in lockstep: publish one cycle's messages, then let each component in turn
/// work on exactly what has been published so far. Reliable keep-all topics lose nothing and counts
/// say when everything is there, so the result does not depend on threads, processes or transport.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "components/bus/endpoint.hpp"

namespace strata::runtime {

class LockstepCoordinator {
 public:
  /// Whether to wait on for this: a component, or a topic whose ends are not matched yet.
  using KeepWaiting = std::function<bool(const std::string& what, double waited_s)>;

  /// components: full names in the order of work. keep_waiting: asked several times a second while
  /// waiting; false, or an exception, ends the wait (interrupt, a process that died).
  LockstepCoordinator(std::shared_ptr<bus::Participant> participant,
                      std::vector<std::string> components, KeepWaiting keep_waiting);

  /// A topic that the coordinator's side publishes; all of them before connect().
  [[nodiscard]] std::shared_ptr<bus::RawWriter> advertise(const std::string& full_topic,
                                                          const std::string& type);
  template <typename T>
  [[nodiscard]] std::function<void(const T&)> advertise(const std::string& full_topic) {
    auto writer = advertise(full_topic, bus::MessageType<T>::name);
    return [writer](const T& message) { writer->publish(convert::to_cdr(message)); };
  }

  /// A reader that is no component's: connect() waits until it is matched too.
  void expect_reader(const std::string& full_topic) { ++other_readers_[full_topic]; }

  /// Finds all components, waits until every writer is matched with every reader of its topic, and
  /// activates. Throws Error when a component reports one, Cancelled when the wait is ended.
  void connect();
  /// Every component works on what was published since its last step.
  void cycle();
  /// As cycle, then each saves its part into out_dir.
  void finish(const std::filesystem::path& out_dir);

 private:
  using Counts = std::map<std::string, std::uint64_t>;
  strata_msgs::msg::Ack ask(strata_msgs::msg::Step step);
  [[nodiscard]] Counts published_so_far() const;
  /// Throws Error when a component heard more of the coordinator's topics than was sent: what comes
  /// out would not be what the log says.
  void require_no_stranger(const strata_msgs::msg::Ack& ack) const;
  void ask_all(strata_msgs::msg::StepKind kind, const std::string& out_dir);
  /// remind: asked for again and again while the condition does not hold, where there is one.
  void wait(const std::function<bool()>& condition, const std::string& what,
            const std::function<void()>& remind = {});

  std::shared_ptr<bus::Participant> participant_;
  std::vector<std::string> components_;
  KeepWaiting keep_waiting_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<strata_msgs::msg::Ack> ack_;  // under mutex_; of the step asked for last
  std::uint64_t sequence_ = 0;                // under mutex_
  std::vector<std::shared_ptr<bus::RawWriter>> writers_;
  Counts other_readers_;
  std::map<std::string, Counts> published_;             // by component, then topic
  std::map<std::string, std::set<std::string>> reads_;  // by component
  std::unique_ptr<bus::RawWriter> step_writer_;
  std::unique_ptr<bus::Reader<strata_msgs::msg::Ack>> ack_reader_;
};

}  // namespace strata::runtime
