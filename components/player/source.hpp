// SPDX-License-Identifier: Apache-2.0
/// Something to play, one step after the other.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "components/bus/endpoint.hpp"
#include "components/log/bag.hpp"
#include "components/player/log_player.hpp"
#include "core/base/interface.hpp"

namespace strata::player {

/// Used by one thread at a time.
class Source : public Interface {
 public:
  /// When the next step is due, since the beginning; false at the end. May read for long.
  [[nodiscard]] virtual bool peek(Duration& since_begin) = 0;
  /// Publishes the step that peek announced. Throws InputError for a stamp that messages cannot
  /// carry.
  virtual void step() = 0;
  /// The next step is the first one at or after that time; false, and the next step stays what it
  /// is, when there is none. May read for long.
  [[nodiscard]] virtual bool seek(Duration since_begin) = 0;
  /// The stamp of the first step; nothing when there is no step. May read for long.
  [[nodiscard]] virtual std::optional<Stamp> begin() = 0;
  /// How many messages of the log were none and were not published; thread safe.
  [[nodiscard]] virtual std::uint64_t left_out() const { return 0; }
};

/// Scan by scan.
class ScanSource final : public Source {
 public:
  explicit ScanSource(LogPlayer player) : player_(std::move(player)) {}
  bool peek(Duration& since_begin) override;
  void step() override { player_.publish(next_++); }
  bool seek(Duration since_begin) override;
  std::optional<Stamp> begin() override;

 private:
  LogPlayer player_;
  std::size_t next_ = 0;
};

/// Message by message, as the bytes that were recorded.
class BagSource final : public Source {
 public:
  using Advertise = std::function<std::shared_ptr<bus::RawWriter>(const log::BagTopic&)>;
  /// topics: empty for all. advertise: makes the writer of a topic. Once `stop` is requested
  /// nothing more is found. Throws InputError when the path is no bag or has none of the topics.
  BagSource(std::filesystem::path bag, const std::vector<std::string>& topics,
            const Advertise& advertise, std::stop_token stop,
            std::function<void(const rosgraph_msgs::msg::Clock&)> publish_clock);
  bool peek(Duration& since_begin) override;
  void step() override;
  bool seek(Duration since_begin) override;
  std::optional<Stamp> begin() override;
  std::uint64_t left_out() const override { return left_out_; }

 private:
  [[nodiscard]] bool fetch();
  /// The next message of a topic that is played.
  [[nodiscard]] bool read_played(log::BagReader& reader, log::BagMessage& message) const;

  std::filesystem::path bag_;
  std::map<std::string, std::shared_ptr<bus::RawWriter>> writers_;  ///< by recorded topic
  std::stop_token stop_;
  std::function<void(const rosgraph_msgs::msg::Clock&)> publish_clock_;
  std::unique_ptr<log::BagReader> reader_;
  log::BagMessage message_;
  std::atomic<std::uint64_t> left_out_{0};
  bool fetched_ = false;
  std::optional<Stamp> begin_;  ///< once something was fetched
};

/// From `begin` on; stays at the longest where a damaged bag's stamps lie further apart than a
/// Duration can say.
[[nodiscard]] Duration since(Stamp begin, Stamp stamp);
/// The profile that a bag says a topic was offered with; of several, one that whoever read one of
/// the writers can read. "default" where it does not say.
[[nodiscard]] bus::QosProfile recorded_qos(const log::BagTopic& topic);

}  // namespace strata::player
