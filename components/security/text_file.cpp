// SPDX-License-Identifier: Apache-2.0
#include "components/security/text_file.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/base/error.hpp"

namespace strata::security {
namespace {

constexpr std::uintmax_t kLargest_bytes = 1U << 20U;

bool write_all(int file, const std::string& text) {
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t written = ::write(file, text.data() + done, text.size() - done);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    done += static_cast<std::size_t>(written);
  }
  return ::fsync(file) == 0;
}

}  // namespace

std::string read_text(const std::filesystem::path& file) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  if (error) {
    throw InputError(file.string(), "is missing",
                     "make the enclave with `strata keystore add KEYSTORE ENCLAVE`");
  }
  if (size > kLargest_bytes) {
    throw InputError(file.string(), "is too long for what it should be", "check the keystore");
  }
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  if (!in) throw InputError(file.string(), "cannot be read", "check who may read it");
  return text.str();
}

void write_text(const std::filesystem::path& file, const std::string& text, bool is_secret) {
  const std::filesystem::path partial = file.string() + ".partial";
  ::unlink(partial.c_str());
  const mode_t mode = is_secret ? 0600 : 0644;
  const int out = ::open(partial.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode);
  const bool is_written = out >= 0 && write_all(out, text);
  const int reason = errno;
  if (out >= 0) ::close(out);
  if (is_written && ::rename(partial.c_str(), file.c_str()) == 0) return;
  const std::string why = std::strerror(is_written ? errno : reason);
  ::unlink(partial.c_str());
  throw OutputError(file.string(), "cannot be written: " + why,
                    "free some space or choose a folder you may write to");
}

}  // namespace strata::security
