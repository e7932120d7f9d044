// SPDX-License-Identifier: Apache-2.0
/// Components that take their time: one becomes active when it is let, one writes for long at its
/// end. Files tell how far they are.
#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>

#include "components/runtime/component_library.hpp"
#include "core/base/error.hpp"

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

struct SlowStoreConfig {
  std::string folder;
  double takes_s = 0.0;
  bool disk_is_full = false;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("folder", c.folder,
            {.doc = "where `active`, `begun` and, when all is written, `kept` appear"});
    v.field("takes_s", c.takes_s, {.doc = "to write it", .unit = "s", .min = 0.0});
    v.field("disk_is_full", c.disk_is_full, {.doc = "it cannot be written"});
  }
};

class SlowStore final : public strata::runtime::Component {
 public:
  using Component::Component;

 private:
  void on_configure() override { config_ = read_parameters<SlowStoreConfig>(); }
  void on_activate() override { std::ofstream(config_.folder + "/active").close(); }
  void on_deactivate() override {
    const std::filesystem::path folder = config_.folder;
    const auto begin = std::chrono::steady_clock::now();
    std::ofstream(folder / "begun").close();
    const std::chrono::duration<double> takes(config_.takes_s);
    while (std::chrono::steady_clock::now() - begin < takes) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    if (config_.disk_is_full) {
      throw strata::OutputError(config_.folder, "has no space", "free some");
    }
    std::ofstream(folder / "kept").close();
  }

  SlowStoreConfig config_;
};

}  // namespace gate

STRATA_COMPONENT_LIBRARY(registry) {
  registry.add<gate::Gate>("gate::Gate");
  registry.add<gate::SlowStore>("gate::SlowStore");
}
