// SPDX-License-Identifier: Apache-2.0
#include "components/runtime/unreadable_topics.hpp"

#include "core/base/error.hpp"

namespace strata::runtime {

bool UnreadableTopics::read(const std::string& topic, const bus::PublishedTopic& published,
                            const std::function<void()>& subscribe) {
  const auto known = failed_.find(topic);
  if (known != failed_.end() && known->second.type == published.type) return false;
  try {
    subscribe();
  } catch (const Error& error) {
    const std::string reason = one_line("cannot read " + std::string(error.what()));
    failed_.insert_or_assign(topic, Failed{published.type, reason});
    const auto line = told_.take(reason, ToldErrors::Clock::now());
    if (line && tell_) tell_(*line);
    return false;
  }
  if (known != failed_.end()) failed_.erase(known);
  return true;
}

void UnreadableTopics::keep_only(const std::map<std::string, bus::PublishedTopic>& published) {
  std::erase_if(failed_, [&](const auto& entry) { return !published.contains(entry.first); });
}

void UnreadableTopics::tell(Health& health) const {
  health.add("topics not read", std::uint64_t{failed_.size()});
  if (failed_.empty()) return;
  const std::string& first = failed_.begin()->second.reason;
  const std::size_t more = failed_.size() - 1;
  health.warn(more == 0 ? first : first + " (and " + std::to_string(more) + " more topics)");
}

}  // namespace strata::runtime
