// SPDX-License-Identifier: Apache-2.0
/// Whom a certificate convinces, and whom not. That other makers' DDS read them too is tested with
/// the bus and with Cyclone DDS.
#include "components/security/certificate.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/error.hpp"

namespace strata::security {
namespace {

using testing::HasSubstr;

std::string fault_of(const Identity& identity, const Identity& authority, const std::string& name) {
  try {
    verify_identity(identity, authority.certificate, name, "cert.pem");
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

class CertificateTest : public testing::Test {
 protected:
  const Identity authority_ = make_authority("buildingCA");
  const Identity robot_ = issue(authority_, "/robot1");
};

TEST_F(CertificateTest, ConvincesWhoTrustsItsAuthority) {
  EXPECT_EQ(fault_of(robot_, authority_, "/robot1"), "");
}

TEST_F(CertificateTest, OfAnotherAuthorityOfTheSameNameIsNotTrusted) {
  EXPECT_THAT(fault_of(robot_, make_authority("buildingCA"), "/robot1"), HasSubstr("not trusted"));
}

TEST_F(CertificateTest, ThatHasExpiredIsNotTrustedAndSaysSo) {
  EXPECT_THAT(fault_of(issue(authority_, "/robot1", -1), authority_, "/robot1"),
              HasSubstr("expired"));
}

TEST_F(CertificateTest, OfAnotherNameIsNotThisOnes) {
  EXPECT_THAT(fault_of(robot_, authority_, "/robot2"), HasSubstr("is for '/robot1'"));
}

TEST_F(CertificateTest, WithTheKeyOfAnotherIsRefused) {
  const Identity mixed{robot_.certificate, issue(authority_, "/robot1").private_key};
  EXPECT_THAT(fault_of(mixed, authority_, "/robot1"), HasSubstr("does not belong"));
}

TEST_F(CertificateTest, CannotSignForOthersThoughItsAuthorityCan) {
  const Identity forged = issue(robot_, "/robot2");
  EXPECT_THAT(fault_of(forged, authority_, "/robot2"), HasSubstr("not trusted"));
}

TEST_F(CertificateTest, ThatIsNoneNamesThePlace) {
  for (const char* text : {"", "nonsense", "-----BEGIN CERTIFICATE-----\nAAAA\n"}) {
    EXPECT_THAT(fault_of({text, robot_.private_key}, authority_, "/robot1"),
                HasSubstr("cert.pem: holds no certificate"));
    EXPECT_THAT(fault_of({robot_.certificate, text}, authority_, "/robot1"),
                HasSubstr("holds no private key"));
  }
}

TEST_F(CertificateTest, OfANameThatIsTooLongIsRefused) {
  EXPECT_THROW((void)issue(authority_, "/" + std::string(64, 'x')), OutputError);
}

TEST_F(CertificateTest, SerialNumbersDiffer) {
  EXPECT_NE(issue(authority_, "/robot1").certificate, robot_.certificate);
}

class SignedDocument : public CertificateTest {
 protected:
  const std::string document_ = "<dds>\n  <permissions/>\n</dds>\n";
  const std::string signed_ = sign(authority_, document_);
};

TEST_F(SignedDocument, GivesItsTextBackWithTheLineEndsOfMail) {
  std::string text = verify_signed(signed_, authority_.certificate, "permissions.p7s");
  text.erase(std::remove(text.begin(), text.end(), '\r'), text.end());
  EXPECT_EQ(text, document_);
}

TEST_F(SignedDocument, HasItsTextInClear) { EXPECT_THAT(signed_, HasSubstr("<permissions/>")); }

TEST_F(SignedDocument, ThatWasChangedIsRefused) {
  std::string changed = signed_;
  changed.replace(changed.find("<permissions/>"), 14, "<everything />");
  EXPECT_THROW((void)verify_signed(changed, authority_.certificate, "permissions.p7s"), InputError);
}

TEST_F(SignedDocument, OfAnotherAuthorityIsRefused) {
  const Identity other = make_authority("buildingCA");
  EXPECT_THROW((void)verify_signed(signed_, other.certificate, "permissions.p7s"), InputError);
}

TEST_F(SignedDocument, CutAnywhereIsRefused) {
  // The last hundred bytes are the boundary's end, which readers may do without.
  for (std::size_t length = 0; length + 100 < signed_.size(); length += 37) {
    EXPECT_THROW(
        (void)verify_signed(signed_.substr(0, length), authority_.certificate, "permissions.p7s"),
        InputError)
        << length;
  }
}

}  // namespace
}  // namespace strata::security
