// SPDX-License-Identifier: Apache-2.0
/// A secured domain that Cyclone DDS is on as well: our keystore is good for both, and both keep
/// out who has no certificate.
#include <chrono>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "components/security/keystore.hpp"
#include "tests/components/bus/domain.hpp"
#include "tests/components/runtime/host_fixture.hpp"
#include "tests/interop/cyclone/process.hpp"
#include "tests/interop/cyclone/samples.hpp"
#include "tests/support/test_data.hpp"

namespace strata::test {
namespace {

constexpr std::chrono::seconds kPatience(20);

using sensor_msgs::msg::LaserScan;

class CycloneSecurity : public testing::Test {
 protected:
  const TemporaryDirectory folder_;
  const std::string place_ = (folder_.path() / "keystore").string();
  const security::Keystore keystore_ = security::Keystore::create(place_);

  void SetUp() override {
    keystore_.add("/strata");
    keystore_.add("/cyclone");
  }
  [[nodiscard]] std::shared_ptr<bus::Participant> join(const std::string& enclave = "/strata",
                                                       bool enforced = true) const {
    bus::ParticipantOptions options;
    options.domain = own_domain();
    options.transport = bus::Transport::kLoopback;
    options.enclave = enclave;
    options.security = {true, enforced, place_};
    return std::make_shared<bus::Participant>(options);
  }
  [[nodiscard]] std::filesystem::path cyclone_enclave() const {
    return security::enclave_in(place_, "/cyclone").folder;
  }
};

/// Asks, and hears the answer.
struct Conversation {
  explicit Conversation(const std::shared_ptr<bus::Participant>& participant)
      : answers(participant, "/answer_LaserScan", "latched"),
        writer(participant, "/ask_LaserScan", bus::qos_profile("latched")) {
    writer.publish(sample<LaserScan>());
  }
  Collector<LaserScan> answers;
  bus::Writer<LaserScan> writer;
};

TEST_F(CycloneSecurity, TalksWithUsUnderOneKeystore) {
  CycloneProcess cyclone({"echo"}, cyclone_enclave());
  ASSERT_EQ(cyclone.wait_for_line("ready"), "ready");
  Conversation conversation(join());
  const auto answers = conversation.answers.wait_for(1);
  ASSERT_FALSE(answers.empty());
  EXPECT_EQ(answers[0], sample<LaserScan>());
}

TEST_F(CycloneSecurity, TalksWithUsAboutWhatItsPermissionsNameWhenItComesLate) {
  // The peer makes every topic before it says that it is ready.
  keystore_.set_permissions("/cyclone", {{"rt/answer_*"}, {"rt/ask_*"}});
  keystore_.set_permissions("/strata", {{"rt/ask_LaserScan"}, {"rt/answer_LaserScan"}});
  Conversation conversation(join());
  CycloneProcess cyclone({"echo"}, cyclone_enclave());
  ASSERT_EQ(cyclone.wait_for_line("ready"), "ready");
  const auto answers = conversation.answers.wait_for(1);
  ASSERT_FALSE(answers.empty());
  EXPECT_EQ(answers[0], sample<LaserScan>());
}

TEST_F(CycloneSecurity, KeepsOutOfItsPermissions) {
  keystore_.set_permissions("/cyclone", {{"rt/nothing"}, {"rt/nothing"}});
  CycloneProcess cyclone({"echo"}, cyclone_enclave());
  EXPECT_EQ(cyclone.wait_for_line("ready"), "");  // it ends: it may make no endpoint
}

TEST_F(CycloneSecurity, NeitherReadsNorWritesWithoutACertificate) {
  CycloneProcess stranger({"echo"});
  ASSERT_EQ(stranger.wait_for_line("ready"), "ready");
  Conversation secured(join());
  // Somebody as open as the stranger, who comes later than we do, gets an answer. We get none.
  Conversation open(make_participant());
  ASSERT_FALSE(open.answers.wait_for(1).empty());
  EXPECT_TRUE(secured.answers.wait_for(1, std::chrono::milliseconds(0)).empty());
  CycloneProcess cyclone({"echo"}, cyclone_enclave());
  ASSERT_EQ(secured.answers.wait_for(1).size(), 1U);
  // What a writer knew before may be taken before the writer itself is told of the reader.
  ASSERT_TRUE(secured.writer.raw().wait_for_readers(1, kPatience));
  EXPECT_EQ(secured.writer.raw().matched(), 1);
  EXPECT_EQ(open.writer.raw().matched(), 1);
}

TEST_F(CycloneSecurity, ThatIsPermissiveWithUsTalksOpenlyWithoutAnEnclaveAndSecurelyWithOne) {
  CycloneProcess open_peer({"echo"});
  ASSERT_EQ(open_peer.wait_for_line("ready"), "ready");
  const auto open = join("/nobody", false);
  ASSERT_FALSE(open->is_secured());
  Conversation openly(open);
  ASSERT_EQ(openly.answers.wait_for(1).size(), 1U);
  const auto secured = join("/strata", false);
  ASSERT_TRUE(secured->is_secured());
  Conversation securely(secured);
  CycloneProcess secured_peer({"echo"}, cyclone_enclave());
  ASSERT_EQ(secured_peer.wait_for_line("ready"), "ready");
  ASSERT_EQ(securely.answers.wait_for(1).size(), 1U);
  // Each has found the one of its kind, and no other.
  ASSERT_TRUE(securely.writer.raw().wait_for_readers(1, kPatience));
  EXPECT_EQ(openly.writer.raw().matched(), 1);
  EXPECT_EQ(securely.writer.raw().matched(), 1);
}

}  // namespace
}  // namespace strata::test
