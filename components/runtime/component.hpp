// SPDX-License-Identifier: Apache-2.0
/// What every component is: a named thing with a lifecycle, topics and parameters.
///
/// A component works on its own mailbox, one callback at a time. Live, a callback runs when its
/// message comes. In lockstep, messages wait until the coordinator asks for a step and all of the
/// announced ones are there; then callbacks run topic by topic in the order of `subscribe`, so that
/// the same log gives the same calls whatever the threads, processes and network do.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "components/bus/endpoint.hpp"
#include "components/bus/node.hpp"
#include "components/runtime/bond.hpp"
#include "components/runtime/clock.hpp"
#include "components/runtime/component_context.hpp"
#include "components/runtime/diagnostics.hpp"
#include "components/runtime/lifecycle.hpp"
#include "components/runtime/parameters.hpp"
#include "components/runtime/reception.hpp"
#include "components/runtime/rosout.hpp"
#include "components/runtime/service_hub.hpp"
#include "components/runtime/told_errors.hpp"
#include "components/settings/config_reader.hpp"

namespace strata::runtime {

class Component {
 public:
  explicit Component(ComponentContext context);
  virtual ~Component();
  Component(const Component&) = delete;
  Component& operator=(const Component&) = delete;

  /// Called by the host from outside the mailbox; each waits until it is done and passes errors on,
  /// or does nothing in another state than it starts from. When one throws, the component is as it
  /// was before, and may be asked again. configure() joins first, unless the component has.
  void configure();
  void activate();
  void deactivate();
  void cleanup();
  /// Onto the domain, unconfigured: others may lead it through its life and set its parameters.
  /// Throws ConfigError when the parameters are not valid.
  void join();
  /// From any state to the last one, and off the domain: no service answers any more. What goes
  /// wrong on that way is told and does not stop it.
  void shutdown();
  /// Several times a second while the process lives; returns at once.
  void tick();

  /// "/robot1/localizer".
  [[nodiscard]] const std::string& full_name() const { return full_name_; }
  [[nodiscard]] LifecycleState state() const { return state_; }
  /// What it reads and writes; once configured.
  [[nodiscard]] const std::vector<TopicUse>& topics() const { return topics_; }
  /// What became of the messages that came, of all topics since the beginning; thread safe.
  [[nodiscard]] MessageCounts counts() const;

 protected:
  /// declare_parameters with the config struct, so that others see them before the first configure.
  virtual void on_declare() {}
  /// Read parameters, subscribe, advertise; again after a cleanup. Throws ConfigError, InputError.
  virtual void on_configure() = 0;
  virtual void on_activate() {}
  /// Live: what it throws is told, and the component is inactive all the same.
  virtual void on_deactivate() {}
  /// Give up what on_configure made; called also when that failed halfway.
  virtual void on_cleanup() {}
  /// Several times a second while active and live.
  virtual void on_tick() {}
  /// Adds what only this component knows to its status on /diagnostics.
  virtual void on_diagnose(Health& /*health*/) const {}
  /// The log has ended: do what needs all data and save this component's part into out_dir.
  virtual void on_finish(const std::filesystem::path& /*out_dir*/) {}
  /// True: the first finish is the last, and what comes after it is dropped. Where one replay
  /// learns from the beginning of a log and localizes on the rest, learners finish in between;
  /// others are asked again at the end.
  [[nodiscard]] virtual bool learns() const { return false; }

  template <typename T>
  void subscribe(const std::string& topic, const std::string& qos,
                 std::function<void(const T&)> callback, const Reception& reception = {}) {
    const std::string full = resolve(topic);
    const auto decode = [full, callback = std::move(callback)](const bus::RawMessage& message) {
      callback(convert::from_cdr<T>(message.cdr, full));
    };
    subscribe_raw(full, bus::MessageType<T>::name, bus::qos_profile(qos), decode, reception);
  }
  /// topic: resolved. Callbacks of a topic see its messages in the order they were written. All or
  /// nothing: when it throws, nothing is subscribed.
  void subscribe_raw(const std::string& full_topic, const std::string& type,
                     const bus::QosProfile& qos,
                     std::function<void(const bus::RawMessage&)> callback,
                     Reception reception = {});
  void unsubscribe(const std::string& full_topic);  ///< what waits of it is dropped; on the mailbox
  void take_waiting();                              ///< of topics that are taken at ticks: now

  /// What is returned publishes until cleanup, and does nothing afterwards. All or nothing.
  template <typename T>
  [[nodiscard]] std::function<void(const T&)> advertise(const std::string& topic,
                                                        const std::string& qos) {
    const std::weak_ptr<bus::RawWriter> weak =
        advertise_raw(resolve(topic), bus::MessageType<T>::name, bus::qos_profile(qos));
    return [weak](const T& message) {
      if (const auto writer = weak.lock()) writer->publish(convert::to_cdr(message));
    };
  }
  [[nodiscard]] std::shared_ptr<bus::RawWriter> advertise_raw(const std::string& full_topic,
                                                              const std::string& type,
                                                              const bus::QosProfile& qos);

  /// Answers a service until cleanup, live only, on the component's own thread. name: as a topic's;
  /// "~/NAME" is private. An error of the handler is counted and told; the client gets the empty
  /// response, so what can fail says so in its response.
  template <typename S>
  void offer(const std::string& name, std::function<typename bus::ServiceType<S>::Response(
                                          const typename bus::ServiceType<S>::Request&)>
                                          handler) {
    offer_later<S>(name, [this, handler = std::move(handler)](const auto& request, auto reply) {
      typename bus::ServiceType<S>::Response response;
      guarded([&] { response = handler(request); });
      reply(response);
    });
  }
  /// As above for what takes long: the handler returns at once and sees to it that somebody calls
  /// its second argument with the response, once, on whatever thread; that never throws. An error
  /// of the handler is counted and told, and the client gets no answer.
  template <typename S>
  void offer_later(const std::string& name, ServiceHub::LateHandler<S> handler) {
    if (lockstep()) return;
    if (!own_services_) own_services_ = make_service_hub();
    own_services_->serve_later<S>(
        resolve(name), "default",
        [this, handler = std::move(handler)](const auto& request, auto reply) {
          guarded([&] { handler(request, std::move(reply)); });
        });
  }

  /// The parameters are this struct's: that is what others may ask for and set over DDS.
  template <typename Config>
  void declare_parameters() {
    parameter_model_ = {};
    parameter_model_.keys = settings::key_tree<Config>();
    adopt_common_parameters();
    take_present_keys();
    parameter_model_.read = [place = parameters_place()](const YAML::Node& node) {
      return parameter_table(settings::read_config<Config>(node, place));
    };
  }
  /// Declares them and reads them.
  template <typename Config>
  [[nodiscard]] Config read_parameters() {
    declare_parameters<Config>();
    return settings::read_config<Config>(context_.parameters, parameters_place());
  }
  /// These of the parameters may be changed while the component is active: then `config` is read
  /// again, on the component's own thread. The others wait for the next configure.
  template <typename Config>
  void keep_live(Config& config, std::vector<std::string> names) {
    keep_live<Config>(std::move(names), [&config](const Config& changed) { config = changed; });
  }
  /// As above, where something is to be done about it: `apply` is given all of the parameters.
  template <typename Config>
  void keep_live(std::vector<std::string> names, std::function<void(const Config&)> apply) {
    parameter_model_.live_names = std::move(names);
    parameter_model_.apply_live = [apply = std::move(apply),
                                   place = parameters_place()](const YAML::Node& node) {
      apply(settings::read_config<Config>(node, place));
    };
  }
  /// Changes parameters as who calls the service set_parameters does: checked, applied and told to
  /// others in the same way. Live, on the component's own thread.
  [[nodiscard]] ParameterChange set_parameters(
      const std::vector<rcl_interfaces::msg::Parameter>& changes);
  /// What went wrong while the component goes on: counted, on /diagnostics and, as the host is told
  /// it, on /rosout, in words at its first time and then by numbers (ToldErrors). Never throws. On
  /// the mailbox.
  void tell(const std::exception& error);
  /// To the host and onto /rosout, each time. Never throws. On the mailbox.
  void tell_line(const std::string& line);
  /// Onto /rosout; in lockstep nothing. Throws OutputError.
  void say(LogLevel level, const std::string& text);
  /// Runs `body`; what it throws, of whatever type, is told.
  void guarded(const std::function<void()>& body);
  /// What the user should know of until the next cleanup: a warning on /diagnostics as long as the
  /// component is configured, which the host is told, too. On the mailbox.
  void warn(const std::exception& error);
  /// Runs `restore`, which reads what the component kept in that file. When that is damaged, it is
  /// set aside (log::restore_or_set_aside), that is warned of, and the answer is false: what
  /// `restore` has filled by then is of no use. Throws what else `restore` throws, and OutputError.
  [[nodiscard]] bool restored(const std::filesystem::path& file,
                              const std::function<void()>& restore);
  /// For stamps of what has no scan; 0 in lockstep.
  [[nodiscard]] Stamp now() const { return clock_.now(); }
  [[nodiscard]] std::string resolve(const std::string& topic) const;
  [[nodiscard]] const ComponentContext& context() const { return context_; }
  [[nodiscard]] bool lockstep() const { return context_.mode == FeedMode::kLockstep; }

 private:
  struct Subscription;  // component_subscription.hpp
  [[nodiscard]] bool is_active() const { return state_ == LifecycleState::kActive; }
  /// On the mailbox. Throws what the hook throws, and then the state is as before.
  void perform(const LifecycleTransition& transition);
  /// From outside the mailbox: the transition `id`, when the state is the one it starts from.
  void request(std::uint8_t id);
  void run_hooks_of(std::uint8_t transition);
  void do_configure();
  void do_shutdown();
  void release();
  [[nodiscard]] std::string parameters_place() const;
  /// Those of the common parameters that it knows become this component's, below its own.
  void adopt_common_parameters();
  /// The parameters under the names they have now; warns of old ones.
  void take_present_keys();
  /// Works on the message that waits longest; false when none does.
  bool take_live(Subscription& subscription);
  /// Puts a message where it waits; whether it needs a task of its own, no other's will take it.
  [[nodiscard]] bool keep(Subscription& subscription, bus::RawMessage message);
  void diagnose();
  void tell_what_repeats();
  [[nodiscard]] std::unique_ptr<ServiceHub> make_service_hub();
  /// Tells ROS 2's graph which endpoints are ours now.
  void announce();
  void join_domain();
  void take_use_sim_time();
  void leave_domain();

  // What others may ask for (component_services.cpp).
  void serve();
  void serve_lifecycle();
  void serve_parameters();
  void serve_changes();
  [[nodiscard]] bool try_transition(std::uint8_t id, const std::string& label);
  void tell_transition(const LifecycleTransition& transition);
  [[nodiscard]] ParameterTable parameters() const;
  /// Of a parameter that may have been asked for by its old name.
  [[nodiscard]] std::string present_name(const std::string& name) const;
  // (component_parameters.cpp)
  struct ParameterRequest;
  void work_on(const std::shared_ptr<ParameterRequest>& request);
  void try_out(const std::shared_ptr<ParameterRequest>& request, ParameterPlan plan);

  // Lockstep (component_lockstep.cpp).
  void join_lockstep();
  void try_step();
  [[nodiscard]] bool ready_for(const strata_msgs::msg::Step& step);
  void perform(const strata_msgs::msg::Step& step);
  void work_off();
  void acknowledge(const strata_msgs::msg::Step& step, const std::string& error);

  ComponentContext context_;
  std::string full_name_;
  NodeClock clock_;
  ParameterModel parameter_model_;
  std::atomic<LifecycleState> state_{LifecycleState::kUnconfigured};
  bool finished_ = false;  ///< as learns() says
  std::atomic<bool> tick_waits_{false};
  std::atomic<std::uint64_t> dropped_{0};
  std::atomic<std::uint64_t> received_{0};
  std::atomic<std::uint64_t> processed_{0};
  std::atomic<std::uint64_t> skipped_{0};
  std::uint64_t failed_ = 0;       // messages and all else
  std::uint64_t undecodable_ = 0;  // of those that failed
  std::atomic<std::uint64_t> ignored_{0};
  ToldErrors told_errors_;
  bool is_changing_state_ = false;
  bus::Caught untold_;
  std::string last_error_;
  std::vector<std::string> warnings_;  // until cleanup
  std::uint64_t told_dropped_ = 0;     // as of the last status
  std::uint64_t told_failed_ = 0;
  std::unique_ptr<bus::Node> node_;
  std::unique_ptr<Diagnostics> diagnostics_;
  std::unique_ptr<Rosout> rosout_;            // live only
  std::unique_ptr<ServiceHub> services_;      // live only, as those below
  std::unique_ptr<ServiceHub> own_services_;  // from configure to cleanup
  std::mutex bond_mutex_;                     // making and dropping bond_, and tick()
  std::unique_ptr<Bond> bond_;
  std::unique_ptr<bus::Writer<lifecycle_msgs::msg::TransitionEvent>> transition_events_;
  std::unique_ptr<bus::Writer<rcl_interfaces::msg::ParameterEvent>> parameter_events_;
  std::vector<TopicUse> topics_;
  // Shared with the tasks that wait in the mailbox.
  std::vector<std::shared_ptr<Subscription>> subscriptions_;
  std::vector<std::shared_ptr<bus::RawWriter>> writers_;
  std::optional<strata_msgs::msg::Step> step_;
  std::unique_ptr<bus::RawWriter> ack_writer_;
  std::unique_ptr<bus::Reader<strata_msgs::msg::Step>> step_reader_;
  std::unique_ptr<Mailbox> trials_;  // last: what it works on uses the others
};

}  // namespace strata::runtime
