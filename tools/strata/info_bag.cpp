// SPDX-License-Identifier: Apache-2.0
/// `strata info` of a bag that is no log of scans: its topics.
#include "tools/strata/info_bag.hpp"

#include <algorithm>
#include <iostream>
#include <map>

#include <nlohmann/json.hpp>

#include "components/log/bag.hpp"
#include "components/log/json_text.hpp"
#include "tools/report/plot.hpp"

namespace strata::tools {
namespace {

using Json = nlohmann::ordered_json;
using report::fixed;

struct BagContent {
  std::map<std::string, std::size_t> counts;  ///< by topic
  std::map<std::string, std::string> types;
  std::size_t messages = 0;
  Stamp begin;
  Stamp end;
  [[nodiscard]] double duration_s() const { return (end - begin).seconds(); }
};

BagContent count_messages(log::BagReader& reader) {
  BagContent content;
  log::BagMessage message;
  while (reader.next(message)) {
    if (content.messages++ == 0) content.begin = content.end = message.stamp;
    content.begin = std::min(content.begin, message.stamp);
    content.end = std::max(content.end, message.stamp);
    ++content.counts[reader.topics()[message.topic].name];
  }
  for (const log::BagTopic& topic : reader.topics()) {
    content.counts.try_emplace(topic.name, 0);
    content.types[topic.name] = topic.type;
  }
  return content;
}

Json describe(const std::string& path, const std::string& format, const std::string& why,
              const log::BagReader& reader, const BagContent& content) {
  Json info;
  info["log"] = path;
  info["format"] = format;
  info["storage"] = reader.description();
  info["begin_s"] = content.begin.seconds();
  info["end_s"] = content.end.seconds();
  info["duration_s"] = content.duration_s();
  info["path_m"] = nullptr;
  info["scans"] = nullptr;
  info["messages"] = Json::object();
  for (const auto& [name, count] : content.counts) {
    Json entry{{"count", count}, {"type", content.types.at(name)}};
    const double duration_s = content.duration_s();
    entry["rate_hz"] =
        duration_s > 0.0 ? Json(static_cast<double>(count) / duration_s) : Json(nullptr);
    info["messages"][name] = entry;
  }
  info["bad"] = {{"count", reader.damage().count}, {"first", reader.damage().first}};
  info["warnings"] = {why};
  return info;
}

void print(const Json& info) {
  std::cout << info["log"].get<std::string>() << ": " << info["format"].get<std::string>() << " ("
            << info["storage"].get<std::string>() << ")\n  duration   "
            << fixed(info["duration_s"], 1) << " s\n  messages\n";
  for (const auto& [name, entry] : info["messages"].items()) {
    std::cout << "    " << name << " " << entry["count"];
    if (!entry["rate_hz"].is_null()) std::cout << ", " << fixed(entry["rate_hz"], 2) << " Hz";
    std::cout << ", " << entry["type"].get<std::string>() << "\n";
  }
  if (info["bad"]["count"] != 0) {
    std::cout << "  unreadable " << info["bad"]["count"]
              << ", first: " << info["bad"]["first"].get<std::string>() << "\n";
  }
  std::cout << "  note       not read as a log of scans: " << info["warnings"][0].get<std::string>()
            << "\n";
}

}  // namespace

bool print_bag(const std::filesystem::path& path, const std::string& format, const std::string& why,
               bool json) {
  const auto reader = log::BagReader::open(path);
  const BagContent content = count_messages(*reader);
  if (content.messages == 0) return false;
  const Json info = describe(path.string(), format, why, *reader, content);
  if (json) {
    std::cout << log::json_text(info);
  } else {
    print(info);
  }
  return true;
}

}  // namespace strata::tools
