// SPDX-License-Identifier: Apache-2.0
/// Who talks to whom on a secured domain.
#include <condition_variable>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <mutex>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/bus/endpoint.hpp"
#include "components/bus/environment.hpp"
#include "components/bus/node.hpp"
#include "components/security/certificate.hpp"
#include "components/security/documents.hpp"
#include "components/security/keystore.hpp"
#include "core/base/error.hpp"
#include "tests/components/bus/domain.hpp"
#include "tests/support/test_data.hpp"

namespace strata::bus {
namespace {

using testing::HasSubstr;
constexpr const char* kType = "sensor_msgs/msg/LaserScan";
constexpr auto kPatience = std::chrono::seconds(20);

class Security : public testing::Test {
 protected:
  const test::TemporaryDirectory folder_;
  const std::string place_ = (folder_.path() / "keystore").string();
  const security::Keystore keystore_ = security::Keystore::create(place_);

  void SetUp() override {
    for (const char* name : {"/sensor", "/mapper"}) keystore_.add(name);
  }
  [[nodiscard]] ParticipantOptions options(const std::string& enclave) const {
    ParticipantOptions options;
    options.domain = test::own_domain();
    options.transport = Transport::kLoopback;
    options.enclave = enclave;
    options.security = {true, true, place_};
    return options;
  }
  [[nodiscard]] std::shared_ptr<Participant> join(const std::string& enclave) const {
    return std::make_shared<Participant>(options(enclave));
  }
  /// Gives an enclave a governance of its own, signed by the authority.
  void let_anybody_write_scans(const std::string& enclave) const {
    std::string text = security::governance_document();
    const std::size_t rules = text.find("<topic_rule>");
    std::string rule = text.substr(rules, text.find("</topic_rule>") + 13 - rules);
    const auto replace = [](std::string& in, const std::string& from, const std::string& to) {
      in.replace(in.find(from), from.size(), to);
    };
    replace(rule, "<topic_expression>*<", "<topic_expression>rt/scan<");
    replace(rule, "write_access_control>true<", "write_access_control>false<");
    const auto content = [this](const char* name) {
      return test::bytes_of(std::filesystem::path(place_) / name);
    };
    const std::filesystem::path file = security::enclave_in(place_, enclave).governance();
    std::filesystem::remove(file);  // it points to the keystore's
    std::ofstream(file) << security::sign(
        {content("public/permissions_ca.cert.pem"), content("private/permissions_ca.key.pem")},
        text.insert(rules, rule));
  }
};

/// Counts what comes.
struct Listener {
  std::mutex mutex;
  std::condition_variable changed;
  std::vector<std::vector<std::uint8_t>> messages;
  RawReader reader;

  Listener(const std::shared_ptr<Participant>& participant, const std::string& topic)
      : reader(participant, topic, kType, qos_profile("latched"),
               [this](const RawMessage& message) {
                 const std::lock_guard lock(mutex);
                 messages.push_back(message.cdr);
                 changed.notify_all();
               }) {}
  [[nodiscard]] bool hears(std::size_t count) {
    std::unique_lock lock(mutex);
    return changed.wait_for(lock, kPatience, [&] { return messages.size() >= count; });
  }
  [[nodiscard]] std::size_t count() {
    const std::lock_guard lock(mutex);
    return messages.size();
  }
};

std::vector<std::uint8_t> a_message() { return {0, 1, 0, 0, 42, 0, 0, 0}; }

TEST_F(Security, LetsEnclavesOfOneKeystoreTalk) {
  const auto sensor = join("/sensor");
  const auto mapper = join("/mapper");
  EXPECT_TRUE(sensor->is_secured());
  RawWriter writer(sensor, "/scan", kType, qos_profile("latched"));
  writer.publish(a_message());
  Listener listener(mapper, "/scan");
  ASSERT_TRUE(listener.hears(1));
  EXPECT_EQ(listener.messages[0], a_message());
}

TEST_F(Security, KeepsOutWhoHasNoCertificate) {
  const auto sensor = join("/sensor");
  const auto mapper = join("/mapper");
  const auto stranger = test::make_participant();
  const auto other_stranger = test::make_participant();
  RawWriter writer(sensor, "/scan", kType, qos_profile("latched"));
  RawWriter false_writer(stranger, "/scan", kType, qos_profile("latched"));
  writer.publish(a_message());
  false_writer.publish(a_message());
  Listener listener(mapper, "/scan");
  Listener false_listener(stranger, "/scan");
  Listener other_listener(other_stranger, "/scan");
  // Strangers have had the time to find each other, and the others have too.
  ASSERT_TRUE(other_listener.hears(1));
  ASSERT_TRUE(listener.hears(1));
  EXPECT_EQ(listener.reader.matched(), 1);
  EXPECT_EQ(listener.count(), 1U);
  EXPECT_FALSE(writer.is_matched_with(stranger->guid()));
  EXPECT_FALSE(false_writer.is_matched_with(mapper->guid()));
}

TEST_F(Security, KeepsOutAnEnclaveOfAnotherKeystore) {
  const std::string other_place = (folder_.path() / "other").string();
  const security::Keystore other = security::Keystore::create(other_place);
  for (const char* name : {"/sensor", "/mapper"}) other.add(name);
  ParticipantOptions other_sensor = options("/sensor");
  other_sensor.security.keystore = other_place;
  ParticipantOptions other_mapper = options("/mapper");
  other_mapper.security.keystore = other_place;
  const auto intruder = std::make_shared<Participant>(other_sensor);
  const auto its_friend = std::make_shared<Participant>(other_mapper);
  const auto sensor = join("/sensor");
  const auto mapper = join("/mapper");
  RawWriter writer(sensor, "/scan", kType, qos_profile("latched"));
  RawWriter false_writer(intruder, "/scan", kType, qos_profile("latched"));
  writer.publish(a_message());
  false_writer.publish(a_message());
  Listener friendly(its_friend, "/scan");
  Listener listener(mapper, "/scan");
  ASSERT_TRUE(friendly.hears(1));
  ASSERT_TRUE(listener.hears(1));
  EXPECT_EQ(listener.reader.matched(), 1);
  EXPECT_EQ(friendly.reader.matched(), 1);
  EXPECT_FALSE(false_writer.is_matched_with(mapper->guid()));
}

TEST_F(Security, LetsNobodyOutOfItsPermissions) {
  keystore_.set_permissions("/sensor", {{"rt/scan"}, {"rt/map*"}});
  const auto sensor = join("/sensor");
  const RawWriter allowed(sensor, "/scan", kType, qos_profile("latched"));
  Listener also_allowed(sensor, "/map_filtered");
  try {
    const RawWriter refused(sensor, "/map", kType, qos_profile("latched"));
    FAIL() << "writes what it may not";
  } catch (const OutputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("enclave /sensor may not write rt/map;"));
  }
  try {
    const Listener refused(sensor, "/scan");
    FAIL() << "reads what it may not";
  } catch (const OutputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("enclave /sensor may not read rt/scan;"));
  }
}

TEST_F(Security, IsNotTurnedOffForATopicByWhoMayNotWriteIt) {
  // /sensor may write /map only. Its own governance says that anybody may write /scan, so nothing
  // on its side keeps it from that: the others have to.
  keystore_.set_permissions("/sensor", {{"rt/map"}, {"rt/scan"}});
  keystore_.add("/accomplice");
  for (const char* name : {"/sensor", "/accomplice"}) let_anybody_write_scans(name);
  const auto sensor = join("/sensor");
  const auto accomplice = join("/accomplice");
  const auto mapper = join("/mapper");
  RawWriter scans(sensor, "/scan", kType, qos_profile("latched"));
  RawWriter maps(sensor, "/map", kType, qos_profile("latched"));
  RawWriter true_scans(mapper, "/scan", kType, qos_profile("latched"));
  scans.publish(a_message());
  maps.publish(a_message());
  Listener of_maps(mapper, "/map");
  Listener of_accomplice(accomplice, "/scan");
  Listener of_mapper(mapper, "/scan");
  true_scans.publish(a_message());
  ASSERT_TRUE(of_accomplice.hears(1)) << "scans do leave it";
  ASSERT_TRUE(of_maps.hears(1)) << "and the mapper knows it and hears what it may write";
  ASSERT_TRUE(of_mapper.hears(1));
  EXPECT_EQ(of_mapper.reader.matched(), 1) << "with its own writer";
  EXPECT_EQ(of_mapper.count(), 1U);
  EXPECT_TRUE(maps.is_matched_with(mapper->guid()));
  EXPECT_FALSE(scans.is_matched_with(mapper->guid()));
}

TEST_F(Security, StillAnnouncesNodesToRos2) {
  keystore_.set_permissions("/sensor", {{}, {}});
  keystore_.set_permissions("/mapper", {{}, {}});
  const auto sensor = join("/sensor");
  const auto mapper = join("/mapper");
  const Node node(sensor, "/robot1", "lidar");
  const GraphReader graph(mapper);
  EXPECT_TRUE(graph.wait_for_node("/robot1/lidar", kPatience));
}

TEST_F(Security, ThatIsEnforcedNeedsTheEnclave) {
  EXPECT_THROW((void)join("/nobody"), InputError);
  EXPECT_THROW((void)join("/"), InputError);
}

TEST_F(Security, ThatIsPermissiveDoesWithoutOne) {
  ParticipantOptions permissive = options("/nobody");
  permissive.security.enforced = false;
  const auto plain = std::make_shared<Participant>(permissive);
  EXPECT_FALSE(plain->is_secured());
  const auto other = test::make_participant();
  RawWriter writer(plain, "/scan", kType, qos_profile("latched"));
  writer.publish(a_message());
  Listener listener(other, "/scan");
  EXPECT_TRUE(listener.hears(1));
}

TEST_F(Security, ThatIsPermissiveStillRefusesAnEnclaveThatIsNotGood) {
  std::filesystem::remove(security::enclave_in(place_, "/sensor").permissions());
  ParticipantOptions permissive = options("/sensor");
  permissive.security.enforced = false;
  EXPECT_THROW(Participant{permissive}, InputError);
}

TEST_F(Security, IsTurnedOnByTheVariablesOfRos2) {
  const auto set = [](const char* name, const std::string& value) {
    setenv(name, value.c_str(), 1);
  };
  set("ROS_SECURITY_ENABLE", "true");
  EXPECT_THROW((void)options_from_environment(), ConfigError);  // no keystore
  set("ROS_SECURITY_KEYSTORE", place_);
  EXPECT_TRUE(options_from_environment().security.enabled);
  EXPECT_FALSE(options_from_environment().security.enforced);
  set("ROS_SECURITY_STRATEGY", "Enforce");
  set("ROS_SECURITY_ENCLAVE_OVERRIDE", "/sensor");
  const ParticipantOptions options = options_from_environment();
  EXPECT_TRUE(options.security.enforced);
  EXPECT_EQ(options.security.keystore, place_);
  EXPECT_EQ(options.enclave, "/sensor");
  set("ROS_SECURITY_STRATEGY", "enforce");
  EXPECT_THROW((void)options_from_environment(), ConfigError);
  set("ROS_SECURITY_ENABLE", "yes");
  EXPECT_THROW((void)options_from_environment(), ConfigError);
  for (const char* name : {"ROS_SECURITY_ENABLE", "ROS_SECURITY_STRATEGY", "ROS_SECURITY_KEYSTORE",
                           "ROS_SECURITY_ENCLAVE_OVERRIDE"}) {
    unsetenv(name);
  }
}

}  // namespace
}  // namespace strata::bus
