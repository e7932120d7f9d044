// SPDX-License-Identifier: Apache-2.0
/// OpenSSL's objects with owners, and its errors as ours; for this room's .cpp files only.
#pragma once

#include <memory>
#include <string>

#include <openssl/bio.h>
#include <openssl/evp.h>
#include <openssl/pkcs7.h>
#include <openssl/x509.h>

namespace strata::security {

/// Calls one of OpenSSL's functions to free.
template <auto kFree>
struct Freed {
  template <typename T>
  void operator()(T* object) const {
    kFree(object);
  }
};

using Bio = std::unique_ptr<BIO, Freed<BIO_free_all>>;
using Key = std::unique_ptr<EVP_PKEY, Freed<EVP_PKEY_free>>;
using Certificate = std::unique_ptr<X509, Freed<X509_free>>;
using CertificateStore = std::unique_ptr<X509_STORE, Freed<X509_STORE_free>>;
using StoreContext = std::unique_ptr<X509_STORE_CTX, Freed<X509_STORE_CTX_free>>;
using Extension = std::unique_ptr<X509_EXTENSION, Freed<X509_EXTENSION_free>>;
using Pkcs7 = std::unique_ptr<PKCS7, Freed<PKCS7_free>>;

/// Throws OutputError with OpenSSL's own words unless `ok`. step: what was being done.
void require_ok(bool ok, const char* step);

/// A reader of `text`, which must outlive it.
[[nodiscard]] Bio read_from(const std::string& text);
[[nodiscard]] Bio write_to_memory();
[[nodiscard]] std::string text_of(const Bio& bio);

/// From PEM; throw InputError, at `place`.
[[nodiscard]] Key parse_key(const std::string& pem, const std::string& place);
[[nodiscard]] Certificate parse_certificate(const std::string& pem, const std::string& place);

}  // namespace strata::security
