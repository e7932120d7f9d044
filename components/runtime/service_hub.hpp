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

  /// name: full. handler: called on the mailbox. Requests that do not decode get no answer.
  template <typename S>
  void serve(const std::string& name, const std::string& qos,
             std::function<typename bus::ServiceType<S>::Response(
                 const typename bus::ServiceType<S>::Request&)>
                 handler) {
    using Request = typename bus::ServiceType<S>::Request;
    serve_raw(name, bus::ServiceType<S>::name, bus::qos_profile(qos),
              [name, handler = std::move(handler)](const std::vector<std::uint8_t>& cdr) {
                return convert::to_cdr(handler(convert::from_cdr<Request>(cdr, name)));
              });
  }

  [[nodiscard]] std::vector<bus::Guid> readers() const;
  [[nodiscard]] std::vector<bus::Guid> writers() const;

 private:
  using RawHandler = std::function<std::vector<std::uint8_t>(const std::vector<std::uint8_t>&)>;
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
