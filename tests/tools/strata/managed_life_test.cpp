// SPDX-License-Identifier: Apache-2.0
/// Every component led through its life by another: again and again, and with the services of an
/// unconfigured node before all that.
#include <fstream>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "components/bus/service.hpp"
#include "components/runtime/host.hpp"
#include "tests/tools/strata/replay_fixture.hpp"
#include "tools/all_components/all_components.hpp"

namespace fs = std::filesystem;

namespace strata::tools {
namespace {

using runtime::LifecycleState;

class EveryComponent : public test::ReplayFixture {
 protected:
  void SetUp() override {
    ReplayFixture::SetUp();
    write_composition();
    composition_ = runtime::load_composition(at("all.yaml"));
    host_ =
        std::make_unique<runtime::Host>(composition_, composition_.processes[0], all_components(),
                                        test::make_participant(), runtime::HostOptions{});
    host_->activate();
  }
  void write_composition() const {
    std::ofstream file(at("all.yaml"));
    file << "version: 1\ntransport: loopback\nstart: unconfigured\n"
            "processes:\n  - name: p\n    components:\n";
    const auto add = [&](const std::string& type, const std::string& parameters,
                         const std::string& scope = "/robot") {
      file << "      - {type: strata::" << type << ", name: " << type << ", namespace: " << scope
           << ", parameters: {" << parameters << "}}\n";
    };
    add("MapServer", "topic: served_map, map: " + (at("direct") / "filtered.yaml").string());
    add("MapSaver", "");
    add("ScanMatcher", "store: {file: " + at("matcher").string() + "}");
    add("BeamFilter", "store: {file: " + at("filter").string() + "}");
    add("PatchLearner", "online: {enabled: true, store: {folder: " + at("patches").string() + "}}");
    add("TimescaleMemory", "store: " + at("memory.db").string());
    add("TopologyMapper", "store: {file: " + at("topology").string() + "}");
    add("VolumeMapper", "store: " + at("volume.ot").string());
    add("Localizer", "maps: " + at("direct").string() +
                         ", start: {store: {file: " + at("place").string() + "}}");
    // What it plays again and again has stamps that the others would rightly complain of.
    add("Player", "rate: 1000, log: " + log().string(), "/old");
    add("Recorder", "out: " + at("bag").string() + ", topics: [scan]", "/old");
    add("IncidentRecorder", "out: " + at("incidents").string() + ", topics: [scan]", "/old");
    add("LiveView", "port: 0");
    if (all_components().factories().contains("strata::FleetMember")) {
      add("FleetMember", "server: 'postgresql://hall.r1@/none?host=" + at("none").string() +
                             "', site: hall, maps: [" + at("direct").string() + "]");
    }
  }
  void lead(void (runtime::Component::*transition)(), LifecycleState goal) {
    for (const auto& component : host_->components()) {
      (component.get()->*transition)();
      EXPECT_EQ(component->state(), goal) << component->full_name();
    }
    host_->tick();
  }
  runtime::Composition composition_;
  std::unique_ptr<runtime::Host> host_;
};

TEST_F(EveryComponent, TellsItsParametersBeforeItIsConfigured) {
  std::set<std::string> types;
  for (const auto& entry : composition_.processes[0].components) types.insert(entry.type);
  const runtime::Registry registry = all_components();
  for (const auto& [type, factory] : registry.factories()) {
    EXPECT_EQ(types.count(type), 1U) << type << " is not in this test";
  }
  const auto manager = test::make_participant();
  for (const auto& component : host_->components()) {
    EXPECT_EQ(component->state(), LifecycleState::kUnconfigured);
    const auto response = bus::call_service<bus::srv::ListParameters>(
        manager, component->full_name() + "/list_parameters", {}, std::chrono::seconds(20));
    ASSERT_TRUE(response.has_value()) << component->full_name();
    EXPECT_GT(response->result().names().size(), 1U) << component->full_name();
  }
}

TEST_F(EveryComponent, GoesThroughItsLifeAgainAndAgain) {
  for (int life = 0; life < 3; ++life) {
    lead(&runtime::Component::configure, LifecycleState::kInactive);
    lead(&runtime::Component::activate, LifecycleState::kActive);
    lead(&runtime::Component::deactivate, LifecycleState::kInactive);
    lead(&runtime::Component::activate, LifecycleState::kActive);
    lead(&runtime::Component::deactivate, LifecycleState::kInactive);
    lead(&runtime::Component::cleanup, LifecycleState::kUnconfigured);
  }
  lead(&runtime::Component::shutdown, LifecycleState::kFinalized);
  EXPECT_EQ(host_->take_errors(), std::vector<std::string>());
  for (const char* bag : {"bag", "bag_2", "bag_3"}) EXPECT_TRUE(fs::exists(at(bag))) << bag;
}

}  // namespace
}  // namespace strata::tools
