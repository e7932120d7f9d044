// SPDX-License-Identifier: Apache-2.0
/// Authorities, certificates and signed documents as DDS security wants them: X.509 with EC keys on
/// P-256 and SHA-256, S/MIME with the text in clear.
#pragma once

#include <string>

namespace strata::security {

/// Both in PEM.
struct Identity {
  std::string certificate;
  std::string private_key;
};

/// SROS2's too: ten years.
inline constexpr int kValidDays = 3650;

/// An authority that signs for itself. Throws OutputError when OpenSSL refuses.
[[nodiscard]] Identity make_authority(const std::string& common_name, int valid_days = kValidDays);

/// A certificate of `authority` for `common_name` with a key of its own. Throws InputError for an
/// authority that is none.
[[nodiscard]] Identity issue(const Identity& authority, const std::string& common_name,
                             int valid_days = kValidDays);

/// `document` as multipart/signed S/MIME (RFC 8551) by `authority`.
[[nodiscard]] std::string sign(const Identity& authority, const std::string& document);

/// The text of a signed document. Throws InputError, at `place`, when the signature is not that of
/// `authority_certificate` or the text was changed.
[[nodiscard]] std::string verify_signed(const std::string& smime,
                                        const std::string& authority_certificate,
                                        const std::string& place);

/// Throws InputError, at `place`, unless the certificate is the authority's, valid today, for
/// `private_key` and for `common_name`.
void verify_identity(const Identity& identity, const std::string& authority_certificate,
                     const std::string& common_name, const std::string& place);

}  // namespace strata::security
