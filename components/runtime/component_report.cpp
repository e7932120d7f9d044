// SPDX-License-Identifier: Apache-2.0
/// What a component says of itself: errors to its host, its status, and its endpoints to the graph.
#include <utility>

#include "components/log/damaged_file.hpp"
#include "components/runtime/component_subscription.hpp"
#include "components/runtime/free_memory.hpp"

namespace strata::runtime {

void Component::guarded(const std::function<void()>& body) {
  ServiceHub::guarded([this](const std::exception& error) { tell(error); }, body);
}

void Component::tell(const std::exception& error) {
  ++failed_;
  if (dynamic_cast<const convert::Undecodable*>(&error) != nullptr) ++undecodable_;
  (void)untold_.run([&] {
    last_error_ = one_line(error.what());
    auto told = told_errors_.take(last_error_, ToldErrors::Clock::now());
    // Who leads it through its life hears each time why that went wrong.
    if (is_changing_state_) told = last_error_;
    if (told) tell_line(*told);
  });
}

void Component::tell_line(const std::string& line) {
  (void)untold_.run([&] {
    if (context_.on_error) context_.on_error(full_name_ + ": " + line);
    say(LogLevel::kError, line);
  });
}

void Component::warn(const std::exception& error) {
  (void)untold_.run([&] {
    warnings_.push_back(one_line(error.what()));
    if (context_.on_error) context_.on_error(full_name_ + ": " + warnings_.back());
  });
}

bool Component::restored(const std::filesystem::path& file, const std::function<void()>& restore) {
  if (context_.dry_run) {  // leaves files as they are
    try {
      restore();
      return true;
    } catch (const DamageError&) {
      return false;
    } catch (const UnknownContentError&) {
      return false;
    }
  }
  const std::optional<DamageError> damage = log::restore_or_set_aside(file, restore);
  if (damage) warn(*damage);
  return !damage;
}

void Component::say(LogLevel level, const std::string& text) {
  if (rosout_) rosout_->log(level, text, now());
}

void Component::tell_what_repeats() {
  for (const std::string& line : told_errors_.due(ToldErrors::Clock::now())) {
    tell_line(line);
  }
}

void Component::announce() {
  if (!node_) return;
  std::vector<bus::Guid> readers;
  std::vector<bus::Guid> writers;
  // Each part by itself: it may be in the middle of being made or given up.
  for (const auto& subscription : subscriptions_) {
    if (subscription->reader) readers.push_back(subscription->reader->guid());
  }
  for (const auto& writer : writers_) writers.push_back(writer->guid());
  if (diagnostics_) writers.push_back(diagnostics_->writer().guid());
  if (rosout_) writers.push_back(rosout_->guid());
  if (const auto clock = clock_.reader_guid()) readers.push_back(*clock);
  for (const ServiceHub* hub : {services_.get(), own_services_.get()}) {
    if (hub == nullptr) continue;
    for (const bus::Guid& guid : hub->readers()) readers.push_back(guid);
    for (const bus::Guid& guid : hub->writers()) writers.push_back(guid);
  }
  if (bond_) {
    readers.push_back(bond_->reader_guid());
    writers.push_back(bond_->writer_guid());
  }
  if (transition_events_) writers.push_back(transition_events_->raw().guid());
  if (parameter_events_) writers.push_back(parameter_events_->raw().guid());
  node_->announce(std::move(readers), std::move(writers));
}

void Component::diagnose() {
  if (!diagnostics_) return;
  Health health;
  if (failed_ > told_failed_) health.fail(last_error_);
  if (dropped_ > told_dropped_) health.warn("messages come faster than they are worked on");
  for (const std::string& warning : warnings_) health.warn(warning);
  health.add("state", std::string(lifecycle_label(state_)));
  health.add("processed", processed_.load());
  health.add("skipped", failed_);
  health.add("dropped", dropped_.load());
  health.add("undecodable",
             undecodable_ + clock_.undecodable() + (bond_ ? bond_->undecodable() : 0));
  health.add("came while inactive", ignored_.load());
  std::uint64_t requests = 0;
  std::uint64_t dropped_requests = 0;
  for (const ServiceHub* hub : {services_.get(), own_services_.get()}) {
    if (hub == nullptr) continue;
    requests += hub->requests();
    dropped_requests += hub->dropped();
  }
  health.add("requests", requests);
  health.add("dropped requests", dropped_requests);
  health.add("caught", context_.participant->caught().count() + context_.mailbox->caught().count() +
                           untold_.count());
  health.add_later("process_memory_bytes", [] { return std::uint64_t{resident_bytes()}; });
  if (!last_error_.empty()) health.add("last_error", last_error_);
  if (is_active()) on_diagnose(health);
  if (!diagnostics_->wants(health)) return;
  health.complete();
  for (const auto& subscription : subscriptions_) subscription->tell(health);
  for (const auto& writer : writers_) health.add("published " + writer->topic(), writer->count());
  diagnostics_->publish(health, now());
  told_failed_ = failed_;
  told_dropped_ = dropped_;
  if (rosout_) rosout_->warn(health, last_error_, now());
}

}  // namespace strata::runtime
