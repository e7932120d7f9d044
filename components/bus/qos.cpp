// SPDX-License-Identifier: Apache-2.0
#include "components/bus/qos.hpp"

#include "core/base/error.hpp"

namespace strata::bus {
namespace {

const std::vector<QosProfile>& profiles() {
  static const std::vector<QosProfile> kProfiles = {
      {"default", true, false, 10},      {"sensor_data", false, false, 5},
      {"latched", true, true, 1},        {"tf", true, false, 100},
      {"tf_static", true, true, 100},    {"clock", false, false, 1},
      {"parameters", true, false, 1000}, {"rosout", true, true, 1000, false, 10.0},
      {"lossless", true, false, 0}};
  return kProfiles;
}

}  // namespace

QosProfile QosProfile::lossless() const {
  QosProfile result = *this;
  result.reliable = true;
  result.transient_local = false;
  result.depth = 0;
  result.lifespan_s = 0.0;
  return result;
}

QosProfile qos_profile(std::string_view name) {
  std::string known;
  for (const QosProfile& profile : profiles()) {
    if (profile.name == name) return profile;
    known += (known.empty() ? "" : ", ") + profile.name;
  }
  throw ConfigError("qos", "unknown profile '" + std::string(name) + "'", "use one of " + known);
}

std::vector<std::string> qos_profile_names() {
  std::vector<std::string> names;
  for (const QosProfile& profile : profiles()) names.push_back(profile.name);
  return names;
}

}  // namespace strata::bus
