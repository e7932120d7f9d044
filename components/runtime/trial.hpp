// SPDX-License-Identifier: Apache-2.0
/// Whether a component could be configured with other parameters than it has.
#pragma once

#include <memory>
#include <string>

#include "components/runtime/component.hpp"

namespace strata::runtime {

/// Configures other components like one that runs, which nobody sees and which write no files.
/// Works on a copy of what that one was given, so on any thread.
class Trial {
 public:
  /// From the component's own thread.
  explicit Trial(const ComponentContext& context);

  /// What configuring with `parameters` fails with; empty: nothing, or a component that cannot be
  /// made again. Takes as long as configuring.
  [[nodiscard]] std::string failure_with(const YAML::Node& parameters) const;
  /// The same with the parameters as they were.
  [[nodiscard]] std::string failure_before() const { return failure_with(context_.parameters); }

 private:
  ComponentContext context_;
};

}  // namespace strata::runtime
