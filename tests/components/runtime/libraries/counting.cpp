// SPDX-License-Identifier: Apache-2.0
/// A library as others write them: one component with a parameter.
#include <memory>

#include "components/runtime/component_library.hpp"

namespace counting {

struct CounterConfig {
  int step = 1;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("step", c.step, {.doc = "added for each scan", .min = 1, .max = 10});
  }
};

class Counter final : public strata::runtime::Component {
 public:
  using Component::Component;

 private:
  void on_configure() override {
    const auto config = read_parameters<CounterConfig>();
    subscribe<sensor_msgs::msg::LaserScan>("scan", "sensor_data", [this, config](const auto&) {
      count_ += static_cast<std::uint64_t>(config.step);
    });
  }
  void on_diagnose(strata::runtime::Health& health) const override { health.add("count", count_); }

  std::uint64_t count_ = 0;
};

}  // namespace counting

STRATA_COMPONENT_LIBRARY(registry) { registry.add<counting::Counter>("counting::Counter"); }
