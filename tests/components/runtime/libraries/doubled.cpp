// SPDX-License-Identifier: Apache-2.0
/// Has a component under a name of the program's own.
#include "components/runtime/component_library.hpp"

namespace {

class Impostor final : public strata::runtime::Component {
 public:
  using Component::Component;

 private:
  void on_configure() override {}
};

}  // namespace

STRATA_COMPONENT_LIBRARY(registry) { registry.add<Impostor>("strata::MapServer"); }
