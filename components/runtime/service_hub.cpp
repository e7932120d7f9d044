// SPDX-License-Identifier: Apache-2.0
#include "components/runtime/service_hub.hpp"

namespace strata::runtime {
namespace {

constexpr std::size_t kMaxWaiting = 1000;  // requests of one service

}  // namespace

void ServiceHub::serve_raw(const std::string& name, const std::string& type,
                           const bus::QosProfile& qos, RawHandler handler) {
  const auto entry = std::make_shared<Entry>();
  entry->handler = std::move(handler);
  const std::weak_ptr<Entry> weak = entry;
  const auto on_request = [this, mailbox = mailbox_, weak,
                           counts = counts_](bus::ServiceRequest request) {
    const auto held = weak.lock();
    if (!held) return;
    if (held->waiting >= kMaxWaiting) {
      ++counts->dropped;
      return;
    }
    ++held->waiting;
    mailbox->post([this, weak, request = std::move(request)] {
      const auto still = weak.lock();
      if (!still) return;
      --still->waiting;
      take(*still, weak, request);
    });
  };
  const auto on_match = [mailbox = mailbox_, weak] {
    mailbox->post([weak] {
      const auto held = weak.lock();
      if (held && held->server) held->server->flush();
    });
  };
  entry->server =
      std::make_unique<bus::ServiceServer>(participant_, name, type, qos, on_request, on_match);
  entries_.push_back(entry);  // now: everything in the list is whole
}

void ServiceHub::take(Entry& entry, const std::weak_ptr<Entry>& weak,
                      const bus::ServiceRequest& request) {
  ++counts_->taken;
  const auto reply = [weak, request](const Bytes& response) {
    const auto still = weak.lock();
    if (!still) return;
    try {
      still->server->reply(request, response);
    } catch (const std::exception&) {  // NOLINT(bugprone-empty-catch): the client is gone
    }
  };
  guarded(tell_, [&] { entry.handler(request.cdr, reply); });
}

std::vector<bus::Guid> ServiceHub::readers() const {
  std::vector<bus::Guid> guids;
  for (const auto& entry : entries_) guids.push_back(entry->server->reader_guid());
  return guids;
}

std::vector<bus::Guid> ServiceHub::writers() const {
  std::vector<bus::Guid> guids;
  for (const auto& entry : entries_) guids.push_back(entry->server->writer_guid());
  return guids;
}

}  // namespace strata::runtime
