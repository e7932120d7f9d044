// SPDX-License-Identifier: Apache-2.0
#include "components/fleet_member/exchange.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>
#include <vector>

#include "components/fleet/schema.hpp"
#include "components/site/site.hpp"
#include "core/base/error.hpp"

namespace strata::fleet_member {
namespace {

/// Beyond what the server itself counts against a statement.
constexpr double kSilence_s = 30.0;
constexpr int kConnect_s = 10;

std::vector<std::filesystem::path> paths(const std::vector<std::string>& names) {
  return {names.begin(), names.end()};
}

std::int64_t unix_now_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

/// What it could not do; all else is trouble of this machine's, or of what was fetched.
bool is_servers(const std::exception& error) {
  return dynamic_cast<const fleet::ServerError*>(&error) != nullptr ||
         dynamic_cast<const fleet::LostError*>(&error) != nullptr ||
         dynamic_cast<const fleet::DeniedError*>(&error) != nullptr;
}

/// The same for one robot, another one for others: their roles are in their URLs.
double spread_of(const std::string& url) {
  return static_cast<double>(std::hash<std::string>()(url) % 1000U) / 999.0;
}

}  // namespace

std::chrono::duration<double> wait_after(std::uint64_t failures, const RetryConfig& retry,
                                         double spread) {
  const auto doublings = static_cast<double>(std::min<std::uint64_t>(failures, 60) - 1);
  const double wait_s = std::min(retry.longest_s, retry.first_s * std::exp2(doublings));
  return std::chrono::duration<double>(wait_s * (0.5 + 0.5 * spread));
}

/// Where stop() and look_after() find the connection as long as it is there.
class Exchange::Held {
 public:
  Held(Exchange& exchange, const fleet::Connection& connection) : exchange_(exchange) {
    const std::lock_guard lock(exchange_.mutex_);
    exchange_.connection_ = &connection;
  }
  ~Held() {
    const std::lock_guard lock(exchange_.mutex_);
    exchange_.connection_ = nullptr;
  }
  Held(const Held&) = delete;
  Held& operator=(const Held&) = delete;

 private:
  Exchange& exchange_;
};

Exchange::Exchange(FleetMemberConfig config, std::string who, std::unique_ptr<Exchange> before)
    : config_(std::move(config)),
      who_(std::move(who)),
      before_(std::move(before)),
      visits_(paths(config_.maps), config_.site_folder),
      thread_([this] { run(); }) {}

Exchange::~Exchange() {
  stop();
  thread_.join();
}

void Exchange::stop() {
  const std::lock_guard lock(mutex_);
  stops_ = true;
  if (connection_ != nullptr) connection_->cut();
  changed_.notify_all();
}

bool Exchange::stops() const {
  const std::lock_guard lock(mutex_);
  return stops_;
}

void Exchange::look_after() const {
  const std::lock_guard lock(mutex_);
  if (connection_ != nullptr && connection_->waited_s() > config_.timeout_s + kSilence_s) {
    connection_->cut();
  }
}

ExchangeState Exchange::state() const {
  const std::lock_guard lock(mutex_);
  return state_;
}

site::Actor Exchange::actor() const { return {who_, unix_now_ns()}; }

void Exchange::run() {
  before_.reset();
  for (;;) {
    trouble_.clear();
    server_failed_ = false;
    if (stops()) return;
    exchange();
    std::unique_lock lock(mutex_);
    if (stops_) return;
    state_.trouble = trouble_;
    state_.failures = server_failed_ ? state_.failures + 1 : 0;
    const auto wait = server_failed_
                          ? wait_after(state_.failures, config_.retry, spread_of(config_.server))
                          : std::chrono::duration<double>(config_.period_s);
    changed_.wait_for(lock, wait, [this] { return stops_; });
  }
}

void Exchange::note(const std::exception& error, bool is_server) {
  if (stops()) return;  // it was cut off by us
  if (is_server) server_failed_ = true;
  tell(error.what());
  const std::lock_guard lock(mutex_);
  state_.last_error = error.what();
}

void Exchange::tell(const std::string& trouble) {
  if (trouble_.find(trouble) != std::string::npos) return;
  trouble_ += (trouble_.empty() ? "" : "; ") + trouble;
}

void Exchange::guarded(const std::function<void()>& part) {
  if (server_failed_ || stops()) return;
  try {
    part();
  } catch (const std::exception& error) {
    note(error, is_servers(error));
  }
}

void Exchange::exchange() {
  guarded([this] {
    visits_.look();
    const std::lock_guard lock(mutex_);
    state_.waiting = visits_.waiting();
  });
  guarded([this] {
    fleet::Connection connection(
        config_.server,
        {.connect_s = kConnect_s, .statement_s = static_cast<int>(std::ceil(config_.timeout_s))});
    const Held held(*this, connection);
    guarded([&] { fleet::require_schema(connection); });
    guarded([&] {
      const fleet::ClockOffset clock = fleet::clock_offset(connection);
      const std::lock_guard lock(mutex_);
      state_.clock = clock;
    });
    guarded([&] { push(connection); });
    if (!config_.site_folder.empty()) guarded([&] { pull(connection); });
  });
  if (server_failed_) visits_.forget_pushed();
}

void Exchange::push(fleet::Connection& connection) {
  bool is_all = true;
  for (const std::string& maps : config_.maps) {
    if (!visits_.is_to_push(maps)) continue;
    bool is_pushed = false;
    guarded([&] {
      push(connection, maps);
      is_pushed = true;
    });
    is_all = is_all && is_pushed;
  }
  const std::lock_guard lock(mutex_);
  if (is_all && !config_.maps.empty()) state_.pushed = ExchangeState::Clock::now();
}

void Exchange::push(fleet::Connection& connection, const std::string& maps) {
  std::optional<fleet::VisitName> clash;
  const auto told = [&](const fleet::PushedVisit& visit) {
    if (visit.outcome == fleet::PushOutcome::kClash) clash = visit.name;
    take(visit);
    if (stops()) throw Cancelled(maps);
  };
  const std::optional<fleet::Coding> coding = this->coding();
  fleet::push(connection, config_.site, maps, told, {.spacing_m = config_.spacing_m},
              coding ? &*coding : nullptr);
  if (clash) throw fleet::clash_error(connection, *clash);
  visits_.is_pushed(maps);
}

/// Visits do not wait for a folder to be mended.
std::optional<fleet::Coding> Exchange::coding() {
  if (config_.site_folder.empty() || config_.tolerance_cells <= 0.0) return std::nullopt;
  try {
    return fleet::active_coding(site::Site(config_.site_folder), config_.tolerance_cells);
  } catch (const std::exception& error) {
    note(error, false);
    return std::nullopt;
  }
}

void Exchange::take(const fleet::PushedVisit& visit) {
  if (visit.outcome == fleet::PushOutcome::kClash) {
    refused_.insert(visit.name.sha256);
  } else {
    visits_.is_there(visit.whole);
  }
  const std::lock_guard lock(mutex_);
  state_.waiting = visits_.waiting();
  state_.refused = refused_.size();
  if (visit.outcome == fleet::PushOutcome::kSent) ++state_.sent;
}

/// A release is dealt with once: who goes back to another version on the robot is not overruled a
/// minute later.
void Exchange::pull(fleet::Connection& connection) {
  site::Site site(config_.site_folder);
  site.wait_with([this](const std::string&) { return !stops(); });
  if (site.decisions().id != config_.site) {
    throw InputError(config_.site_folder,
                     "is site " + site.decisions().id + ", not " + config_.site,
                     "name another folder or site: two sites do not mix");
  }
  fleet::require_same_site(connection, site);  // what is wrong there is mended here, and at once
  const auto newest = fleet::newest_released(connection, config_.site);
  const std::string release = newest ? newest->hash + " " + newest->at : "";
  if (release == unusable_.release && ExchangeState::Clock::now() < unusable_.retry_at) {
    tell(unusable_.trouble);
  } else if (release != taken_) {
    use(connection, site, release);
  }
  const std::lock_guard lock(mutex_);
  state_.pulled = ExchangeState::Clock::now();
}

void Exchange::use(fleet::Connection& connection, site::Site& site, const std::string& release) {
  try {
    const auto pulled = fleet::pull(connection, site,
                                    {.approve = config_.pulled != Pulled::kCandidate,
                                     .activate = config_.pulled == Pulled::kActive},
                                    actor());
    taken_ = pulled ? pulled->version.hash + " " + pulled->version.at : "";
    unusable_ = {};
    const std::lock_guard lock(mutex_);
    state_.version = pulled ? pulled->version.hash : "";
  } catch (const std::exception& error) {
    if (!is_servers(error)) remember_unusable(release, error.what());
    throw;
  }
  if (config_.pulled != Pulled::kActive) return;
  (void)fleet::collect(site, static_cast<std::size_t>(config_.keep_retired), actor());
}

/// To fetch all of it again each time that one looks helps nobody.
void Exchange::remember_unusable(const std::string& release, const std::string& trouble) {
  if (unusable_.release != release) unusable_ = {.release = release};
  unusable_.trouble = trouble;
  const auto wait = wait_after(++unusable_.failures, config_.unusable, spread_of(config_.server));
  unusable_.retry_at = ExchangeState::Clock::now() +
                       std::chrono::duration_cast<ExchangeState::Clock::duration>(wait);
}

}  // namespace strata::fleet_member
