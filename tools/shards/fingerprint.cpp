// SPDX-License-Identifier: Apache-2.0
#include "tools/shards/fingerprint.hpp"

#include <algorithm>
#include <fstream>
#include <string>
#include <vector>

#include "components/log/sha256.hpp"
#include "core/base/error.hpp"

namespace fs = std::filesystem;

namespace strata::shards {
namespace {

/// With its length, so that where one text ends and the next begins counts too.
void add_text(const std::string& text, log::Sha256& sum) {
  sum.add(std::to_string(text.size()) + ":");
  sum.add(text);
}

void add_file(const fs::path& path, log::Sha256& sum) {
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
  log::Sha256 sum;
  std::error_code error;
  if (!fs::is_directory(path, error)) {
    add_file(path, sum);
    return sum.hex();
  }
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(path)) {
    if (entry.is_regular_file()) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files) {
    add_text(file.lexically_relative(path).generic_string(), sum);
    add_text(fingerprint(file), sum);
  }
  return sum.hex();
}

std::string fingerprint_of_program() { return fingerprint("/proc/self/exe"); }

}  // namespace strata::shards
