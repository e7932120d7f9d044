// SPDX-License-Identifier: Apache-2.0
#include "components/security/certificate.hpp"

#include <array>

#include <openssl/ec.h>
#include <openssl/err.h>
#include <openssl/pem.h>
#include <openssl/rand.h>
#include <openssl/x509v3.h>

#include "components/security/openssl_objects.hpp"
#include "core/base/error.hpp"

namespace strata::security {
namespace {

constexpr long kSecondsPerDay = 24L * 60L * 60L;
constexpr const char* kMakeAgain = "make the enclave again with `strata keystore add`";

Key make_key() {
  Key key(EVP_EC_gen("P-256"));
  require_ok(key != nullptr, "making a key");
  return key;
}

std::string to_pem(const Key& key) {
  const Bio bio = write_to_memory();
  require_ok(PEM_write_bio_PrivateKey(bio.get(), key.get(), nullptr, nullptr, 0, nullptr, nullptr),
             "writing a key");
  return text_of(bio);
}

std::string to_pem(const Certificate& certificate) {
  const Bio bio = write_to_memory();
  require_ok(PEM_write_bio_X509(bio.get(), certificate.get()), "writing a certificate");
  return text_of(bio);
}

void set_random_serial(X509* certificate) {
  std::array<unsigned char, 16> bytes{};
  require_ok(RAND_bytes(bytes.data(), static_cast<int>(bytes.size())) == 1, "a serial number");
  bytes[0] = static_cast<unsigned char>((bytes[0] & 0x7FU) | 0x40U);  // positive, full length
  const std::unique_ptr<BIGNUM, Freed<BN_free>> number(
      BN_bin2bn(bytes.data(), static_cast<int>(bytes.size()), nullptr));
  require_ok(number && BN_to_ASN1_INTEGER(number.get(), X509_get_serialNumber(certificate)),
             "a serial number");
}

void set_authority_flag(X509* certificate, bool is_authority) {
  const char* value = is_authority ? "critical,CA:TRUE,pathlen:1" : "critical,CA:FALSE";
  const Extension extension(X509V3_EXT_conf_nid(nullptr, nullptr, NID_basic_constraints, value));
  require_ok(extension && X509_add_ext(certificate, extension.get(), -1) == 1, "basic constraints");
}

void set_common_name(X509_NAME* subject, const std::string& name) {
  const auto* bytes = reinterpret_cast<const unsigned char*>(name.data());
  require_ok(X509_NAME_add_entry_by_txt(subject, "CN", MBSTRING_UTF8, bytes,
                                        static_cast<int>(name.size()), -1, 0) == 1,
             "a certificate's name (64 characters at most)");
}

/// issuer: null: its own.
Certificate make_certificate(const Key& key, const std::string& common_name, int valid_days,
                             const X509* issuer, const Key& issuer_key) {
  Certificate certificate(X509_new());
  require_ok(certificate != nullptr, "making a certificate");
  X509* x509 = certificate.get();
  require_ok(X509_set_version(x509, X509_VERSION_3) == 1, "making a certificate");
  set_random_serial(x509);
  // A day earlier, for robots whose clock is behind.
  X509_gmtime_adj(X509_getm_notBefore(x509), -kSecondsPerDay);
  X509_gmtime_adj(X509_getm_notAfter(x509), valid_days * kSecondsPerDay);
  set_common_name(X509_get_subject_name(x509), common_name);
  const X509_NAME* issuer_name =
      issuer != nullptr ? X509_get_subject_name(issuer) : X509_get_subject_name(x509);
  require_ok(X509_set_issuer_name(x509, issuer_name) == 1 && X509_set_pubkey(x509, key.get()) == 1,
             "making a certificate");
  set_authority_flag(x509, issuer == nullptr);
  require_ok(X509_sign(x509, issuer_key.get(), EVP_sha256()) > 0, "signing a certificate");
  return certificate;
}

std::string common_name_of(const Certificate& certificate) {
  X509_NAME* subject = X509_get_subject_name(certificate.get());
  const int index = X509_NAME_get_index_by_NID(subject, NID_commonName, -1);
  if (index < 0) return {};
  const ASN1_STRING* value = X509_NAME_ENTRY_get_data(X509_NAME_get_entry(subject, index));
  return {reinterpret_cast<const char*>(ASN1_STRING_get0_data(value)),
          static_cast<std::size_t>(ASN1_STRING_length(value))};
}

CertificateStore store_of(const Certificate& authority) {
  CertificateStore store(X509_STORE_new());
  require_ok(store && X509_STORE_add_cert(store.get(), authority.get()) == 1,
             "reading an authority");
  return store;
}

}  // namespace

Identity make_authority(const std::string& common_name, int valid_days) {
  const Key key = make_key();
  return {to_pem(make_certificate(key, common_name, valid_days, nullptr, key)), to_pem(key)};
}

Identity issue(const Identity& authority, const std::string& common_name, int valid_days) {
  const Certificate issuer = parse_certificate(authority.certificate, "the authority");
  const Key issuer_key = parse_key(authority.private_key, "the authority");
  const Key key = make_key();
  return {to_pem(make_certificate(key, common_name, valid_days, issuer.get(), issuer_key)),
          to_pem(key)};
}

std::string sign(const Identity& authority, const std::string& document) {
  const Certificate signer = parse_certificate(authority.certificate, "the authority");
  const Key key = parse_key(authority.private_key, "the authority");
  const Bio in = read_from(document);
  constexpr int kFlags = PKCS7_TEXT | PKCS7_DETACHED;
  const Pkcs7 signature(PKCS7_sign(signer.get(), key.get(), nullptr, in.get(), kFlags));
  require_ok(signature != nullptr, "signing a document");
  // Signing has read it to its end.
  const Bio again = read_from(document);
  const Bio out = write_to_memory();
  require_ok(SMIME_write_PKCS7(out.get(), signature.get(), again.get(), kFlags) == 1,
             "signing a document");
  return text_of(out);
}

std::string verify_signed(const std::string& smime, const std::string& authority_certificate,
                          const std::string& place) {
  const Certificate authority = parse_certificate(authority_certificate, "the authority");
  const CertificateStore store = store_of(authority);
  const Bio in = read_from(smime);
  BIO* content = nullptr;
  const Pkcs7 signature(SMIME_read_PKCS7(in.get(), &content));
  const Bio owner(content);
  const Bio out = write_to_memory();
  const bool is_good = signature && PKCS7_verify(signature.get(), nullptr, store.get(), content,
                                                 out.get(), PKCS7_TEXT) == 1;
  ERR_clear_error();
  if (!is_good) {
    throw InputError(place, "is not signed by the keystore's authority, or was changed afterwards",
                     "sign it again with `strata keystore permissions`");
  }
  return text_of(out);
}

void verify_identity(const Identity& identity, const std::string& authority_certificate,
                     const std::string& common_name, const std::string& place) {
  const Certificate authority = parse_certificate(authority_certificate, "the authority");
  const Certificate certificate = parse_certificate(identity.certificate, place);
  const Key key = parse_key(identity.private_key, place);
  const CertificateStore store = store_of(authority);
  const StoreContext context(X509_STORE_CTX_new());
  require_ok(
      context && X509_STORE_CTX_init(context.get(), store.get(), certificate.get(), nullptr) == 1,
      "checking a certificate");
  const bool is_trusted = X509_verify_cert(context.get()) == 1;
  ERR_clear_error();
  if (!is_trusted) {
    const int error = X509_STORE_CTX_get_error(context.get());
    throw InputError(place, std::string("is not trusted: ") + X509_verify_cert_error_string(error),
                     kMakeAgain);
  }
  const bool is_its_key = X509_check_private_key(certificate.get(), key.get()) == 1;
  ERR_clear_error();
  if (!is_its_key) throw InputError(place, "does not belong to the private key", kMakeAgain);
  if (const std::string name = common_name_of(certificate); name != common_name) {
    throw InputError(place, "is for '" + name + "', not for '" + common_name + "'", kMakeAgain);
  }
}

}  // namespace strata::security
