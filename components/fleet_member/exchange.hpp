// SPDX-License-Identifier: Apache-2.0
/// Pushes and pulls again and again on a thread of its own: nobody else waits for a network.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>

#include "components/fleet/clock.hpp"
#include "components/fleet/pull.hpp"
#include "components/fleet/push.hpp"
#include "components/fleet_member/config.hpp"
#include "components/fleet_member/local_visits.hpp"

namespace strata::fleet_member {

/// What an exchange has come to.
struct ExchangeState {
  using Clock = std::chrono::steady_clock;
  std::optional<Clock::time_point> pushed;  ///< when the server last had all, as far as known
  std::optional<Clock::time_point> pulled;  ///< when it was last asked for versions
  std::size_t waiting = 0;                  ///< visits that nobody knows to be there
  std::uint64_t sent = 0;                   ///< visits, since the beginning
  std::size_t refused = 0;                  ///< visits whose number another one has
  std::optional<fleet::ClockOffset> clock;  ///< of the last try that had an answer
  std::string version;                      ///< hash of the one pulled last; empty: none
  std::string trouble;         ///< of the last try, with its remedy; empty: it went well
  std::string last_error;      ///< of any try; empty: there was none
  std::uint64_t failures = 0;  ///< tries in a row that the server let down
};

/// How long to wait after so many failures in a row, 1 or more. `spread`, 0 to 1, is the robot's:
/// those that lost one server come back one by one.
[[nodiscard]] std::chrono::duration<double> wait_after(std::uint64_t failures,
                                                       const RetryConfig& retry, double spread);

class Exchange {
 public:
  /// who: for the site's diary. before: an exchange that was told to stop; this one begins when it
  /// is over.
  Exchange(FleetMemberConfig config, std::string who, std::unique_ptr<Exchange> before);
  /// Stops, and waits until it is over: at most as long as a connection may take.
  ~Exchange();
  Exchange(const Exchange&) = delete;
  Exchange& operator=(const Exchange&) = delete;

  [[nodiscard]] ExchangeState state() const;
  /// Cuts a connection whose server has been silent for longer than a statement may take.
  void look_after() const;
  /// Nothing more is done; returns at once. What is under way is cut off, and lost by nobody.
  void stop();

 private:
  class Held;  // the connection, where stop() finds it
  /// A release that came and that this robot could not use.
  struct Unusable {
    std::string release;
    std::uint64_t failures = 0;
    std::string trouble = {};
    ExchangeState::Clock::time_point retry_at = {};
  };
  void run();
  /// What went wrong; `is_server` where waiting for the server helps.
  void note(const std::exception& error, bool is_server);
  void tell(const std::string& trouble);
  void guarded(const std::function<void()>& part);
  void exchange();
  void push(fleet::Connection& connection);
  void push(fleet::Connection& connection, const std::string& maps);
  void pull(fleet::Connection& connection);
  void use(fleet::Connection& connection, site::Site& site, const std::string& release);
  void remember_unusable(const std::string& release, const std::string& trouble);
  /// What visits are told relative to; nothing: they go by themselves.
  [[nodiscard]] std::optional<fleet::Coding> coding();
  void take(const fleet::PushedVisit& visit);
  [[nodiscard]] bool stops() const;
  [[nodiscard]] site::Actor actor() const;

  const FleetMemberConfig config_;
  const std::string who_;
  std::unique_ptr<Exchange> before_;
  // The thread's.
  LocalVisits visits_;
  std::string taken_;  ///< the release that was dealt with
  Unusable unusable_;  ///< ... that was not
  std::string trouble_;
  bool server_failed_ = false;
  std::set<std::string> refused_;
  // Under mutex_.
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  ExchangeState state_;
  const fleet::Connection* connection_ = nullptr;
  bool stops_ = false;
  std::thread thread_;  // last: it uses the others
};

}  // namespace strata::fleet_member
