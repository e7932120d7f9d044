// SPDX-License-Identifier: Apache-2.0
#include "components/runtime/component.hpp"

#include <algorithm>
#include <utility>

namespace strata::runtime {
Component::Component(ComponentContext context)
    : context_(std::move(context)),
      full_name_(bus::expand_name(context_.name, context_.node_namespace, context_.name)),
      clock_(context_.participant, lockstep()) {}

Component::~Component() = default;

void Component::request(std::uint8_t id) {
  context_.mailbox->call([this, id] {
    if (const LifecycleTransition* found = find_transition(state_, id)) perform(*found);
  });
}

void Component::join() {
  context_.mailbox->call([this] {
    if (node_) return;
    join_domain();
    announce();
    diagnose();
  });
}

void Component::configure() { request(1); }
void Component::activate() { request(3); }
void Component::deactivate() { request(4); }
void Component::cleanup() { request(2); }

void Component::shutdown() {
  context_.mailbox->call([this] {
    if (const LifecycleTransition* found = find_transition(state_, 0, "shutdown")) perform(*found);
    leave_domain();
  });
}

void Component::perform(const LifecycleTransition& transition) {
  switch (transition.id) {
    case 1:
      do_configure();
      break;
    case 2:
      release();
      break;
    case 3:
      on_activate();
      break;
    case 4:
      if (lockstep()) {
        on_deactivate();
      } else {
        guarded([&] { on_deactivate(); });  // a full disk must not keep a robot from stopping
      }
      break;
    default:
      do_shutdown();
  }
  state_ = transition.goal;
  if (bond_ && !is_active()) bond_->end();
  if (is_active() && !lockstep()) {
    for (const auto& subscription : subscriptions_) {
      while (take_live(*subscription)) {
      }
    }
  }
  announce();
  diagnose();
  tell_transition(transition);
}

void Component::do_configure() {
  if (!node_) join_domain();
  try {
    on_configure();
    if (lockstep()) join_lockstep();
  } catch (...) {
    release();
    throw;
  }
}

/// Through the states between, whatever they throw.
void Component::do_shutdown() {
  guarded([&] {
    if (is_active()) on_deactivate();
  });
  if (state_ != LifecycleState::kUnconfigured) release();
}

void Component::join_domain() {
  take_use_sim_time();
  on_declare();
  if (parameter_model_.read) (void)parameter_model_.read(context_.parameters);
  node_ = std::make_unique<bus::Node>(context_.participant, context_.node_namespace, context_.name);
  diagnostics_ = std::make_unique<Diagnostics>(context_.participant, full_name_);
  if (!lockstep()) serve();
}

void Component::leave_domain() {
  {
    const std::lock_guard lock(bond_mutex_);
    bond_.reset();
  }
  services_.reset();
  transition_events_.reset();
  parameter_events_.reset();
  clock_.use_sim_time(false);
  diagnostics_.reset();
  node_.reset();
}

/// Every component has this parameter and none has it in its config.
void Component::take_use_sim_time() {
  bool on = context_.use_sim_time;
  YAML::Node& own = context_.parameters;
  for (const YAML::Node& given : {context_.common_parameters, own}) {
    if (!given.IsMap() || !given["use_sim_time"].IsDefined()) continue;
    settings::detail::read_value(given["use_sim_time"], parameters_place(), "use_sim_time", on);
  }
  if (own.IsMap() && std::as_const(own)["use_sim_time"].IsDefined()) {
    // A copy: whoever made the composition may make another host of it.
    own.reset(YAML::Clone(own));
    own.remove("use_sim_time");
  }
  clock_.use_sim_time(on);
}

void Component::release() {
  own_services_.reset();
  step_reader_.reset();
  step_.reset();
  for (const auto& subscription : subscriptions_) subscription->reader.reset();
  guarded([&] { on_cleanup(); });
  subscriptions_.clear();
  writers_.clear();
  topics_.clear();
  ack_writer_.reset();
}

void Component::tick() {
  // Beside the mailbox: who works on something long is not dead.
  if (is_active()) {
    const std::lock_guard lock(bond_mutex_);
    if (bond_) bond_->tick();
  }
  // A component that works on something long must not find a heap of ticks afterwards.
  if (tick_waits_.exchange(true)) return;
  context_.mailbox->post([this] {
    tick_waits_ = false;
    if (is_active()) guarded([&] { on_tick(); });
    announce();  // a recorder finds topics as it goes
    diagnose();
  });
}

void Component::guarded(const std::function<void()>& body) {
  try {
    body();
  } catch (const std::exception& error) {
    tell(error);
  }
}

void Component::tell(const std::exception& error) {
  ++failed_;
  last_error_ = error.what();
  if (context_.on_error) context_.on_error(full_name_ + ": " + error.what());
}

void Component::announce() {
  if (!node_) return;
  std::vector<bus::Guid> readers;
  std::vector<bus::Guid> writers;
  for (const auto& subscription : subscriptions_) readers.push_back(subscription->reader->guid());
  for (const auto& writer : writers_) writers.push_back(writer->guid());
  if (diagnostics_) writers.push_back(diagnostics_->writer().guid());
  for (const ServiceHub* hub : {services_.get(), own_services_.get()}) {
    if (hub == nullptr) continue;
    for (const bus::Guid& guid : hub->readers()) readers.push_back(guid);
    for (const bus::Guid& guid : hub->writers()) writers.push_back(guid);
  }
  if (services_) {
    readers.push_back(bond_->reader_guid());
    writers.push_back(bond_->writer_guid());
    writers.push_back(transition_events_->raw().guid());
    writers.push_back(parameter_events_->raw().guid());
  }
  node_->announce(std::move(readers), std::move(writers));
}

void Component::diagnose() {
  if (!diagnostics_) return;
  Health health;
  if (failed_ > told_failed_) health.fail(last_error_);
  if (dropped_ > told_dropped_) health.warn("messages come faster than they are worked on");
  health.add("state", std::string(lifecycle_label(state_)));
  health.add("processed", processed_);
  health.add("skipped", failed_);
  health.add("dropped", dropped_.load());
  if (!last_error_.empty()) health.add("last_error", last_error_);
  for (const auto& subscription : subscriptions_) {
    const std::lock_guard lock(subscription->mutex);
    health.add("received " + subscription->topic, subscription->received);
  }
  for (const auto& writer : writers_) health.add("published " + writer->topic(), writer->count());
  if (is_active()) on_diagnose(health);
  const bool is_told = diagnostics_->publish(health, now());
  if (!is_told) return;
  told_failed_ = failed_;
  told_dropped_ = dropped_;
}

std::string Component::resolve(const std::string& topic) const {
  return bus::resolve_name(topic, context_.node_namespace, context_.name, context_.remappings);
}

std::string Component::parameters_place() const {
  return context_.place + " (parameters of " + context_.name + ")";
}

void Component::adopt_common_parameters(const std::vector<std::string>& keys) {
  YAML::Node& given = context_.parameters;
  if (!context_.common_parameters.IsMap()) return;
  // Not YAML::Clone, which forgets the lines; a copy, since another host may be made of the same.
  YAML::Node own(YAML::NodeType::Map);
  for (const auto& item : given) own.force_insert(item.first, item.second);
  for (const auto& item : std::as_const(context_.common_parameters)) {
    const std::string& key = item.first.Scalar();
    const bool is_known = std::find(keys.begin(), keys.end(), key) != keys.end();
    if (is_known && !std::as_const(own)[key].IsDefined()) own.force_insert(item.first, item.second);
  }
  given.reset(own);
}

void Component::subscribe_raw(const std::string& full_topic, const std::string& type,
                              const bus::QosProfile& qos,
                              std::function<void(const bus::RawMessage&)> callback) {
  const auto subscription = std::make_shared<Subscription>();
  subscription->topic = full_topic;
  topics_.push_back({full_topic, type, qos, false});
  subscription->callback = std::move(callback);
  const bus::QosProfile used = lockstep() ? qos.lossless() : qos;
  subscription->depth = static_cast<std::size_t>(used.depth);
  subscription->latched = used.transient_local;
  // The reader is the subscription's, so its callback holds it weakly.
  const std::weak_ptr<Subscription> weak = subscription;
  const auto on_message = [this, weak](bus::RawMessage message) {
    const auto held = weak.lock();
    if (!held) return;
    {
      const std::lock_guard lock(held->mutex);
      ++held->received;
      held->waiting.push_back(std::move(message));
      if (held->depth > 0 && held->waiting.size() > held->depth) {
        held->waiting.pop_front();
        ++dropped_;
        return;  // the task of the dropped one takes this one
      }
    }
    if (lockstep()) {
      context_.mailbox->post([this] { try_step(); });
    } else {
      context_.mailbox->post([this, held] { take_live(*held); });
    }
  };
  const auto on_match = [this] { context_.mailbox->post([this] { try_step(); }); };
  subscriptions_.push_back(subscription);
  subscription->reader = std::make_unique<bus::RawReader>(context_.participant, full_topic, type,
                                                          used, on_message, on_match);
}

std::shared_ptr<bus::RawWriter> Component::advertise_raw(const std::string& full_topic,
                                                         const std::string& type,
                                                         const bus::QosProfile& qos) {
  topics_.push_back({full_topic, type, qos, true});
  const auto on_match = [this] { context_.mailbox->post([this] { try_step(); }); };
  auto writer = std::make_shared<bus::RawWriter>(context_.participant, full_topic, type,
                                                 lockstep() ? qos.lossless() : qos, on_match);
  writers_.push_back(writer);
  return writer;
}

bool Component::take_live(Subscription& subscription) {
  // Who publishes a latched message does it once: it must not be lost before we are active.
  if (!is_active() && subscription.latched) return false;
  bus::RawMessage message;
  {
    const std::lock_guard lock(subscription.mutex);
    if (subscription.waiting.empty()) return false;
    message = std::move(subscription.waiting.front());
    subscription.waiting.pop_front();
  }
  if (!is_active()) return true;
  const std::uint64_t failed_before = failed_;
  guarded([&] { subscription.callback(message); });
  if (failed_ == failed_before) ++processed_;
  return true;
}

}  // namespace strata::runtime
