// SPDX-License-Identifier: Apache-2.0
#include "components/security/documents.hpp"

#include <algorithm>
#include <array>
#include <ctime>
#include <set>
#include <string_view>

#include "core/base/error.hpp"

namespace strata::security {
namespace {

constexpr const char* kGraphTopic = "ros_discovery_info";
// Cyclone DDS refuses a document that names domain 231.
constexpr const char* kDomains =
    "<domains><id_range><min>0</min><max>230</max></id_range></domains>\n";

void require_topic(const std::string& topic) {
  constexpr std::string_view kOthers = "_/~*?[]-";
  const bool is_plain = std::all_of(topic.begin(), topic.end(), [&](unsigned char c) {
    return std::isalnum(c) != 0 || kOthers.find(static_cast<char>(c)) != std::string_view::npos;
  });
  if (is_plain && !topic.empty()) return;
  throw ConfigError("topic '" + topic + "'", "no topic has such a name",
                    "use letters, digits, '_' and '/', and * for any text");
}

std::string time_text(std::time_t time) {
  std::tm parts{};
  gmtime_r(&time, &parts);
  std::array<char, 32> text{};
  std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%S", &parts);
  return text.data();
}

std::string topics_element(const char* verb, const std::vector<std::string>& topics) {
  std::set<std::string> names(topics.begin(), topics.end());
  names.insert(kGraphTopic);
  std::string text = std::string("      <") + verb + ">\n        <topics>\n";
  for (const std::string& name : names) {
    require_topic(name);
    text += "          <topic>" + name + "</topic>\n";
  }
  return text + "        </topics>\n      </" + verb + ">\n";
}

}  // namespace

Permissions all_permissions() { return {{"*"}, {"*"}}; }

std::string governance_document() {
  return std::string(R"(<?xml version="1.0" encoding="UTF-8"?>
<dds xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
    xsi:noNamespaceSchemaLocation="http://www.omg.org/spec/DDS-SECURITY/20170901/omg_shared_ca_governance.xsd">
  <domain_access_rules>
    <domain_rule>
      )") +
         kDomains +
         R"(      <allow_unauthenticated_participants>false</allow_unauthenticated_participants>
      <enable_join_access_control>true</enable_join_access_control>
      <discovery_protection_kind>ENCRYPT</discovery_protection_kind>
      <liveliness_protection_kind>ENCRYPT</liveliness_protection_kind>
      <rtps_protection_kind>SIGN</rtps_protection_kind>
      <topic_access_rules>
        <topic_rule>
          <topic_expression>*</topic_expression>
          <enable_discovery_protection>true</enable_discovery_protection>
          <enable_liveliness_protection>true</enable_liveliness_protection>
          <enable_read_access_control>true</enable_read_access_control>
          <enable_write_access_control>true</enable_write_access_control>
          <metadata_protection_kind>ENCRYPT</metadata_protection_kind>
          <data_protection_kind>ENCRYPT</data_protection_kind>
        </topic_rule>
      </topic_access_rules>
    </domain_rule>
  </domain_access_rules>
</dds>
)";
}

std::string permissions_document(const std::string& common_name, const Permissions& permissions,
                                 int valid_days) {
  constexpr std::time_t kDay_s = 24 * 60 * 60;
  const std::time_t begin = std::time(nullptr) - kDay_s;  // for clocks that are behind
  return R"(<?xml version="1.0" encoding="UTF-8"?>
<dds xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
    xsi:noNamespaceSchemaLocation="http://www.omg.org/spec/DDS-SECURITY/20170901/omg_shared_ca_permissions.xsd">
  <permissions>
  <grant name=")" +
         common_name + "\">\n    <subject_name>CN=" + common_name +
         "</subject_name>\n    <validity>\n      <not_before>" + time_text(begin) +
         "</not_before>\n      <not_after>" + time_text(begin + valid_days * kDay_s) +
         "</not_after>\n    </validity>\n    <allow_rule>\n      " + kDomains +
         topics_element("publish", permissions.publish) +
         topics_element("subscribe", permissions.subscribe) +
         "    </allow_rule>\n    <default>DENY</default>\n  </grant>\n  </permissions>\n</dds>\n";
}

}  // namespace strata::security
