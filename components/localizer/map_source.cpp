// SPDX-License-Identifier: Apache-2.0
#include "components/localizer/map_source.hpp"

#include <utility>

#include "core/base/error.hpp"

namespace fs = std::filesystem;

namespace strata::localizer {
namespace {

/// Files may come after the link to them, where a site is copied from another machine.
constexpr std::chrono::seconds kTriedAgainAfter{5};

/// A site's version must be as it was approved; of other maps the hash is only told.
std::optional<site::MapIdentity> identity_of(const fs::path& folder) {
  if (site::is_version(folder)) return site::identify(folder);
  try {
    return site::identify(folder);
  } catch (const InputError&) {
    return std::nullopt;  // replaced while it was read
  }
}

}  // namespace

LoadedMaps MapSource::load(const fs::path& folder, const Make& make) {
  const auto identity = identity_of(folder);
  LoadedMaps loaded = make(folder);
  loaded.folder = folder;
  loaded.identity = identity;
  return loaded;
}

LoadedMaps MapSource::load() {
  LoadedMaps loaded = load(site::real_maps(named_), make_);
  taken_ = loaded.folder;
  return loaded;
}

bool MapSource::look() {
  if (loading_.valid()) return false;
  fs::path now;
  try {
    now = site::real_maps(named_);
  } catch (const InputError&) {
    return false;  // the maps in use are as good as they were
  }
  if (now == taken_) {
    refused_.clear();
    return true;
  }
  if (now == refused_ && std::chrono::steady_clock::now() - refused_at_ < kTriedAgainAfter)
    return false;
  refused_ = now;  // until it was taken
  loading_ = std::async(std::launch::async, [now, make = make_] { return load(now, make); });
  return false;
}

std::optional<LoadedMaps> MapSource::take() {
  if (!loading_.valid() ||
      loading_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) {
    return std::nullopt;
  }
  refused_at_ = std::chrono::steady_clock::now();
  LoadedMaps loaded = loading_.get();
  taken_ = loaded.folder;
  refused_.clear();
  return loaded;
}

}  // namespace strata::localizer
