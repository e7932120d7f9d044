// SPDX-License-Identifier: Apache-2.0
/// One component of any registered type, led by a test itself, and what it needs to be configured.
#pragma once

#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "components/runtime/component.hpp"
#include "components/runtime/registry.hpp"

namespace strata::test {

/// The names of all registered types.
[[nodiscard]] std::vector<std::string> component_types();

/// Files in `folder` that components need, and which of them: the parameters of a type of
/// component, as YAML. What no component that is known here needs is left to its defaults, so that
/// new ones are tested too.
[[nodiscard]] std::string parameters_of(const std::string& type,
                                        const std::filesystem::path& folder);

/// A component on a mailbox of its own.
class Bench {
 public:
  Bench(const std::string& type, std::shared_ptr<bus::Participant> participant,
        const std::filesystem::path& folder, runtime::FeedMode mode = runtime::FeedMode::kLive);
  ~Bench();
  Bench(const Bench&) = delete;
  Bench& operator=(const Bench&) = delete;

  [[nodiscard]] runtime::Component& component() { return *component_; }
  /// Does what a running process does several times a second, and waits until it is done.
  void tick();
  /// Waits until it has worked on everything that has come.
  void settle() {
    mailbox_->call([] {});
  }
  [[nodiscard]] std::vector<std::string> take_errors();

 private:
  std::mutex mutex_;
  std::vector<std::string> errors_;  // under mutex_
  std::shared_ptr<runtime::Mailbox> mailbox_ = std::make_shared<runtime::Mailbox>();
  std::unique_ptr<runtime::Component> component_;
};

}  // namespace strata::test
