// SPDX-License-Identifier: Apache-2.0
/// The services of one component: requests wait in its mailbox like everything else it does.
#pragma once

#include <atomic>
#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "components/bus/service.hpp"
#include "components/runtime/executor.hpp"

namespace strata::runtime {

class ServiceHub {
 public:
  /// tell: called on the mailbox with what a handler threw or a request lacked.
  ServiceHub(std::shared_ptr<bus::Participant> participant, std::shared_ptr<Mailbox> mailbox,
             std::function<void(const std::exception&)> tell)
      : participant_(std::move(participant)),
        mailbox_(std::move(mailbox)),
        tell_(std::move(tell)) {}

  /// What a request is answered with: once, on whatever thread; nothing happens when the hub or
  /// the client is gone.
  template <typename S>
  using Reply = std::function<void(const typename bus::ServiceType<S>::Response&)>;
  template <typename S>
  using LateHandler = std::function<void(const typename bus::ServiceType<S>::Request&, Reply<S>)>;

  /// name: full. handler: called on the mailbox. Requests that do not decode are told and get no
  /// answer; what the handler throws is told, and the client gets the empty response. All or
  /// nothing: when this throws, the service is not there.
  template <typename S>
  void serve(const std::string& name, const std::string& qos,
             std::function<typename bus::ServiceType<S>::Response(
                 const typename bus::ServiceType<S>::Request&)>
                 handler) {
    serve_later<S>(name, qos,
                   [handler = std::move(handler), tell = tell_](const auto& request, auto reply) {
                     typename bus::ServiceType<S>::Response response;
                     guarded(tell, [&] { response = handler(request); });
                     reply(response);
                   });
  }
  /// As above; the handler may leave the answer to others. When it throws there is none.
  template <typename S>
  void serve_later(const std::string& name, const std::string& qos, LateHandler<S> handler) {
    using Type = bus::ServiceType<S>;
    serve_raw(name, Type::name, bus::qos_profile(qos),
              [name, handler = std::move(handler)](const Bytes& cdr, RawReply reply) {
                handler(convert::from_cdr<typename Type::Request>(cdr, name),
                        [reply = std::move(reply)](const typename Type::Response& response) {
                          reply(convert::to_cdr(response));
                        });
              });
  }

  [[nodiscard]] std::vector<bus::Guid> readers() const;
  [[nodiscard]] std::vector<bus::Guid> writers() const;
  /// How many requests came to the handlers, those that did not decode included.
  [[nodiscard]] std::uint64_t requests() const { return counts_->taken; }
  /// Requests that came faster than they were answered, beyond 1000 that wait, and were dropped.
  [[nodiscard]] std::uint64_t dropped() const { return counts_->dropped; }

  /// Runs body; what it throws is told.
  template <typename Body>
  static void guarded(const std::function<void(const std::exception&)>& tell, Body&& body) {
    try {
      body();
    } catch (const std::exception& error) {
      tell(error);
    } catch (...) {
      tell(std::runtime_error("an exception of unknown type"));
    }
  }

 private:
  using Bytes = std::vector<std::uint8_t>;
  using RawReply = std::function<void(const Bytes&)>;
  using RawHandler = std::function<void(const Bytes&, RawReply)>;
  struct Entry {
    RawHandler handler;
    std::atomic<std::size_t> waiting{0};
    std::unique_ptr<bus::ServiceServer> server;
  };
  struct Counts {
    std::atomic<std::uint64_t> taken{0};
    std::atomic<std::uint64_t> dropped{0};
  };
  void serve_raw(const std::string& name, const std::string& type, const bus::QosProfile& qos,
                 RawHandler handler);
  void take(Entry& entry, const std::weak_ptr<Entry>& weak, const bus::ServiceRequest& request);

  std::shared_ptr<bus::Participant> participant_;
  std::shared_ptr<Mailbox> mailbox_;
  std::function<void(const std::exception&)> tell_;
  std::shared_ptr<Counts> counts_ = std::make_shared<Counts>();
  std::vector<std::shared_ptr<Entry>> entries_;  // tasks in the mailbox hold them weakly
};

}  // namespace strata::runtime
