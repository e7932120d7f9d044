// SPDX-License-Identifier: Apache-2.0
/// `strata keystore`, and compositions that run with what it allows them.
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "components/bus/endpoint.hpp"
#include "tests/components/bus/domain.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/test_data.hpp"
#include "tests/tools/strata/program.hpp"

namespace strata::tools {
namespace {

namespace fs = std::filesystem;
using test::ChildProcess;
using test::quoted;
using test::run_strata;
using testing::HasSubstr;

class KeystoreVerb : public testing::Test {
 protected:
  const test::TemporaryDirectory folder_;
  const fs::path place_ = folder_.path() / "keystore";
  const fs::path compositions_ = fs::path(STRATA_SOURCE_DIR) / "components" / "config";

  test::Outcome keystore(const std::string& action, const std::string& rest = "") const {
    return run_strata("keystore " + action + " --quiet " + quoted(place_) + " " + rest + " 2>&1");
  }
  void SetUp() override {
    ASSERT_EQ(keystore("create").code, 0);
    ASSERT_EQ(keystore("add", "/robot1 /fleet/robot2").code, 0);
  }
  /// The environment in which nothing runs without an enclave.
  [[nodiscard]] std::vector<std::string> enforced(const std::string& enclave = "") const {
    std::vector<std::string> variables = {"ROS_SECURITY_ENABLE=true",
                                          "ROS_SECURITY_STRATEGY=Enforce",
                                          "ROS_SECURITY_KEYSTORE=" + place_.string()};
    if (!enclave.empty()) variables.push_back("ROS_SECURITY_ENCLAVE_OVERRIDE=" + enclave);
    return variables;
  }
  [[nodiscard]] std::vector<std::string> run_command(const std::string& composition) const {
    return {STRATA_PROGRAM, "run", (compositions_ / composition).string(), "--set",
            "domain=" + std::to_string(test::own_domain())};
  }
};

TEST_F(KeystoreVerb, ListsEnclavesAndTheirFaults) {
  fs::remove(place_ / "enclaves/robot1/key.pem");
  const test::Outcome outcome = keystore("list", "--json");
  ASSERT_EQ(outcome.code, 0) << outcome.out;
  const auto json = nlohmann::json::parse(outcome.out);
  ASSERT_EQ(json.size(), 2U);
  EXPECT_EQ(json[0]["enclave"], "/fleet/robot2");
  EXPECT_EQ(json[0]["good"], true);
  EXPECT_EQ(json[1]["good"], false);
  EXPECT_THAT(json[1]["fault"].get<std::string>(), HasSubstr("key.pem: is missing"));
}

TEST_F(KeystoreVerb, SaysWhatIsWrongWithTheCommand) {
  const auto expect = [&](const test::Outcome& outcome, const std::string& words) {
    EXPECT_NE(outcome.code, 0) << outcome.out;
    EXPECT_THAT(outcome.out, HasSubstr(words));
  };
  expect(keystore("create"), "is there already");
  expect(keystore("add", "/robot1"), "is there already");
  expect(keystore("add", "'robot 1'"), "is no name of an enclave");
  expect(keystore("permissions", "/robot3 --everything"), "is not in");
  expect(keystore("permissions", "/robot1"), "says nothing of what the enclave may do");
  expect(keystore("permissions", "/robot1 --publish 'a b'"), "no topic has such a name");
  expect(run_strata("keystore list /nowhere 2>&1"), "is no keystore");
}

TEST_F(KeystoreVerb, AllowsACompositionAllThatItNeeds) {
  for (const char* name : {"mapping.yaml", "topology.yaml"}) {
    ASSERT_EQ(keystore("permissions", "/robot1 --composition " + quoted(compositions_ / name)).code,
              0);
    ChildProcess run(run_command(name), enforced("/robot1"), ChildProcess::Errors::kMerged);
    EXPECT_NE(run.wait_for_line("process "), "") << name;
    run.send(SIGINT);
    const std::string said = run.rest();
    EXPECT_EQ(run.wait(), 0) << said;
    EXPECT_EQ(said.find("may not"), std::string::npos) << said;
  }
}

TEST_F(KeystoreVerb, AllowsWhoFindsTopicsAsItGoesToReadThem) {
  bus::ParticipantOptions options;
  options.domain = test::own_domain();
  options.transport = bus::Transport::kLoopback;
  options.enclave = "/fleet/robot2";
  options.security = {true, true, place_.string()};
  const auto other = std::make_shared<bus::Participant>(options);
  const std::string out = (folder_.path() / "out").string();
  for (const std::string& component :
       {"strata::Recorder, name: c, parameters: {out: " + out + "_bag}",
        "strata::IncidentRecorder, name: c, parameters: {out: " + out + "}",
        std::string("strata::LiveView, name: c, parameters: {port: 0, keep_newest: true}")}) {
    const fs::path file = folder_.path() / "c.yaml";
    std::ofstream(file) << "version: 1\ntransport: loopback\nenclave: /robot1\nprocesses:\n"
                           "  - name: p\n    components: [{type: "
                        << component << "}]\n";
    ASSERT_EQ(keystore("permissions", "/robot1 --composition " + quoted(file)).code, 0);
    const bus::RawWriter foreign(other, "/foreign", "sensor_msgs/msg/LaserScan",
                                 bus::qos_profile("latched"));
    ChildProcess run({STRATA_PROGRAM, "run", file.string(), "--set",
                      "domain=" + std::to_string(test::own_domain())},
                     enforced(), ChildProcess::Errors::kMerged);
    EXPECT_NE(run.wait_for_line("process p runs"), "") << component;
    EXPECT_TRUE(foreign.wait_for_readers(1, std::chrono::seconds(60))) << component;
    run.send(SIGINT);
    const std::string said = run.rest();
    EXPECT_EQ(run.wait(), 0) << said;
    EXPECT_EQ(said.find("may not"), std::string::npos) << said;
  }
}

TEST_F(KeystoreVerb, StopsACompositionThatNeedsMore) {
  ASSERT_EQ(keystore("permissions", "/robot1 --subscribe /scan --publish /map").code, 0);
  ChildProcess run(run_command("mapping.yaml"), enforced("/robot1"), ChildProcess::Errors::kMerged);
  EXPECT_THAT(run.rest(), HasSubstr("enclave /robot1 may not "));
  EXPECT_NE(run.wait(), 0);
}

TEST_F(KeystoreVerb, MakesACompositionRunAsItsEnclaveUnlessTheEnvironmentNamesAnother) {
  const fs::path file = folder_.path() / "c.yaml";
  std::ofstream(file)
      << "version: 1\ntransport: loopback\nenclave: /fleet/robot2\nprocesses:\n"
         "  - name: p\n    components: [{type: strata::BeamFilter, name: filter}]\n";
  const std::vector<std::string> command = {STRATA_PROGRAM, "run", file.string(), "--set",
                                            "domain=" + std::to_string(test::own_domain())};
  // Each may do too little in turn, and says who it is.
  ASSERT_EQ(keystore("permissions", "/fleet/robot2 --publish /nothing").code, 0);
  ChildProcess itself(command, enforced(), ChildProcess::Errors::kMerged);
  EXPECT_THAT(itself.rest(), HasSubstr("enclave /fleet/robot2 may not "));
  EXPECT_NE(itself.wait(), 0);
  ChildProcess as_another(command, enforced("/robot1"), ChildProcess::Errors::kMerged);
  EXPECT_NE(as_another.wait_for_line("process p runs"), "");
  ASSERT_EQ(keystore("permissions", "/fleet/robot2 --everything").code, 0);
  ASSERT_EQ(keystore("permissions", "/robot1 --publish /nothing").code, 0);
  ChildProcess allowed(command, enforced(), ChildProcess::Errors::kMerged);
  EXPECT_NE(allowed.wait_for_line("process p runs"), "");
  ChildProcess refused(command, enforced("/robot1"), ChildProcess::Errors::kMerged);
  EXPECT_THAT(refused.rest(), HasSubstr("enclave /robot1 may not "));
}

TEST_F(KeystoreVerb, StopsACompositionWithoutAnEnclave) {
  ChildProcess run(run_command("mapping.yaml"), enforced("/nobody"), ChildProcess::Errors::kMerged);
  EXPECT_THAT(run.rest(), HasSubstr("enclave /nobody: is not in the keystore"));
  EXPECT_EQ(run.wait(), 2);
}

}  // namespace
}  // namespace strata::tools
