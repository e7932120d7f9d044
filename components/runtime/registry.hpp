// SPDX-License-Identifier: Apache-2.0
/// From a type name in a composition ("strata::Localizer") to the component.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>

#include "components/runtime/component.hpp"

namespace strata::runtime {

using Factory = std::function<std::unique_ptr<Component>(ComponentContext)>;

/// An explicit object, filled by each component's register.cpp; nothing registers itself.
class Registry {
 public:
  template <typename C>
  void add(const std::string& type) {
    factories_[type] = [](ComponentContext context) -> std::unique_ptr<Component> {
      return std::make_unique<C>(std::move(context));
    };
  }
  void add(const std::string& type, Factory factory) { factories_[type] = std::move(factory); }
  [[nodiscard]] const std::map<std::string, Factory>& factories() const { return factories_; }

 private:
  std::map<std::string, Factory> factories_;
};

}  // namespace strata::runtime
