// SPDX-License-Identifier: Apache-2.0
#include "components/runtime/service_hub.hpp"

#include "core/base/error.hpp"

namespace strata::runtime {

void ServiceHub::serve_raw(const std::string& name, const std::string& type,
                           const bus::QosProfile& qos, RawHandler handler) {
  const auto entry = std::make_shared<Entry>();
  entry->handler = std::move(handler);
  const std::weak_ptr<Entry> weak = entry;
  const auto on_request = [mailbox = mailbox_, weak](bus::ServiceRequest request) {
    mailbox->post([weak, request = std::move(request)] {
      const auto held = weak.lock();
      if (!held || !held->server) return;
      try {
        held->handler(request.cdr, [weak, request](const Bytes& response) {
          const auto still = weak.lock();
          if (!still) return;
          try {
            still->server->reply(request, response);
          } catch (const OutputError&) {  // NOLINT(bugprone-empty-catch): the client is gone
          }
        });
      } catch (const InputError&) {  // NOLINT(bugprone-empty-catch): no request, no answer
      }
    });
  };
  const auto on_match = [mailbox = mailbox_, weak] {
    mailbox->post([weak] {
      const auto held = weak.lock();
      if (held && held->server) held->server->flush();
    });
  };
  entries_.push_back(entry);
  entry->server =
      std::make_unique<bus::ServiceServer>(participant_, name, type, qos, on_request, on_match);
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
