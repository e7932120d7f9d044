// SPDX-License-Identifier: Apache-2.0
/// strata::Recorder: topics in, a rosbag2 bag out, message by message as the bytes they came in.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "components/bus/second_reader.hpp"
#include "components/log/bag.hpp"
#include "components/recorder/config.hpp"
#include "components/runtime/component.hpp"
#include "components/runtime/unreadable_topics.hpp"

namespace strata::recorder {

/// Reads as the writers that are there offer: reliably when all do, latched messages too;
/// losslessly in lockstep. Messages are stamped as bus::stamp_to_record says: with when they were
/// written, old latched ones with when they came; in lockstep with the log's time from /clock.
/// Latched ones that came during a pause are written after it, as if they had come then.
/// Deactivating completes the bag; activating again goes on in another file of it, configuring
/// again in another folder beside it. What came more than a second ago survives the end of the
/// process by whatever cause. When the disk is full, it goes on in another file of
/// the bag as soon as there is room again. Controlled as rosbag2's recorder, by services ~/pause,
/// ~/resume, ~/is_paused and ~/split_bagfile, and by the parameter `paused`.
class Recorder final : public runtime::Component {
 public:
  using Component::Component;
  /// Whether the bag has all that has come, as far as it was looked at: a disk that was full in
  /// between may have cost nothing. Once deactivated: whether the bag is complete. From any thread.
  [[nodiscard]] bool is_whole() const { return is_whole_; }
  /// Of `topics` those that nobody has published, "/scan, /odom". Once deactivated.
  [[nodiscard]] std::string unpublished() const;
  /// ... and those that somebody did, and of which nothing has come. Once deactivated.
  [[nodiscard]] std::string silent() const;

 private:
  /// A topic that is read; its place in the bag is given when its writers are known.
  struct Recorded {
    std::string type;
    bus::SecondReader second;  ///< of later writers
    bool latched = false;
    std::map<bus::Guid, std::int64_t> last_numbers{};  ///< of messages taken, by writer
    std::uint64_t missed{};                            ///< this came too fast
    bool has_come = false;
    std::set<bus::Guid> known_writers{};  ///< whose topic was looked at in this pause
    std::optional<std::size_t> place{};
  };
  struct Held {
    std::string topic;
    bus::RawMessage message;
  };

  void on_declare() override { declare_parameters<RecorderConfig>(); }
  void on_configure() override;
  void on_activate() override;
  void on_tick() override;
  void on_deactivate() override;
  void on_cleanup() override;
  void on_diagnose(runtime::Health& health) const override;
  /// Offers the services.
  void serve();
  // Which topics are read, and how (recorder_topics.cpp).
  [[nodiscard]] std::map<std::string, bus::PublishedTopic> topics_to_record() const;
  /// What of it can be read.
  void record_what_is_published();
  void record(const std::string& topic, const bus::PublishedTopic& published);
  void begin_reading(const std::string& topic, const bus::PublishedTopic& published);
  /// Once a named topic has not been published for a while.
  void tell_unpublished();

  void take(const std::string& topic, const bus::RawMessage& message);
  /// Counts what is missing before that message since its queue was full.
  void count_missed(Recorded& recorded, const bus::SampleIdentity& identity);
  /// Messages that it was too slow for, of this bag.
  [[nodiscard]] std::uint64_t missed() const { return counts().dropped - dropped_before_; }
  void tell_missed();
  void judge_whole();
  [[nodiscard]] Stamp stamp_of(const std::string& topic, const bus::RawMessage& message) const;
  // While it is paused (recorder_pause.cpp).
  void take_paused(bool paused);
  /// For a message of that writer.
  [[nodiscard]] bool is_latched(const std::string& topic, const bus::Guid& writer);
  /// Keeps a latched message until the recording goes on.
  void hold(const std::string& topic, const bus::RawMessage& message);
  void write_held();

  void write(const std::string& topic, const bus::RawMessage& message, Stamp stamp);
  /// Runs what writes into the bag. A disk that is full is told when that begins and when it is
  /// over, not with every message that is lost meanwhile.
  void write_bag(const std::function<void()>& write);

  /// offered: by the writers; nothing when nobody has published the topic yet.
  std::size_t place_of(const std::string& topic, const bus::PublishedTopic* offered);

  RecorderConfig config_;
  std::unique_ptr<log::BagWriter> bag_;
  std::map<std::string, Recorded> recorded_;  ///< by topic
  runtime::UnreadableTopics unreadable_{[this](const std::string& line) { tell_line(line); }};
  std::set<std::string> unpublished_;                                 ///< named, so far
  std::optional<std::chrono::steady_clock::time_point> waits_since_;  ///< for those
  std::list<Held> held_;           ///< latched, while paused; in the order they came
  std::optional<Stamp> log_time_;  ///< lockstep
  std::chrono::steady_clock::time_point flushed_;
  bool is_stuck_ = false;     ///< as told
  bool misses_more_ = false;  ///< what no full disk explains
  std::atomic<bool> is_whole_ = true;
  std::size_t told_lost_ = 0;
  std::uint64_t dropped_before_ = 0;  ///< counts().dropped when the bag was begun
  std::uint64_t explained_ = 0;       ///< of missed(), those whose topic is known
  std::uint64_t told_missed_ = 0;
};

}  // namespace strata::recorder
