// SPDX-License-Identifier: Apache-2.0
#include "components/security/openssl_objects.hpp"

#include <array>
#include <cstddef>
#include <new>

#include <openssl/crypto.h>
#include <openssl/err.h>
#include <openssl/pem.h>

#include "core/base/error.hpp"

namespace strata::security {
namespace {

/// OpenSSL tells of what it had no memory for as of an internal error.
void require_memory() {
  constexpr std::size_t kEnoughBytes = std::size_t{1} << 20U;  // more than it asks for at once
  void* room = OPENSSL_malloc(kEnoughBytes);
  if (room == nullptr) throw std::bad_alloc();
  OPENSSL_free(room);
}

}  // namespace

void require_ok(bool ok, const char* step) {
  if (ok) {
    ERR_clear_error();
    return;
  }
  require_memory();
  std::array<char, 256> reason{"no reason given"};
  if (const unsigned long code = ERR_get_error(); code != 0) {
    ERR_error_string_n(code, reason.data(), reason.size());
  }
  ERR_clear_error();
  throw OutputError(step, std::string("OpenSSL failed: ") + reason.data(),
                    "check that its configuration allows EC keys and SHA-256");
}

Bio read_from(const std::string& text) {
  Bio bio(BIO_new_mem_buf(text.data(), static_cast<int>(text.size())));
  require_ok(bio != nullptr, "reading");
  return bio;
}

Bio write_to_memory() {
  Bio bio(BIO_new(BIO_s_mem()));
  require_ok(bio != nullptr, "writing");
  return bio;
}

std::string text_of(const Bio& bio) {
  char* data = nullptr;
  const long size = BIO_get_mem_data(bio.get(), &data);
  return {data, static_cast<std::size_t>(size)};
}

Key parse_key(const std::string& pem, const std::string& place) {
  const Bio bio = read_from(pem);
  // Without a callback a key with a password would be asked for at the terminal.
  pem_password_cb* const no_password = [](char*, int, int, void*) { return 0; };
  Key key(PEM_read_bio_PrivateKey(bio.get(), nullptr, no_password, nullptr));
  ERR_clear_error();
  if (!key) {
    require_memory();
    throw InputError(place, "holds no private key in PEM without a password",
                     "make the enclave again with `strata keystore add`");
  }
  return key;
}

Certificate parse_certificate(const std::string& pem, const std::string& place) {
  const Bio bio = read_from(pem);
  Certificate certificate(PEM_read_bio_X509(bio.get(), nullptr, nullptr, nullptr));
  ERR_clear_error();
  if (!certificate) {
    require_memory();
    throw InputError(place, "holds no certificate in PEM",
                     "make the enclave again with `strata keystore add`");
  }
  return certificate;
}

}  // namespace strata::security
