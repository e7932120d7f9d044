// SPDX-License-Identifier: Apache-2.0
/// Who reads a topic as its first writers offered it hears none that come later and offer less.
#pragma once

#include <map>
#include <memory>
#include <string>

#include "components/bus/participant.hpp"
#include "components/bus/qos.hpp"

namespace strata::bus {

/// Whether a reader that asks for this does not match that writer.
[[nodiscard]] bool offers_less(const DiscoveredEndpoint& writer, const QosProfile& asked);

/// What a second reader asks for: it matches every writer. depth: as the first one's.
[[nodiscard]] QosProfile qos_of_second(const QosProfile& first);

/// Which messages a second reader of the topic is for: those of writers that the first one does not
/// match. It is given the others, too. Not thread safe.
class SecondReader {
 public:
  /// first: what the first reader asks for.
  SecondReader(std::shared_ptr<const Participant> participant, std::string topic, QosProfile first);

  /// Whether there is none and a writer offers less than the first reader asks for.
  [[nodiscard]] bool is_needed(const PublishedTopic& published);
  [[nodiscard]] QosProfile qos() const { return qos_of_second(first_); }
  void begin() { is_there_ = true; }
  /// Whether that writer's messages are the second reader's. Discovery is asked once a writer.
  [[nodiscard]] bool takes(const Guid& writer);

 private:
  void look(const PublishedTopic& published);
  std::shared_ptr<const Participant> participant_;
  std::string topic_;
  QosProfile first_;
  bool is_there_ = false;
  std::map<Guid, bool> offers_less_;  ///< by writer
};

}  // namespace strata::bus
