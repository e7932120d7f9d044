// SPDX-License-Identifier: Apache-2.0
#include "tools/shards/fingerprint.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <memory>
#include <vector>

#include <openssl/evp.h>

#include "core/base/error.hpp"

namespace fs = std::filesystem;

namespace strata::shards {
namespace {

class Sha256 {
 public:
  Sha256() : context_(EVP_MD_CTX_new(), EVP_MD_CTX_free) {
    EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr);
  }
  void add(const void* bytes, std::size_t size) { EVP_DigestUpdate(context_.get(), bytes, size); }
  /// With its length, so that where one text ends and the next begins counts too.
  void add(const std::string& text) {
    const std::string size = std::to_string(text.size()) + ":";
    add(size.data(), size.size());
    add(text.data(), text.size());
  }
  [[nodiscard]] std::string hexadecimal() {
    std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
    unsigned size = 0;
    EVP_DigestFinal_ex(context_.get(), digest.data(), &size);
    constexpr const char* kDigits = "0123456789abcdef";
    std::string text;
    for (unsigned i = 0; i < size; ++i) {
      text += kDigits[digest[i] >> 4U];
      text += kDigits[digest[i] & 15U];
    }
    return text;
  }

 private:
  std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context_;
};

void add_file(const fs::path& path, Sha256& sum) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw InputError(path.string(), "cannot be read", "check the name and its rights");
  std::vector<char> block(std::size_t{1} << 20U);
  while (in) {
    in.read(block.data(), static_cast<std::streamsize>(block.size()));
    sum.add(block.data(), static_cast<std::size_t>(in.gcount()));
  }
  if (in.bad()) throw InputError(path.string(), "cannot be read to its end", "check the disk");
}

}  // namespace

std::string fingerprint(const fs::path& path) {
  Sha256 sum;
  std::error_code error;
  if (!fs::is_directory(path, error)) {
    add_file(path, sum);
    return sum.hexadecimal();
  }
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(path)) {
    if (entry.is_regular_file()) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files) {
    sum.add(file.lexically_relative(path).generic_string());
    sum.add(fingerprint(file));
  }
  return sum.hexadecimal();
}

std::string fingerprint_of_program() { return fingerprint("/proc/self/exe"); }

}  // namespace strata::shards
