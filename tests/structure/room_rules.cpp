// SPDX-License-Identifier: Apache-2.0
#include "tests/structure/room_rules.hpp"

#include <algorithm>
#include <map>
#include <regex>

namespace strata::test {
namespace {

bool starts_with(const std::string& text, const std::string& prefix) {
  return text.compare(0, prefix.size(), prefix) == 0;
}

/// The arrows as the page draws them: room -> rooms it may include directly.
const std::map<std::string, std::vector<std::string>>& arrows() {
  static const std::map<std::string, std::vector<std::string>> table{
      {"core/base", {}},
      {"core/random", {"core/base"}},
      {"core/periodic", {"core/base"}},
      {"core/geometry", {"core/base"}},
      {"core/scan", {"core/random", "core/geometry"}},
      {"core/grid", {"core/scan"}},
      {"core/plan", {"core/grid"}},
      {"core/rays", {"core/grid"}},
      {"core/registration", {"core/grid"}},
      {"core/tracking", {"core/registration"}},
      {"core/beam_filter", {"core/grid"}},
      {"core/patch", {"core/beam_filter", "core/periodic"}},
      {"core/localization", {"core/patch", "core/rays", "core/tracking"}},
      {"core/patch_beams", {"core/localization"}},
      {"core/cells", {"core/localization"}},
      {"core/refinement", {"core/localization"}},
      {"core/pose_graph", {"core/geometry"}},
      {"core/topology", {"core/slam"}},
      {"core/slam", {"core/beam_filter", "core/pose_graph", "core/tracking"}},
      {"core/volume", {"core/grid"}},
      {"memory/levels", {"core/scan"}},
      {"memory/decoding", {"memory/levels"}},
      {"memory/nodes", {"memory/decoding", "core/grid"}},
      {"memory/store", {"memory/nodes", "core/patch"}},
      {"components/settings", {"core"}},
      {"components/convert", {"core", "memory", "idl"}},
      {"components/log", {"components/convert"}},
      {"components/clouds", {"components/log"}},
      {"components/maps", {"core", "memory", "components/log", "components/settings"}},
      {"components/site", {"components/maps"}},
      {"components/fleet", {"components/site"}},
      {"components/topologies", {"components/maps"}},
      {"components/security", {"core"}},
      {"components/bus", {"core/base", "components/convert", "components/security"}},
      {"components/runtime",
       {"components/bus", "components/clouds", "components/maps", "components/site",
        "components/topologies"}},
      // Any other component knows the runtime alone.
      {"components/fleet_member", {"components/runtime", "components/fleet"}},
  };
  return table;
}

bool is_or_is_below(const std::string& room, const std::string& group) {
  return room == group || starts_with(room, group + "/");
}

/// "core_grid" -> "core/grid"; "log" -> "components/log"; "idl" -> "idl".
std::string target_to_room(const std::string& target, const std::vector<RoomTarget>& rooms) {
  if (starts_with(target, "idl")) return "idl";
  for (const RoomTarget& room : rooms) {
    if (room.name == target) return room_of(room.folder + "/CMakeLists.txt");
  }
  return "";
}

struct Ban {
  const char* pattern;
  const char* what;
};

void add_matches(const std::string& text, const std::vector<Ban>& bans, const std::string& path,
                 std::vector<std::string>& faults) {
  for (const Ban& ban : bans) {
    std::smatch match;
    if (std::regex_search(text, match, std::regex(ban.pattern))) {
      faults.push_back(path + ": " + match.str() + ": " + ban.what);
    }
  }
}

}  // namespace

std::string room_of(const std::string& path) {
  if (starts_with(path, "strata_idl/") || starts_with(path, "idl/")) return "idl";
  for (const char* top : {"core/", "memory/", "components/", "tools/", "tests/"}) {
    if (!starts_with(path, top)) continue;
    const std::size_t end = path.find('/', std::string(top).size());
    return end == std::string::npos ? std::string(top, std::string(top).size() - 1)
                                    : path.substr(0, end);
  }
  return "";
}

bool may_include(const std::string& from, const std::string& to) {
  if (from == to || to.empty() || is_or_is_below(from, "tests")) return true;
  if (is_or_is_below(to, "tests")) return false;
  // The product does without the laboratory, but for `compare --peers`, which CMake leaves out.
  if (to == "tools/laboratory") return from == "tools/strata";
  if (is_or_is_below(from, "tools")) return true;
  if (is_or_is_below(to, "tools")) return false;
  const auto& table = arrows();
  auto found = table.find(from);
  // Any other folder of components is one component.
  static const std::vector<std::string> component{"components/runtime"};
  const bool is_component = found == table.end() && is_or_is_below(from, "components");
  if (found == table.end() && !is_component) return false;
  const std::vector<std::string>& direct = is_component ? component : found->second;
  return std::any_of(direct.begin(), direct.end(), [&](const std::string& room) {
    return is_or_is_below(to, room) || (table.count(room) != 0 && may_include(room, to));
  });
}

std::vector<std::string> faults_of(const Source& source) {
  std::vector<std::string> faults;
  const std::string room = room_of(source.path);
  const bool is_quiet = is_or_is_below(room, "core") || is_or_is_below(room, "memory");
  const bool is_header = source.path.find(".hpp") != std::string::npos;
  static const std::vector<Ban> quiet{
      {"fastdds|fastrtps|fastcdr|strata_idl", "core and memory know no DDS"},
      {"yaml-cpp", "core and memory know no YAML"},
      {"<(iostream|ostream|print|spdlog/|fmt/|CLI/)", "core and memory print nothing"},
      {"<(chrono|ctime|time\\.h|sys/time\\.h)>", "core and memory have no clock"},
      {"<random>", "random numbers come from core/random"}};
  static const std::vector<Ban> files{
      {"<(fstream|filesystem|cstdio|stdio\\.h|unistd\\.h|fcntl\\.h|sqlite3\\.h)>",
       "only memory/store touches files"}};
  static const std::vector<Ban> headers{
      {"<(ceres|octomap|hwy)/", "stays in .cpp files, out of headers"}};
  for (const std::string& include : source.includes) {
    const std::string to = room_of(include);
    if (!to.empty() && !may_include(room, to)) {
      faults.push_back(source.path + ": " + include + ": the arrow points the other way");
    }
    if (is_quiet) add_matches(include, quiet, source.path, faults);
    if (is_quiet && room != "memory/store") add_matches(include, files, source.path, faults);
    if (is_header && is_or_is_below(room, "core")) {
      add_matches(include, headers, source.path, faults);
    }
  }
  static const std::vector<Ban> words{
      {"std::[a-z_]+_distribution|random_device", "random numbers come from core/random"},
      {"_clock::now|std::cout|std::cerr|std::printf",
       "core and memory have no clock and no voice"}};
  if (is_quiet) add_matches(source.text, words, source.path, faults);
  return faults;
}

std::vector<std::string> link_faults(const std::vector<RoomTarget>& rooms) {
  std::vector<std::string> faults;
  for (const RoomTarget& room : rooms) {
    const std::string from = room_of(room.folder + "/CMakeLists.txt");
    if (from.empty()) continue;
    for (const std::string& link : room.links) {
      const std::string to = target_to_room(link, rooms);
      if (to.empty()) {
        faults.push_back(room.folder + ": links " + link + ", which is no room");
      } else if (!may_include(from, to)) {
        faults.push_back(room.folder + ": links " + link + ", which it may not include");
      }
    }
  }
  return faults;
}

std::vector<std::string> unlinked_includes(const std::vector<Source>& sources,
                                           const std::vector<RoomTarget>& rooms) {
  // Rooms reachable from the targets of each room; LINKS are public, so they carry on.
  std::map<std::string, std::set<std::string>> linked;
  for (const RoomTarget& room : rooms) {
    auto& set = linked[room_of(room.folder + "/CMakeLists.txt")];
    for (const std::string& link : room.links) set.insert(target_to_room(link, rooms));
  }
  for (bool changed = true; changed;) {
    changed = false;
    for (auto& [room, set] : linked) {
      const std::set<std::string> before = set;
      for (const std::string& next : before) {
        const auto found = linked.find(next);
        if (found != linked.end()) set.insert(found->second.begin(), found->second.end());
      }
      changed = changed || set.size() != before.size();
    }
  }
  std::vector<std::string> faults;
  for (const Source& source : sources) {
    const std::string from = room_of(source.path);
    for (const std::string& include : source.includes) {
      const std::string to = room_of(include);
      if (to.empty() || to == from || linked[from].count(to) != 0) continue;
      faults.push_back(source.path + ": includes " + include + ", but " + from +
                       "/CMakeLists.txt links no " + to);
    }
  }
  return faults;
}

}  // namespace strata::test
