// SPDX-License-Identifier: Apache-2.0
#include "components/runtime/composition.hpp"

#include <cstdlib>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/settings/yaml_document.hpp"
#include "core/base/error.hpp"
#include "tests/support/test_data.hpp"

namespace strata::runtime {
namespace {

using ::testing::HasSubstr;

Composition read(const std::string& text) {
  return read_composition(settings::parse_yaml(text, "c.yaml"), "c.yaml");
}

/// The one line a user sees.
std::string complaint_about(const std::string& text) {
  try {
    (void)read(text);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "no complaint";
}

TEST(Composition, TakesWhatItIsToldAndDefaultsForTheRest) {
  const Composition composition = read(R"(
domain: 7
namespace: /robot1
transport: loopback
processes:
  - name: first
    executor: single_threaded
    components:
      - {type: strata::ScanMatcher, name: matcher, remappings: {scan: /front/scan}}
      - {type: strata::BeamFilter, name: filter, namespace: /robot2, parameters: {map_frame: m}}
  - name: second
)");
  EXPECT_EQ(composition.network.domain, 7);
  EXPECT_EQ(composition.network.transport, bus::Transport::kLoopback);
  ASSERT_EQ(composition.processes.size(), 2U);
  EXPECT_EQ(composition.processes[0].executor, ExecutorKind::kSingleThreaded);
  EXPECT_EQ(composition.processes[1].executor, ExecutorKind::kMultiThreaded);
  const auto& components = composition.processes[0].components;
  ASSERT_EQ(components.size(), 2U);
  EXPECT_EQ(components[0].node_namespace, "/robot1");
  EXPECT_EQ(components[0].remappings.at("scan"), "/front/scan");
  EXPECT_TRUE(components[0].parameters.IsMap());
  EXPECT_EQ(components[1].node_namespace, "/robot2");
  EXPECT_EQ(components[1].parameters["map_frame"].as<std::string>(), "m");
}

TEST(Composition, StartsWhatSaysNothingAsItsProcessElseAsTheWhole) {
  const Composition composition = read(R"(
start: unconfigured
processes:
  - name: first
    components: [{type: A, name: a}, {type: A, name: b, start: active}]
  - name: second
    start: inactive
    components: [{type: A, name: c}, {type: A, name: d, start: unconfigured}]
)");
  EXPECT_EQ(composition.processes[0].components[0].start, Start::kUnconfigured);
  EXPECT_EQ(composition.processes[0].components[1].start, Start::kActive);
  EXPECT_EQ(composition.processes[1].components[0].start, Start::kInactive);
  EXPECT_EQ(composition.processes[1].components[1].start, Start::kUnconfigured);
  const Composition usual = read("processes: [{name: p, components: [{type: A, name: a}]}]");
  EXPECT_EQ(usual.processes[0].components[0].start, Start::kActive);
}

TEST(Composition, NamesThePlaceOfAStartThatThereIsNot) {
  const std::string complaint = complaint_about(
      "processes:\n  - name: p\n    start: unconfigred\n    components: [{type: A, name: a}]\n");
  EXPECT_THAT(complaint, HasSubstr("c.yaml:3: a component cannot start 'unconfigred'"));
  EXPECT_THAT(complaint, HasSubstr("did you mean 'unconfigured'"));
}

TEST(Composition, NamesThePlaceOfAnUnknownKeyAndTheLikelyOne) {
  const std::string top = complaint_about("domian: 3\nprocesses: []\n");
  EXPECT_THAT(top, HasSubstr("c.yaml:1"));
  EXPECT_THAT(top, HasSubstr("did you mean 'domain'"));
  const std::string deep = complaint_about(
      "processes:\n"
      "  - name: p\n"
      "    components:\n"
      "      - type: strata::Player\n"
      "        name: player\n"
      "        remapings: {scan: /s}\n");
  EXPECT_THAT(deep, HasSubstr("c.yaml:6"));
  EXPECT_THAT(deep, HasSubstr("did you mean 'remappings'"));
}

TEST(Composition, RefusesWhatDoesNotExistWithThePlaceOfTheKey) {
  EXPECT_THAT(complaint_about("domain: 1\ntransport: tcp\n"), HasSubstr("c.yaml:2"));
  EXPECT_THAT(complaint_about("transport: tcp\n"), HasSubstr("loopback"));
  EXPECT_THAT(complaint_about("processes:\n  - name: p\n    executor: many\n"),
              HasSubstr("c.yaml:3: unknown executor 'many'"));
  EXPECT_THAT(complaint_about("domain: here\n"), HasSubstr("c.yaml:1"));
  EXPECT_THAT(complaint_about("processes: all\n"), HasSubstr("c.yaml:1"));
}

constexpr const char* kOneComponent =
    "processes: [{name: p, components: [{type: strata::Player, name: player}]}]\n";

TEST(Composition, NamesWhomToAskAndWinsOverTheEnvironment) {
  setenv("ROS_STATIC_PEERS", "10.0.0.1", 1);
  EXPECT_THAT(read(kOneComponent).network.static_peers, testing::ElementsAre("10.0.0.1"));
  const Composition peers =
      read(std::string("transport: localhost\nstatic_peers: [robot, 10.0.0.2]\n") + kOneComponent);
  unsetenv("ROS_STATIC_PEERS");
  EXPECT_EQ(peers.network.transport, bus::Transport::kLocalhost);
  EXPECT_THAT(peers.network.static_peers, testing::ElementsAre("robot", "10.0.0.2"));
  setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "OFF", 1);
  const Composition server =
      read(std::string("discovery_server: 10.0.0.5:11811\n") + kOneComponent);
  unsetenv("ROS_AUTOMATIC_DISCOVERY_RANGE");
  EXPECT_EQ(server.network.transport, bus::Transport::kDiscoveryServer);
  EXPECT_EQ(server.network.discovery_server, "10.0.0.5:11811");
  EXPECT_FALSE(server.network.is_alone);
}

TEST(Composition, SaysThatItsPeersAreNotAskedWhereTheEnvironmentForbidsIt) {
  const std::string text = std::string("static_peers: [10.0.0.1]\n") + kOneComponent;
  const auto notes_with = [&](const char* name, const char* value) {
    setenv(name, value, 1);
    const Composition composition = read(text);
    unsetenv(name);
    EXPECT_THAT(composition.network.static_peers, testing::ElementsAre("10.0.0.1"));
    return composition.notes;
  };
  EXPECT_THAT(
      notes_with("ROS_AUTOMATIC_DISCOVERY_RANGE", "OFF"),
      testing::ElementsAre(HasSubstr("c.yaml:1: static_peers are not asked: the environment "
                                     "says ROS_AUTOMATIC_DISCOVERY_RANGE=OFF")));
  EXPECT_THAT(notes_with("ROS_DISCOVERY_SERVER", "10.0.0.5:11811"),
              testing::ElementsAre(HasSubstr("the environment says transport discovery_server")));
  EXPECT_THAT(notes_with("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST"), testing::IsEmpty());
}

TEST(Composition, TakesAnEmptyListOfPeersWhereNoneWouldBeAsked) {
  const std::string text = std::string("static_peers: []\n") + kOneComponent;
  setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "OFF", 1);
  const Composition composition = read(text);
  unsetenv("ROS_AUTOMATIC_DISCOVERY_RANGE");
  EXPECT_THAT(composition.notes, testing::IsEmpty());
  EXPECT_EQ(complaint_about("transport: loopback\n" + text), "no complaint");
}

TEST(Composition, LetsTheReleaseSayWhatLocalhostOnlyMeans) {
  setenv("ROS_LOCALHOST_ONLY", "1", 1);
  const Composition old = read(std::string("ros_distro: humble\n") + kOneComponent);
  const Composition recent = read(std::string("ros_distro: jazzy\n") + kOneComponent);
  unsetenv("ROS_LOCALHOST_ONLY");
  EXPECT_EQ(old.network.transport, bus::Transport::kLoopback);
  EXPECT_EQ(recent.network.transport, bus::Transport::kLocalhost);
}

TEST(Composition, RefusesPeersAndServersThatItsTransportDoesNotAsk) {
  EXPECT_THAT(complaint_about("transport: loopback\nstatic_peers: [10.0.0.1]\n"),
              HasSubstr("c.yaml:2: peers are not asked with transport: loopback"));
  EXPECT_THAT(complaint_about("discovery_server: 10.0.0.1:11811\nstatic_peers: [10.0.0.1]\n"),
              HasSubstr("c.yaml:2: peers are not asked with transport: discovery_server"));
  EXPECT_THAT(complaint_about("transport: wifi\ndiscovery_server: 10.0.0.1:11811\n"),
              HasSubstr("c.yaml:2: a server is not asked with transport: wifi"));
  EXPECT_THAT(complaint_about("static_peers: 10.0.0.1\n"), HasSubstr("c.yaml:1"));
}

TEST(Composition, NeedsTypesAndNamesThatDiffer) {
  const auto with = [](const std::string& components) {
    return complaint_about("processes: [{name: p, components: [" + components + "]}]\n");
  };
  EXPECT_THAT(with("{name: a}"), HasSubstr("'type' is missing"));
  EXPECT_THAT(with("{type: t}"), HasSubstr("'name' is missing"));
  EXPECT_THAT(with("{type: t, name: a b}"), HasSubstr("c.yaml:1"));
  EXPECT_THAT(with("{type: t, name: a}, {type: u, name: a}"), HasSubstr("named 'a'"));
  EXPECT_EQ(with("{type: t, name: a, namespace: /x}, {type: t, name: a, namespace: /y}"),
            "no complaint");
  EXPECT_THAT(with(""), HasSubstr("no component is listed"));
  EXPECT_THAT(complaint_about("processes: [{name: p}, {name: p}]\n"),
              HasSubstr("two processes are named 'p'"));
}

TEST(Composition, RunsAsItsEnclaveUnlessTheEnvironmentNamesAnother) {
  const auto enclave_of = [](const std::string& line) {
    const std::string text =
        line + "processes: [{name: p, components: [{type: strata::Player, name: player}]}]\n";
    return read_composition(settings::parse_yaml(text, "c.yaml"), "c.yaml").network.enclave;
  };
  EXPECT_EQ(enclave_of(""), "/");
  EXPECT_EQ(enclave_of("enclave: /fleet/robot1\n"), "/fleet/robot1");
  setenv("ROS_SECURITY_ENCLAVE_OVERRIDE", "/other", 1);
  EXPECT_EQ(enclave_of("enclave: /fleet/robot1\n"), "/other");
  EXPECT_EQ(enclave_of(""), "/other");
  setenv("ROS_SECURITY_ENCLAVE_OVERRIDE", "/", 1);
  EXPECT_EQ(enclave_of("enclave: /fleet/robot1\n"), "/") << "the root's is one as any other";
  unsetenv("ROS_SECURITY_ENCLAVE_OVERRIDE");
}

TEST(Composition, FileNeedsItsVersionAndTakesOverrides) {
  const strata::test::TemporaryDirectory folder;
  const auto path = folder.path() / "c.yaml";
  const std::string body =
      "processes: [{name: p, components: [{type: strata::Player, name: player}]}]\n";
  const auto write = [&](const std::string& first_line) {
    std::ofstream(path) << first_line << '\n' << body;
  };
  write("version: 1");
  EXPECT_EQ(load_composition(path, {"domain=42"}).network.domain, 42);
  EXPECT_THROW((void)load_composition(path, {"domian=42"}), ConfigError);
  const Composition set = load_composition(path, {"processes[0].components[0].parameters.rate=2"});
  EXPECT_EQ(set.processes[0].components[0].parameters["rate"].as<int>(), 2);
  write("version: 2");
  EXPECT_THROW((void)load_composition(path), ConfigError);
  write("domain: 0");
  EXPECT_THROW((void)load_composition(path), ConfigError);
  EXPECT_THROW((void)load_composition(folder.path() / "none.yaml"), InputError);
}

}  // namespace
}  // namespace strata::runtime
