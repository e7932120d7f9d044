// SPDX-License-Identifier: Apache-2.0
/// A component that becomes active when it is let: it announces itself by one file and waits for
/// another.
#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>

#include "components/runtime/component_library.hpp"

namespace gate {

struct GateConfig {
  std::string folder;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("folder", c.folder, {.doc = "makes `waiting` in it and waits for `open`"});
  }
};

class Gate final : public strata::runtime::Component {
 public:
  using Component::Component;

 private:
  void on_configure() override { folder_ = read_parameters<GateConfig>().folder; }
  void on_activate() override {
    std::ofstream(folder_ / "waiting").close();
    while (!std::filesystem::exists(folder_ / "open")) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  }

  std::filesystem::path folder_;
};

}  // namespace gate

STRATA_COMPONENT_LIBRARY(registry) { registry.add<gate::Gate>("gate::Gate"); }
