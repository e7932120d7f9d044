// SPDX-License-Identifier: Apache-2.0
#include "components/log/kept_file.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>

#include "components/log/byte_cursor.hpp"
#include "components/log/compression.hpp"
#include "core/base/error.hpp"

namespace strata::log {
namespace {

/// More than a compressed block, whose first bytes tell whose state it is.
constexpr std::size_t kBeginBytes = 1 << 18;

/// The upper half of the first number of a saved state; the lower one is its version.
struct StateOf {
  std::uint32_t tag;
  std::string_view words;
};
constexpr std::array<StateOf, 3> kStates{{{0x53'53'4c'4d, kStateOfScanMatcher},
                                          {0x53'4f'42'46, kStateOfBeamFilter},
                                          {0x53'50'4c'31, kStateOfPatchLearner}}};

std::string begin_of(const std::filesystem::path& file) {
  std::string bytes(kBeginBytes, '\0');
  std::ifstream in(file, std::ios::binary);
  in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(in.gcount()));
  return bytes;
}

std::string state_in_words(const std::string& begin) {
  const View packed(reinterpret_cast<const std::uint8_t*>(begin.data()), begin.size());
  std::string ends_early;  // as it must: the rest is not looked at
  const Bytes state = decompress(packed, BagCompression::kZstd, sizeof(std::uint64_t), ends_early);
  ByteCursor cursor{View(state)};
  const auto version = cursor.number<std::uint32_t>();
  const auto tag = cursor.number<std::uint32_t>();
  const auto* const found = std::find_if(
      kStates.begin(), kStates.end(), [&](const StateOf& state_of) { return state_of.tag == tag; });
  if (!cursor.ok() || found == kStates.end()) return "";
  return std::string(found->words) + ", version " + std::to_string(version);
}

}  // namespace

std::string kept_in_words(const std::filesystem::path& file) {
  const std::string begin = begin_of(file);
  if (begin.starts_with("\x28\xb5\x2f\xfd")) return state_in_words(begin);
  if (begin.starts_with("version: 1\nmap_from_robot:")) return std::string(kLastPose);
  if (begin.starts_with("# Octomap OcTree")) return std::string(kOctree);
  if (begin.starts_with(std::string_view("SQLite format 3\0", 16))) return std::string(kDatabase);
  return "";
}

void require_own_file(const std::filesystem::path& file, std::string_view own,
                      const std::string& setting) {
  const std::string what = kept_in_words(file);
  if (what.empty() || what.starts_with(own)) return;
  throw ConfigError(file.string(),
                    "is another file than " + setting + " may name: this is the " + what +
                        "; it is to be the " + std::string(own),
                    "name another file in " + setting + "; this one was left as it is");
}

}  // namespace strata::log
