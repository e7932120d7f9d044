// SPDX-License-Identifier: Apache-2.0
/// How a topic is read to be recorded, and what a bag says of its writers.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "components/bus/participant.hpp"
#include "components/bus/qos.hpp"
#include "core/base/time.hpp"

namespace strata::bus {

/// Whether a part of the name begins with "_": what ROS 2 lists and records only when asked to.
[[nodiscard]] bool is_hidden(const std::string& full_topic);

enum class HiddenTopics { kLeftOut, kTaken };

/// What is published, by topic, as far as whoever records by the full name `recorder` wants it:
/// without what tells of the recorder itself and what leads a lockstep replay. wanted: full topics;
/// empty: all, of which hidden ones may be left out.
[[nodiscard]] std::map<std::string, PublishedTopic> topics_to_record(
    const Participant& participant, const std::string& recorder,
    const std::vector<std::string>& wanted, HiddenTopics hidden = HiddenTopics::kLeftOut);

/// As the writers offer: reliably when all do, latched messages too; best effort and volatile
/// matches every writer. Deep enough that a burst does not push messages out.
[[nodiscard]] QosProfile qos_to_record(const PublishedTopic& published);

/// By this host's clock.
[[nodiscard]] Stamp wall_now();

/// The stamp of a message in a live recording: when it was written, by its writer's clock, or,
/// where that is not about `now`, when it came, which is `now`. What is latched may have been
/// written hours ago, and a player waits between stamps: for that a second is not recent. For
/// others a minute is not: their writer tells no time, or has no clock that is set.
[[nodiscard]] Stamp stamp_to_record(Stamp written, bool is_latched, Stamp now);

/// rosbag2's text for the QoS profiles of all writers (`offered_qos_profiles`), with its numbers
/// for the words. Discovery does not tell the history, which rosbag2 then writes as unknown (3) and
/// 0.
[[nodiscard]] std::string offered_qos_text(const PublishedTopic& published);

/// The hash of the type that the writers tell; empty when none does or they do not agree.
[[nodiscard]] std::string offered_type_hash(const PublishedTopic& published);

}  // namespace strata::bus
