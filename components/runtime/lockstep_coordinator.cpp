// SPDX-License-Identifier: Apache-2.0
#include "components/runtime/lockstep_coordinator.hpp"

#include <chrono>

#include "components/runtime/component.hpp"
#include "components/runtime/topic_count.hpp"
#include "core/base/error.hpp"

namespace strata::runtime {

using strata_msgs::msg::Ack;
using strata_msgs::msg::Step;
using strata_msgs::msg::TopicCount;

namespace {

/// A component may hear its first step before its writer knows our reader: that answer is lost.
/// Once one has come, the reliable topics lose nothing.
constexpr auto kReminder = std::chrono::milliseconds(500);

}  // namespace

LockstepCoordinator::LockstepCoordinator(std::shared_ptr<bus::Participant> participant,
                                         std::vector<std::string> components,
                                         KeepWaiting keep_waiting)
    : participant_(std::move(participant)),
      components_(std::move(components)),
      keep_waiting_(std::move(keep_waiting)) {
  const bus::QosProfile qos = bus::qos_profile("lossless");
  step_writer_ =
      std::make_unique<bus::RawWriter>(participant_, kStepTopic, bus::MessageType<Step>::name, qos);
  // Typed: what is no message is dropped and counted there.
  ack_reader_ =
      std::make_unique<bus::Reader<Ack>>(participant_, kAckTopic, qos, [this](const Ack& ack) {
        const std::lock_guard lock(mutex_);
        if (ack.sequence_number() != sequence_) return;
        ack_ = ack;
        changed_.notify_all();
      });
}

std::shared_ptr<bus::RawWriter> LockstepCoordinator::advertise(const std::string& full_topic,
                                                               const std::string& type) {
  auto writer = std::make_shared<bus::RawWriter>(participant_, full_topic, type,
                                                 bus::qos_profile("lossless"));
  writers_.push_back(writer);
  return writer;
}

void LockstepCoordinator::wait(const std::function<bool()>& condition, const std::string& what,
                               const std::function<void()>& remind) {
  std::unique_lock lock(mutex_);
  const auto begin = std::chrono::steady_clock::now();
  auto reminded = begin;
  while (!changed_.wait_for(lock, std::chrono::milliseconds(50), condition)) {
    lock.unlock();
    const auto now = std::chrono::steady_clock::now();
    const std::chrono::duration<double> waited = now - begin;
    if (!keep_waiting_(what, waited.count())) throw Cancelled(what);
    if (remind && now - reminded > kReminder) {
      remind();
      reminded = now;
    }
    lock.lock();
  }
}

void LockstepCoordinator::connect() {
  const auto count = static_cast<int>(components_.size());
  wait([&] { return step_writer_->matched() >= count && ack_reader_->raw().matched() >= count; },
       "the components");
  Counts readers = other_readers_;
  Counts writers;
  for (const auto& writer : writers_) ++writers[writer->topic()];
  for (const std::string& component : components_) {
    Step hello;
    hello.kind(strata_msgs::msg::STEP_HELLO);
    hello.target(component);
    const Ack ack = ask(std::move(hello));
    for (const TopicCount& topic : ack.subscribed()) {
      ++readers[topic.topic()];
      reads_[component].insert(topic.topic());
    }
    for (const TopicCount& topic : ack.published()) ++writers[topic.topic()];
  }
  for (const auto& writer : writers_) {
    const auto expected = static_cast<int>(readers[writer->topic()]);
    wait([&] { return writer->matched() >= expected; }, writer->topic());
  }
  for (const std::string& component : components_) {
    Step match;
    match.kind(strata_msgs::msg::STEP_MATCH);
    match.target(component);
    for (const auto& [topic, number] : writers) {
      match.expected().push_back(topic_count(topic, number));
    }
    for (const auto& [topic, number] : readers) {
      match.readers().push_back(topic_count(topic, number));
    }
    ask(std::move(match));
  }
}

void LockstepCoordinator::cycle() { ask_all(strata_msgs::msg::STEP_CYCLE, ""); }

void LockstepCoordinator::finish(const std::filesystem::path& out_dir) {
  ask_all(strata_msgs::msg::STEP_FINISH, out_dir.string());
}

LockstepCoordinator::Counts LockstepCoordinator::published_so_far() const {
  Counts total;
  for (const auto& writer : writers_) total[writer->topic()] += writer->count();
  for (const auto& [component, topics] : published_) {
    for (const auto& [topic, count] : topics) total[topic] += count;
  }
  return total;
}

void LockstepCoordinator::ask_all(strata_msgs::msg::StepKind kind, const std::string& out_dir) {
  for (const std::string& component : components_) {
    Step step;
    step.kind(kind);
    step.target(component);
    step.out_dir(out_dir);
    const Counts published = published_so_far();
    for (const std::string& topic : reads_[component]) {
      const auto found = published.find(topic);
      if (found != published.end()) step.expected().push_back(topic_count(topic, found->second));
    }
    ask(std::move(step));
  }
}

void LockstepCoordinator::require_no_stranger(const Ack& ack) const {
  const Counts published = published_so_far();
  for (const auto& writer : writers_) {
    const std::uint64_t sent = published.at(writer->topic());
    for (const TopicCount& heard : ack.subscribed()) {
      if (heard.topic() != writer->topic() || heard.count() <= sent) continue;
      throw Error(writer->topic(),
                  "has " + std::to_string(heard.count()) + " messages, and the replay sent " +
                      std::to_string(sent) + ": somebody else publishes it",
                  "replay on a domain of its own, as with --set domain=42");
    }
  }
}

Ack LockstepCoordinator::ask(Step step) {
  {
    const std::lock_guard lock(mutex_);
    step.sequence_number(++sequence_);
    ack_.reset();
  }
  const auto send = [&] { step_writer_->publish(convert::to_cdr(step)); };
  send();
  const bool is_first = step.kind() == strata_msgs::msg::STEP_HELLO;
  wait([&] { return ack_.has_value(); }, step.target(), is_first ? send : std::function<void()>());
  Ack ack;
  {
    const std::lock_guard lock(mutex_);
    ack = *ack_;
  }
  if (!ack.ok()) throw Error(step.target(), ack.error(), "see the component's page");
  Counts counts;  // a component may have two writers of one topic
  for (const TopicCount& topic : ack.published()) counts[topic.topic()] += topic.count();
  published_[ack.component_name()] = std::move(counts);
  require_no_stranger(ack);
  return ack;
}

}  // namespace strata::runtime
