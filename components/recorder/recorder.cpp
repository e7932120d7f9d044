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
/// Whose messages are numbered, of one topic; writers may come and go.
constexpr std::size_t kMaxWriters = 1000;

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
  unpublished_.clear();
  log_time_.reset();
  dropped_before_ = counts().dropped;
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
    unpublished_.insert(topic);
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

void Recorder::on_activate() {
  waits_since_ = std::chrono::steady_clock::now();
  if (!config_.paused) write_held();
}

void Recorder::on_tick() {
  if (missed() > 0) {
    judge_whole();
    if (told_missed_ == 0) tell_missed();
  }
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
  judge_whole();
  const log::BagGap gap = bag_->gap();
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

void Recorder::judge_whole() {
  const log::BagGap gap = bag_ ? bag_->gap() : log::BagGap();
  is_whole_ = !misses_more_ && !gap.lasts && gap.lost == 0 && missed() == 0;
}

void Recorder::take(const std::string& topic, const bus::RawMessage& message) {
  Recorded& recorded = recorded_.at(topic);
  if (!std::exchange(recorded.has_come, true)) unpublished_.erase(topic);
  count_missed(recorded, message.identity);
  if (!config_.paused) {
    write(topic, message, stamp_of(topic, message));
  } else if (is_latched(topic, message.identity.writer)) {
    hold(topic, message);
  }
}

Stamp Recorder::stamp_of(const std::string& topic, const bus::RawMessage& message) const {
  const Stamp written{message.source_stamp_ns};
  if (lockstep()) return log_time_.value_or(written);
  return bus::stamp_to_record(written, recorded_.at(topic).latched, bus::wall_now());
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

/// Each message that did not wait any more has left a gap in its writer's numbers. On a network
/// that loses messages there are more gaps than that.
void Recorder::count_missed(Recorded& recorded, const bus::SampleIdentity& identity) {
  if (recorded.last_numbers.size() > kMaxWriters) recorded.last_numbers.clear();
  const std::int64_t number = identity.sequence_number;
  std::int64_t& last = recorded.last_numbers.try_emplace(identity.writer, number - 1).first->second;
  const std::int64_t gap = number - std::exchange(last, number) - 1;
  if (gap <= 0) return;
  const std::uint64_t explained = std::min(static_cast<std::uint64_t>(gap), missed() - explained_);
  explained_ += explained;
  recorded.missed += explained;
}

void Recorder::tell_missed() {
  told_missed_ = missed();
  std::string by_topic;
  for (const auto& [topic, recorded] : recorded_) {
    if (recorded.missed == 0) continue;
    by_topic += (by_topic.empty() ? " (" : ", ") + topic + ": " + std::to_string(recorded.missed);
  }
  tell(OutputError(config_.out,
                   "lacks " + std::to_string(told_missed_) +
                       " messages, which came faster than they could be written" + by_topic +
                       (by_topic.empty() ? "" : ")"),
                   "name fewer --topics, or record onto a faster disk"));
}

void Recorder::on_deactivate() {
  if (!bag_) return;
  if (missed() > told_missed_) tell_missed();
  for (const auto& [topic, published] : topics_to_record()) unpublished_.erase(topic);
  is_whole_ = false;
  bag_->close();
  write_bag([] {});  // tells what was lost before
}

void Recorder::on_diagnose(runtime::Health& health) const {
  if (!bag_) return;
  unreadable_.tell(health);
  if (!unpublished_.empty()) health.warn("nobody publishes " + unpublished());
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
  waits_since_.reset();
  explained_ = 0;
  told_missed_ = 0;
  dropped_before_ = counts().dropped;
}

}  // namespace strata::recorder
