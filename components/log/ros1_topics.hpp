// SPDX-License-Identifier: Apache-2.0
/// The connections of a ROS 1 bag as topics, and their messages as those of ROS 2.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "components/log/bag.hpp"
#include "components/log/ros1_messages.hpp"
#include "components/log/ros1_records.hpp"

namespace strata::log {

class Ros1Topics {
 public:
  /// One topic for all connections of the same name and type. A type that is not known, or has
  /// another definition than ROS 1's, keeps its bytes and its name, and the serialization format
  /// "ros1".
  [[nodiscard]] const std::vector<BagTopic>& topics() const { return topics_; }
  /// A connection's record; one that is known is passed over. Returns what is wrong with it, or
  /// nothing.
  std::string add(const Ros1Fields& fields, View data);
  /// The message of a record. place: of the record. Throws InputError when it is not readable or
  /// belongs to no connection.
  [[nodiscard]] BagMessage message(const Ros1Fields& fields, View data,
                                   const std::string& place) const;

 private:
  struct Connection {
    std::size_t topic = 0;
    std::optional<Ros1Type> type;
  };
  std::map<std::uint32_t, Connection> connections_;
  std::vector<BagTopic> topics_;
};

}  // namespace strata::log
