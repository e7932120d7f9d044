// SPDX-License-Identifier: Apache-2.0
/// A keystore as SROS2 lays it out, and what happens to one that is not as it should be.
#include "components/security/keystore.hpp"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/security/text_file.hpp"
#include "core/base/error.hpp"
#include "tests/support/test_data.hpp"

namespace strata::security {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

class KeystoreTest : public testing::Test {
 protected:
  const test::TemporaryDirectory folder_;
  const fs::path place_ = folder_.path() / "keystore";
  const Keystore keystore_ = Keystore::create(place_);

  [[nodiscard]] Enclave enclave(const std::string& name) const { return enclave_in(place_, name); }
  [[nodiscard]] std::string fault_of(const std::string& name) const {
    try {
      verify(enclave(name));
      return "";
    } catch (const InputError& error) {
      return error.what();
    }
  }
};

TEST_F(KeystoreTest, HasTheFilesOfSros2) {
  keystore_.add("/fleet/robot1");
  for (const char* file :
       {"public/ca.cert.pem", "public/identity_ca.cert.pem", "public/permissions_ca.cert.pem",
        "private/ca.key.pem", "private/identity_ca.key.pem", "private/permissions_ca.key.pem",
        "enclaves/governance.p7s", "enclaves/governance.xml", "enclaves/fleet/robot1/cert.pem",
        "enclaves/fleet/robot1/key.pem", "enclaves/fleet/robot1/governance.p7s",
        "enclaves/fleet/robot1/permissions.p7s", "enclaves/fleet/robot1/permissions.xml",
        "enclaves/fleet/robot1/identity_ca.cert.pem",
        "enclaves/fleet/robot1/permissions_ca.cert.pem"}) {
    EXPECT_TRUE(fs::is_regular_file(place_ / file)) << file;
  }
}

TEST_F(KeystoreTest, StaysGoodWhenItIsMoved) {
  keystore_.add("/fleet/robot1");
  const fs::path moved = folder_.path() / "elsewhere";
  fs::rename(place_, moved);
  EXPECT_NO_THROW(verify(enclave_in(moved, "/fleet/robot1")));
}

TEST_F(KeystoreTest, KeepsPrivateKeysToTheirOwner) {
  keystore_.add("/robot1");
  for (const char* file : {"private/ca.key.pem", "enclaves/robot1/key.pem"}) {
    EXPECT_EQ(fs::status(place_ / file).permissions(),
              fs::perms::owner_read | fs::perms::owner_write)
        << file;
  }
}

TEST_F(KeystoreTest, ListsItsEnclavesInOrderAndNestedOnesToo) {
  for (const char* name : {"/fleet/robot2", "/fleet", "/fleet/robot1", "/a"}) keystore_.add(name);
  EXPECT_THAT(keystore_.enclaves(), ElementsAre("/a", "/fleet", "/fleet/robot1", "/fleet/robot2"));
  for (const std::string& name : keystore_.enclaves()) EXPECT_EQ(fault_of(name), "");
}

TEST_F(KeystoreTest, IsNotMadeOverAnother) {
  EXPECT_THROW((void)Keystore::create(place_), OutputError);
  keystore_.add("/robot1");  // still works
  EXPECT_EQ(fault_of("/robot1"), "");
}

TEST_F(KeystoreTest, KeepsAnEnclaveThatIsThere) {
  keystore_.add("/robot1");
  const std::string before = read_text(enclave("/robot1").certificate());
  EXPECT_THROW(keystore_.add("/robot1"), OutputError);
  EXPECT_EQ(read_text(enclave("/robot1").certificate()), before);
}

TEST_F(KeystoreTest, FinishesAnEnclaveThatWasCutShort) {
  keystore_.add("/robot1");
  fs::remove(enclave("/robot1").certificate());  // what is written last
  EXPECT_THAT(keystore_.enclaves(), ElementsAre());
  keystore_.add("/robot1");
  EXPECT_EQ(fault_of("/robot1"), "");
}

TEST_F(KeystoreTest, RefusesNamesThatAreNone) {
  for (const char* name : {"", "robot1", "/robot 1", "/a/", "//a", "/../a", "/a-b"}) {
    EXPECT_THROW(keystore_.add(name), ConfigError) << name;
  }
  EXPECT_THROW(keystore_.add("/"), ConfigError);
  EXPECT_THROW(keystore_.add("/" + std::string(64, 'x')), ConfigError);
}

TEST_F(KeystoreTest, AllowsWhatItIsToldAndTheGraphOfRos2) {
  keystore_.add("/robot1");
  keystore_.set_permissions("/robot1", {{"rt/map"}, {"rt/scan", "rq/robot1/*Request"}});
  const std::string text = read_text(enclave("/robot1").folder / "permissions.xml");
  EXPECT_THAT(text, HasSubstr("CN=/robot1<"));
  for (const char* topic : {"rt/map", "rt/scan", "rq/robot1/*Request", "ros_discovery_info"}) {
    EXPECT_THAT(text, HasSubstr(std::string("<topic>") + topic + "</topic>"));
  }
  EXPECT_THAT(text, Not(HasSubstr("<topic>*</topic>")));
  EXPECT_EQ(fault_of("/robot1"), "");
}

TEST_F(KeystoreTest, RefusesTopicsThatWouldBreakTheDocument) {
  keystore_.add("/robot1");
  const std::string before = read_text(enclave("/robot1").permissions());
  EXPECT_THROW(keystore_.set_permissions("/robot1", {{"</topic>"}, {}}), ConfigError);
  EXPECT_EQ(read_text(enclave("/robot1").permissions()), before);
  EXPECT_THROW(keystore_.set_permissions("/robot2", all_permissions()), InputError);
}

TEST_F(KeystoreTest, NamesTheFileThatIsAtFault) {
  for (const char* file : {"cert.pem", "key.pem", "permissions.p7s", "governance.p7s",
                           "identity_ca.cert.pem", "permissions_ca.cert.pem"}) {
    const std::string name = "/robot_" + std::string(file).substr(0, std::string(file).find('.'));
    if (fs::exists(enclave(name).folder)) fs::remove_all(enclave(name).folder);
    keystore_.add(name);
    fs::remove(enclave(name).folder / file);
    EXPECT_THAT(fault_of(name), HasSubstr(std::string(file) + ": is missing"));
  }
}

TEST_F(KeystoreTest, NoticesPermissionsThatWereWidenedByHand) {
  keystore_.add("/robot1");
  keystore_.set_permissions("/robot1", {{"rt/map"}, {}});
  std::string text = read_text(enclave("/robot1").permissions());
  text.replace(text.find("rt/map"), 6, "rt/tf*");
  std::ofstream(enclave("/robot1").permissions()) << text;
  EXPECT_THAT(fault_of("/robot1"), HasSubstr("permissions.p7s: is not signed"));
}

TEST_F(KeystoreTest, IsNoKeystoreWithoutItsParts) {
  EXPECT_THROW(Keystore(folder_.path()), InputError);
  EXPECT_THROW(Keystore(folder_.path() / "nowhere"), InputError);
}

TEST_F(KeystoreTest, InAFolderThatIsAFileIsAnErrorThatNamesIt) {
  std::ofstream(folder_.path() / "file") << "x";
  EXPECT_THROW((void)Keystore::create(folder_.path() / "file" / "keystore"), OutputError);
}

}  // namespace
}  // namespace strata::security
