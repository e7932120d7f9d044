// SPDX-License-Identifier: Apache-2.0
// What a recorder does with what is latched and comes while it is paused.
#include <algorithm>
#include <utility>

#include "components/bus/recorded_topic.hpp"
#include "components/recorder/recorder.hpp"

namespace strata::recorder {
namespace {

/// Latched messages of one topic that are held in a pause, at most.
constexpr int kMaxHeld = 1000;

}  // namespace

void Recorder::take_paused(bool paused) {
  const bool goes_on = config_.paused && !paused;
  config_.paused = paused;
  for (auto& [topic, recorded] : recorded_) recorded.known_writers.clear();  // many may come and go
  // While it rests, the bag is complete.
  if (goes_on && state() == runtime::LifecycleState::kActive) write_held();
}

/// As if they came now: with their own stamps, those that came early in a pause would stand alone
/// there, and a player would wait for what follows.
void Recorder::write_held() {
  for (const Held& held : std::exchange(held_, {})) {
    // Each by itself: a full disk ends neither the process nor the attempt with the others.
    guarded([&] { write(held.topic, held.message, bus::wall_now()); });
  }
}

bool Recorder::is_latched(const std::string& topic, const bus::Guid& writer) {
  Recorded& recorded = recorded_.at(topic);
  // When its reading began, nobody may have published it yet. Asked once a writer: it takes long.
  if (recorded.latched || recorded.known_writers.contains(writer)) return recorded.latched;
  const auto published = context().participant->published_topics();
  if (const auto found = published.find(topic); found != published.end()) {
    recorded.latched = found->second.transient_local;
    recorded.known_writers.insert(writer);
  }
  return recorded.latched;
}

/// A writer's last ones, as it keeps them for who comes late; how many that are it does not tell.
void Recorder::hold(const std::string& topic, const bus::RawMessage& message) {
  held_.push_back({topic, message});
  const auto drop_first = [&](std::size_t most, const auto& is_alike) {
    const auto count = std::count_if(held_.begin(), held_.end(), is_alike);
    if (static_cast<std::size_t>(count) <= most) return;
    held_.erase(std::find_if(held_.begin(), held_.end(), is_alike));
  };
  drop_first(static_cast<std::size_t>(config_.latched_depth), [&](const Held& held) {
    return held.topic == topic && held.message.identity.writer == message.identity.writer;
  });
  // Writers may come and go for as long as the pause lasts.
  drop_first(kMaxHeld, [&](const Held& held) { return held.topic == topic; });
}

}  // namespace strata::recorder
