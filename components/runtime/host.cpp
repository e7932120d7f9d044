// SPDX-License-Identifier: Apache-2.0
#include "components/runtime/host.hpp"

#include <exception>
#include <filesystem>
#include <utility>

#include "components/settings/config_reader.hpp"
#include "core/base/error.hpp"

namespace strata::runtime {

class Host::Cancellation : public Progress {
 public:
  void update(std::string_view /*stage*/, std::size_t /*done*/, std::size_t /*total*/) override {}
  [[nodiscard]] bool cancelled() const override { return cancelled_; }
  void cancel() { cancelled_ = true; }

 private:
  std::atomic<bool> cancelled_{false};
};

namespace {

const Factory& factory_of(const Registry& registry, const ComponentEntry& entry) {
  const auto found = registry.factories().find(entry.type);
  if (found != registry.factories().end()) return found->second;
  std::vector<std::string> known;
  for (const auto& [type, factory] : registry.factories()) known.push_back(type);
  throw ConfigError(entry.place, "unknown component type '" + entry.type + "'",
                    settings::detail::suggestion(entry.type, known, "types"));
}

}  // namespace

std::filesystem::path out_folder_of(const ComponentEntry& entry, const Composition& composition) {
  const std::filesystem::path own = entry.node_namespace;
  const std::filesystem::path common = composition.node_namespace;
  const std::filesystem::path below = own.lexically_relative(common);
  if (below == ".") return {};
  if (!below.empty() && *below.begin() != "..") return below;
  return own.relative_path();
}

std::shared_ptr<bus::Participant> make_participant(const Composition& composition) {
  return std::make_shared<bus::Participant>(composition.network);
}

Host::Host(const Composition& composition, const ProcessEntry& process, const Registry& registry,
           std::shared_ptr<bus::Participant> participant, const HostOptions& options)
    : cancellation_(std::make_unique<Cancellation>()),
      participant_(std::move(participant)),
      executor_(process.executor) {
  make(composition, process, registry, options);
  // Nobody leads a component through a replay or a dry run but the coordinator.
  const bool is_managed = options.mode == FeedMode::kLive && !options.dry_run;
  try {
    for (std::size_t i = 0; i < components_.size(); ++i) {
      if (is_managed && starts_[i] == Start::kUnconfigured) {
        components_[i]->join();
      } else {
        components_[i]->configure();
      }
    }
  } catch (...) {
    stop();  // the destructor does not run
    throw;
  }
}

void Host::make(const Composition& composition, const ProcessEntry& process,
                const Registry& registry, const HostOptions& options) {
  for (const ComponentEntry& entry : process.components) {
    const Factory& factory = factory_of(registry, entry);
    ComponentContext context;
    context.participant = participant_;
    context.mailbox = executor_.mailbox();
    context.name = entry.name;
    context.node_namespace = entry.node_namespace;
    context.out_folder = out_folder_of(entry, composition);
    context.remappings = entry.remappings;
    context.parameters = entry.parameters;
    context.common_parameters = entry.common_parameters;
    context.make = factory;
    context.dry_run = options.dry_run;
    context.place = composition.place;
    context.mode = options.mode;
    context.seed = options.seed;
    context.threads = options.threads;
    context.use_sim_time = composition.use_sim_time;
    context.progress = cancellation_.get();
    context.on_error = [this](const std::string& error) {
      const std::lock_guard lock(mutex_);
      errors_.push_back(error);
    };
    components_.push_back(factory(std::move(context)));
    starts_.push_back(entry.start);
  }
}

Host::~Host() { stop(); }

void Host::activate() {
  for (std::size_t i = 0; i < components_.size(); ++i) {
    if (starts_[i] == Start::kActive) components_[i]->activate();
  }
}

void Host::tick() {
  for (const auto& component : components_) component->tick();
  free_memory_.take();
}

void Host::stop() noexcept {
  if (std::exchange(stopped_, true)) return;
  cancellation_->cancel();
  const auto quietly = [](auto&& body) {
    try {
      body();
    } catch (const std::exception&) {  // NOLINT(bugprone-empty-catch): the rest must stop too
    }
  };
  for (auto it = components_.rbegin(); it != components_.rend(); ++it) {
    quietly([&] { (*it)->deactivate(); });
  }
  for (auto it = components_.rbegin(); it != components_.rend(); ++it) {
    quietly([&] { (*it)->shutdown(); });
  }
  executor_.stop();
  components_.clear();
}

std::vector<std::string> Host::take_errors() {
  const std::lock_guard lock(mutex_);
  return std::exchange(errors_, {});
}

}  // namespace strata::runtime
