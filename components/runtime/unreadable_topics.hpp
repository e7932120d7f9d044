// SPDX-License-Identifier: Apache-2.0
/// Topics that others publish and a component cannot read.
#pragma once

#include <functional>
#include <map>
#include <string>

#include "components/bus/participant.hpp"
#include "components/runtime/diagnostics.hpp"
#include "components/runtime/told_errors.hpp"

namespace strata::runtime {

/// For who reads every topic that there is: one that its enclave may not read, or that the process
/// has with another type, keeps none of the others from being read. Not thread safe.
class UnreadableTopics {
 public:
  /// tell: what a user should know, once for each topic and reason; not more than ToldErrors.
  explicit UnreadableTopics(std::function<void(const std::string& line)> tell)
      : tell_(std::move(tell)) {}

  /// Runs `subscribe`, unless it has failed for that topic as it is published; whether it did and
  /// the topic is read now. Lets through what is no Error of ours: memory may be there again.
  bool read(const std::string& topic, const bus::PublishedTopic& published,
            const std::function<void()>& subscribe);
  /// Forgets those that are not published any more.
  void keep_only(const std::map<std::string, bus::PublishedTopic>& published);
  /// Warns as long as there are some.
  void tell(Health& health) const;
  void clear() { failed_.clear(); }

 private:
  struct Failed {
    std::string type;
    std::string reason;
  };
  std::function<void(const std::string&)> tell_;
  std::map<std::string, Failed> failed_;  ///< by topic
  ToldErrors told_;
};

}  // namespace strata::runtime
