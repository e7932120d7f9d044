// SPDX-License-Identifier: Apache-2.0
#include "components/maps/thinned_runs.hpp"

#include <algorithm>
#include <string_view>

#include <nlohmann/json.hpp>

#include "components/log/sha256.hpp"
#include "components/maps/maps_folder.hpp"
#include "core/base/damage.hpp"
#include "memory/store/visit_content.hpp"

namespace strata::maps {
namespace {

constexpr const char* kThinnedKey = "thinned_runs";

}  // namespace

const ThinnedRun* thinned_run(std::span<const ThinnedRun> thinned, int run) {
  const auto found = std::find_if(thinned.begin(), thinned.end(),
                                  [&](const ThinnedRun& one) { return one.run == run; });
  return found == thinned.end() ? nullptr : &*found;
}

std::string visit_hash(std::span<const PosedScan> scans) {
  return visit_hash(std::span<const std::byte>(memory::visit_content(scans)));
}

std::string visit_hash(std::span<const std::byte> content) {
  return log::sha256_of(
      std::string_view(reinterpret_cast<const char*>(content.data()), content.size()));
}

void write_thinned_runs(const std::filesystem::path& dir, std::span<const ThinnedRun> thinned) {
  if (thinned.empty()) return;
  nlohmann::json all = nlohmann::json::array();
  for (const ThinnedRun& one : thinned) all.push_back({one.run, one.visit, one.begin_ns});
  memory::Store store(dir / kStoreFile);
  store.save_text(kThinnedKey, all.dump());
}

std::vector<ThinnedRun> read_thinned_runs(const memory::Store& store) {
  const auto text = store.find_text(kThinnedKey);
  if (!text) return {};
  std::vector<ThinnedRun> thinned;
  try {
    for (const nlohmann::json& one : nlohmann::json::parse(*text)) {
      thinned.push_back(
          {one.at(0).get<int>(), one.at(1).get<std::string>(), one.at(2).get<std::int64_t>()});
    }
  } catch (const nlohmann::json::exception&) {
    throw DamageError(store.path().string(), "its list of runs that lack scans is damaged",
                      "take the store from a backup");
  }
  return thinned;
}

}  // namespace strata::maps
