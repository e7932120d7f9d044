// SPDX-License-Identifier: Apache-2.0
#include "components/recorder/recorder.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "components/bus/bag_service_types.hpp"
#include "components/bus/recorded_topic.hpp"
#include "components/convert/geometry_messages.hpp"
#include "components/log/folder_name.hpp"
#include "components/log/writable_place.hpp"

namespace strata::recorder {
namespace {

constexpr auto kFlushPeriod = std::chrono::milliseconds(500);
/// Latched messages of one topic that are held in a pause, at most.
constexpr int kMaxHeld = 1000;

log::BagOptions bag_options(const RecorderConfig& config) {
  log::BagOptions options;
  options.storage = config.storage;
  options.chunks = config.compression;
  options.sqlite_schema = config.sqlite_schema;
  options.split_bytes = static_cast<std::uint64_t>(config.split_mb * 1e6);
  options.split_after = Duration::from_seconds(config.split_s);
  return options;
}

/// One name for a folder, before it exists and after: absolute, without links and a slash at its
/// end. weakly_canonical leaves a relative path relative as long as nothing of it exists.
std::filesystem::path normal_form(const std::filesystem::path& folder) {
  return log::without_slash(std::filesystem::weakly_canonical(std::filesystem::absolute(folder)));
}

/// The folder to write: the one that is asked for or, when it may be numbered, the first free one.
std::filesystem::path free_folder(const RecorderConfig& config, bool may_number) {
  const std::filesystem::path out = log::without_slash(config.out);  // beside "bag/", not in it
  std::filesystem::path folder = out;
  for (int number = 2; may_number && std::filesystem::exists(folder); ++number) {
    folder = out.string() + "_" + std::to_string(number);
  }
  return folder;
}

}  // namespace

void Recorder::on_configure() {
  config_ = read_parameters<RecorderConfig>();
  recorded_.clear();
  log_time_.reset();
  // Configured again, it finds its own bag there; another's is left alone.
  const std::filesystem::path out = normal_form(config_.out);
  const bool may_number = config_.number_if_exists || context().own_folders->contains(out);
  const std::filesystem::path folder = free_folder(config_, may_number);
  if (context().dry_run) {
    log::require_new_folder(folder);
    log::require_folder_place(folder);
  } else {
    bag_ = std::make_unique<log::BagWriter>(folder, bag_options(config_));
    context().own_folders->insert(out);
  }
  if (lockstep()) {
    subscribe<rosgraph_msgs::msg::Clock>("/clock", "clock", [this](const auto& message) {
      log_time_ = convert::from_message(message.clock());
    });
  }
  serve();
  const auto published = context().participant->published_topics();
  for (std::string& topic : config_.topics) {
    const std::size_t colon = topic.find(':');
    const std::string type = colon == std::string::npos ? "" : topic.substr(colon + 1);
    topic = resolve(topic.substr(0, colon));
    if (type.empty()) continue;
    const auto found = published.find(topic);
    const bool is_offered = found != published.end() && found->second.type == type;
    // Nobody may publish it yet: best effort and volatile, which matches every writer.
    record(topic, is_offered ? found->second : bus::PublishedTopic{type, false, false});
  }
  // That this process cannot read what it writes itself is its composition's fault.
  for (const auto& [topic, offered] : topics_to_record()) {
    if (offered.is_own) record(topic, offered);
  }
  record_what_is_published();
}

void Recorder::serve() {
  const auto set_paused = [this](bool paused) {
    (void)set_parameters({runtime::parameter("paused", runtime::parameter_value(paused))});
  };
  keep_live<RecorderConfig>({"paused"},
                            [this](const RecorderConfig& config) { take_paused(config.paused); });
  offer<bus::srv::Pause>("~/pause", [set_paused](const auto&) {
    set_paused(true);
    return rosbag2_interfaces::srv::Pause_Response();
  });
  offer<bus::srv::Resume>("~/resume", [set_paused](const auto&) {
    set_paused(false);
    return rosbag2_interfaces::srv::Resume_Response();
  });
  offer<bus::srv::IsPaused>("~/is_paused", [this](const auto&) {
    rosbag2_interfaces::srv::IsPaused_Response response;
    response.paused(config_.paused);
    return response;
  });
  offer<bus::srv::SplitBagfile>("~/split_bagfile", [this](const auto&) {
    if (bag_) bag_->close();  // the next message begins another file of the bag
    return rosbag2_interfaces::srv::SplitBagfile_Response();
  });
}

void Recorder::take_paused(bool paused) {
  const bool goes_on = config_.paused && !paused;
  config_.paused = paused;
  for (auto& [topic, recorded] : recorded_) recorded.known_writers.clear();  // many may come and go
  // While it rests, the bag is complete.
  if (goes_on && state() == runtime::LifecycleState::kActive) write_held();
}

/// As if they came now, by their writers' clocks: with their own stamps, those that came early in a
/// pause would stand alone there, and a player would wait for what follows.
void Recorder::write_held() {
  const auto now = std::chrono::steady_clock::now();
  std::map<std::string, Stamp> last;  // by topic: they stay in order
  for (const Held& held : std::exchange(held_, {})) {
    const std::chrono::nanoseconds kept = now - held.since;
    Stamp& stamp = last.try_emplace(held.topic, Stamp{held.message.source_stamp_ns}).first->second;
    stamp = std::max(stamp, Stamp{held.message.source_stamp_ns + kept.count()});
    // Each by itself: a full disk ends neither the process nor the attempt with the others.
    guarded([&] { write(held.topic, held.message, stamp); });
  }
}

void Recorder::on_activate() {
  if (!config_.paused) write_held();
}

void Recorder::on_tick() {
  try {
    record_what_is_published();
  } catch (...) {
    misses_more_ = true;
    is_whole_ = false;
    throw;
  }
  const auto now = std::chrono::steady_clock::now();
  if (!bag_ || now - flushed_ < kFlushPeriod) return;
  flushed_ = now;
  write_bag([this] { bag_->flush(); });
}

void Recorder::write_bag(const std::function<void()>& write) {
  std::optional<OutputError> problem;
  try {
    write();
  } catch (const OutputError& error) {
    problem = error;
  } catch (...) {
    misses_more_ = true;
    is_whole_ = false;
    throw;
  }
  const log::BagGap gap = bag_->gap();
  is_whole_ = !misses_more_ && !gap.lasts && gap.lost == 0;
  const bool was_stuck = std::exchange(is_stuck_, gap.lasts);
  if (was_stuck && !gap.lasts) {
    const std::size_t lost = gap.lost - std::exchange(told_lost_, gap.lost);
    tell(OutputError(config_.out,
                     "is written again, in another file of the bag; " + std::to_string(lost) +
                         " messages were lost",
                     "keep room on the disk"));
  }
  if (problem && !(was_stuck && gap.lasts)) throw *problem;
}

std::map<std::string, bus::PublishedTopic> Recorder::topics_to_record() const {
  return bus::topics_to_record(*context().participant, full_name(), config_.topics);
}

void Recorder::record_what_is_published() {
  const auto topics = topics_to_record();
  unreadable_.keep_only(topics);
  for (const auto& [topic, published] : topics) {
    if (unreadable_.read(topic, published, [&] { record(topic, published); })) {
      place_of(topic, &published);
    } else {
      misses_more_ = true;
      is_whole_ = false;
    }
  }
}

void Recorder::record(const std::string& topic, const bus::PublishedTopic& published) {
  const auto [entry, is_new] = recorded_.try_emplace(topic, Recorded{published.type});
  entry->second.latched = entry->second.latched || published.transient_local;
  if (!is_new) return;
  try {
    subscribe_raw(topic, published.type, bus::qos_to_record(published),
                  [this, topic](const bus::RawMessage& message) { take(topic, message); },
                  {.latched_depth = std::max(1, config_.latched_depth)});
  } catch (...) {
    recorded_.erase(entry);  // it may be tried again
    throw;
  }
}

std::size_t Recorder::place_of(const std::string& topic, const bus::PublishedTopic* offered) {
  Recorded& recorded = recorded_.at(topic);
  if (!recorded.place && bag_) {
    log::BagTopic entry{topic, recorded.type};
    if (offered != nullptr) {
      entry.offered_qos_profiles = bus::offered_qos_text(*offered);
      entry.type_hash = bus::offered_type_hash(*offered);
    }
    recorded.place = bag_->add_topic(entry);
  }
  return recorded.place.value_or(0);
}

void Recorder::take(const std::string& topic, const bus::RawMessage& message) {
  if (!config_.paused) {
    write(topic, message, log_time_.value_or(Stamp{message.source_stamp_ns}));
  } else if (is_latched(topic, message.identity.writer)) {
    hold(topic, message);
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
  held_.push_back({topic, message, std::chrono::steady_clock::now()});
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

void Recorder::write(const std::string& topic, const bus::RawMessage& message, Stamp stamp) {
  if (!bag_) return;
  const Recorded& recorded = recorded_.at(topic);
  if (!recorded.place) {
    const auto published = context().participant->published_topics();
    const auto found = published.find(topic);
    place_of(topic, found == published.end() ? nullptr : &found->second);
  }
  // Live by time that passes here: stamps are by the clocks of many, and of what is latched old.
  const std::chrono::nanoseconds now = std::chrono::steady_clock::now().time_since_epoch();
  const Stamp at = lockstep() ? stamp : Stamp{now.count()};
  write_bag([&] { bag_->write(*recorded.place, stamp, message.cdr, at); });
}

void Recorder::on_deactivate() {
  if (!bag_) return;
  is_whole_ = false;
  bag_->close();
  write_bag([] {});  // tells what was lost before
}

void Recorder::on_diagnose(runtime::Health& health) const {
  if (!bag_) return;
  unreadable_.tell(health);
  const log::BagGap gap = bag_->gap();
  if (gap.lasts) health.fail(config_.out + ": cannot be written; free some space");
  health.add("lost on a full disk", static_cast<std::uint64_t>(gap.lost));
}

void Recorder::on_cleanup() {
  bag_.reset();
  recorded_.clear();
  unreadable_.clear();
  held_.clear();
  is_stuck_ = false;
  misses_more_ = false;
  is_whole_ = true;
  told_lost_ = 0;
}

}  // namespace strata::recorder
