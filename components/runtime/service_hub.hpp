// SPDX-License-Identifier: Apache-2.0
/// The services of one component: requests wait in its mailbox like everything else it does.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "components/bus/service.hpp"
#include "components/runtime/executor.hpp"

namespace strata::runtime {

class ServiceHub {
 public:
  ServiceHub(std::shared_ptr<bus::Participant> participant, std::shared_ptr<Mailbox> mailbox)
      : participant_(std::move(participant)), mailbox_(std::move(mailbox)) {}

  /// What a request is answered with: once, on whatever thread; nothing happens when the hub or
  /// the client is gone.
  template <typename S>
  using Reply = std::function<void(const typename bus::ServiceType<S>::Response&)>;
  template <typename S>
  using LateHandler = std::function<void(const typename bus::ServiceType<S>::Request&, Reply<S>)>;

  /// name: full. handler: called on the mailbox. Requests that do not decode get no answer.
  template <typename S>
  void serve(const std::string& name, const std::string& qos,
             std::function<typename bus::ServiceType<S>::Response(
                 const typename bus::ServiceType<S>::Request&)>
                 handler) {
    serve_later<S>(name, qos, [handler = std::move(handler)](const auto& request, auto reply) {
      reply(handler(request));
    });
  }
  /// As above; the handler may leave the answer to others.
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

 private:
  using Bytes = std::vector<std::uint8_t>;
  using RawReply = std::function<void(const Bytes&)>;
  using RawHandler = std::function<void(const Bytes&, RawReply)>;
  struct Entry {
    RawHandler handler;
    std::unique_ptr<bus::ServiceServer> server;
  };
  void serve_raw(const std::string& name, const std::string& type, const bus::QosProfile& qos,
                 RawHandler handler);

  std::shared_ptr<bus::Participant> participant_;
  std::shared_ptr<Mailbox> mailbox_;
  std::vector<std::shared_ptr<Entry>> entries_;  // tasks in the mailbox hold them weakly
};

}  // namespace strata::runtime
