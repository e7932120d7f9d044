// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <utility>

#include "components/runtime/component_subscription.hpp"

namespace strata::runtime {
namespace {

/// Sets a flag while it lives.
class Flag {
 public:
  explicit Flag(bool& flag) : flag_(flag), before_(std::exchange(flag, true)) {}
  ~Flag() { flag_ = before_; }
  Flag(const Flag&) = delete;
  Flag& operator=(const Flag&) = delete;

 private:
  bool& flag_;
  bool before_;
};

}  // namespace

Component::Component(ComponentContext context)
    : context_(std::move(context)),
      full_name_(bus::expand_name(context_.name, context_.node_namespace, context_.name)),
      clock_(context_.participant, lockstep()) {}

Component::~Component() = default;

void Component::request(std::uint8_t id) {
  context_.mailbox->call([this, id] {
    const LifecycleTransition* found = find_transition(state_, id);
    if (found == nullptr) return;
    try {
      perform(*found);
    } catch (const std::exception& error) {  // the host is told by it, others by this
      (void)untold_.run([&] { say(LogLevel::kError, one_line(error.what())); });
      throw;
    }
  });
}

void Component::join() {
  context_.mailbox->call([this] {
    if (node_) return;
    join_domain();
    guarded([&] { announce(); });
    guarded([&] { diagnose(); });
  });
}

void Component::configure() { request(1); }
void Component::activate() { request(3); }
void Component::deactivate() { request(4); }
void Component::cleanup() { request(2); }

void Component::shutdown() {
  context_.mailbox->call([this] {
    guarded([&] {
      if (const LifecycleTransition* found = find_transition(state_, 0, "shutdown")) {
        perform(*found);
      }
    });
    leave_domain();
  });
}

void Component::perform(const LifecycleTransition& transition) {
  const Flag changing(is_changing_state_);
  if (transition.id == 1 && !node_) join_domain();
  guarded([&] { tell_transition(first_step(transition)); });
  try {
    run_hooks_of(transition.id);
  } catch (...) {
    guarded([&] { tell_transition(second_step(transition, false)); });
    throw;
  }
  state_ = transition.goal;
  // From here on nothing takes it back: what cannot be said of it is told.
  guarded([&] {
    if (bond_ && !is_active()) bond_->end();
  });
  guarded([&] {
    say(LogLevel::kInfo,
        std::string(transition.label) + ": is " + lifecycle_label(state_) + " now");
  });
  if (is_active() && !lockstep()) {
    for (const auto& subscription : subscriptions_) {
      while (take_live(*subscription)) {
      }
    }
  }
  guarded([&] { announce(); });
  guarded([&] { diagnose(); });
  guarded([&] { tell_transition(second_step(transition, true)); });
}

void Component::run_hooks_of(std::uint8_t transition) {
  switch (transition) {
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
        guarded([&] { take_waiting(); });
        guarded([&] { on_deactivate(); });  // a full disk must not keep a robot from stopping
      }
      break;
    default:
      do_shutdown();
  }
}

void Component::do_configure() {
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
  try {
    take_use_sim_time();
    on_declare();
    if (parameter_model_.read) (void)parameter_model_.read(context_.parameters);
    node_ =
        std::make_unique<bus::Node>(context_.participant, context_.node_namespace, context_.name);
    diagnostics_ =
        std::make_unique<Diagnostics>(context_.participant, full_name_, resolve(kDiagnosticsTopic));
    if (!lockstep()) {
      rosout_ = std::make_unique<Rosout>(context_.participant, full_name_, resolve("/rosout"));
      serve();
    }
  } catch (...) {
    leave_domain();  // all or nothing
    throw;
  }
}

void Component::leave_domain() {
  {
    const std::lock_guard lock(bond_mutex_);
    bond_.reset();
  }
  services_.reset();
  trials_.reset();
  transition_events_.reset();
  parameter_events_.reset();
  clock_.use_sim_time(false);
  diagnostics_.reset();
  rosout_.reset();
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
  context_.use_sim_time = on;  // the next time, what follows has left nothing to read
  if (own.IsMap() && std::as_const(own)["use_sim_time"].IsDefined()) {
    // A copy: whoever made the composition may make another host of it.
    own.reset(YAML::Clone(own));
    own.remove("use_sim_time");
  }
  clock_.use_sim_time(on, resolve("/clock"));
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
  warnings_.clear();
  ack_writer_.reset();
}

void Component::tick() {
  // Beside the mailbox: who works on something long is not dead.
  (void)untold_.run([&] {
    const std::lock_guard lock(bond_mutex_);
    if (bond_ && is_active()) bond_->tick();
  });
  // A component that works on something long must not find a heap of ticks afterwards.
  if (tick_waits_.exchange(true)) return;
  const bool is_posted = untold_.run([&] {
    context_.mailbox->post([this] {
      tick_waits_ = false;
      guarded([&] { take_waiting(); });
      if (is_active()) guarded([&] { on_tick(); });
      // A recorder finds topics as it goes; once a second is soon enough to tell.
      guarded([&] {
        if (diagnostics_ && diagnostics_->is_due()) announce();
      });
      guarded([&] { diagnose(); });
      guarded([&] { tell_what_repeats(); });
    });
  });
  if (!is_posted) tick_waits_ = false;
}

std::unique_ptr<ServiceHub> Component::make_service_hub() {
  return std::make_unique<ServiceHub>(context_.participant, context_.mailbox,
                                      [this](const std::exception& error) { tell(error); });
}

std::string Component::resolve(const std::string& topic) const {
  return bus::resolve_name(topic, context_.node_namespace, context_.name, context_.remappings);
}

std::string Component::parameters_place() const {
  return context_.place + " (parameters of " + context_.name + ")";
}

void Component::adopt_common_parameters() {
  YAML::Node& given = context_.parameters;
  if (!context_.common_parameters.IsMap()) return;
  // Not YAML::Clone, which forgets the lines; a copy, since another host may be made of the same.
  YAML::Node own(YAML::NodeType::Map);
  for (const auto& item : given) own.force_insert(item.first, item.second);
  for (const auto& item : std::as_const(context_.common_parameters)) {
    const std::string& key = item.first.Scalar();
    const settings::KeyTree& keys = parameter_model_.keys;
    if (!settings::is_key(key, keys)) continue;
    const bool is_given = std::any_of(given.begin(), given.end(), [&](const auto& other) {
      return other.first.IsScalar() &&
             settings::present_key(other.first.Scalar(), keys) == settings::present_key(key, keys);
    });
    if (!is_given) own.force_insert(item.first, item.second);
  }
  given.reset(own);
}

void Component::take_present_keys() {
  settings::Notes notes;
  const YAML::Node present = settings::with_present_keys(context_.parameters, parameters_place(),
                                                         parameter_model_.keys, notes);
  if (notes.empty()) return;
  context_.parameters.reset(present);
  for (const std::string& note : notes) {
    warnings_.push_back(one_line(note));
    if (context_.on_error) context_.on_error(full_name_ + ": " + warnings_.back());
  }
}

}  // namespace strata::runtime
