// SPDX-License-Identifier: Apache-2.0
#include "tests/structure/source_tree.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <regex>
#include <sstream>

namespace strata::test {

std::filesystem::path source_root() { return STRATA_SOURCE_DIR; }

std::string read_text(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

std::vector<std::string> includes_of(const std::string& text) {
  static const std::regex line(R"re(^[ \t]*#[ \t]*include[ \t]*(?:"([^"]+)"|(<[^>]+>)))re",
                               std::regex::multiline);
  std::vector<std::string> result;
  for (std::sregex_iterator it(text.begin(), text.end(), line); it != std::sregex_iterator();
       ++it) {
    result.push_back((*it)[1].matched ? (*it)[1].str() : (*it)[2].str());
  }
  return result;
}

std::vector<Source> read_sources(const std::vector<std::string>& folders,
                                 const std::vector<std::string>& extensions) {
  std::vector<Source> sources;
  for (const std::string& folder : folders) {
    if (!std::filesystem::exists(source_root() / folder)) continue;
    for (const auto& entry :
         std::filesystem::recursive_directory_iterator(source_root() / folder)) {
      const std::string extension = entry.path().extension().string();
      if (std::find(extensions.begin(), extensions.end(), extension) == extensions.end()) continue;
      Source source;
      source.path = entry.path().lexically_relative(source_root()).generic_string();
      source.text = read_text(entry.path());
      source.includes = includes_of(source.text);
      sources.push_back(std::move(source));
    }
  }
  std::sort(sources.begin(), sources.end(),
            [](const Source& a, const Source& b) { return a.path < b.path; });
  return sources;
}

std::vector<RoomTarget> rooms_of(const std::string& folder, const std::string& text) {
  static const std::regex call(R"(strata_(?:room|component)\(([^)]*)\))");
  std::vector<RoomTarget> rooms;
  for (std::sregex_iterator it(text.begin(), text.end(), call); it != std::sregex_iterator();
       ++it) {
    RoomTarget room;
    room.folder = folder;
    std::istringstream words((*it)[1].str());
    std::string section = "NAME";
    for (std::string word; words >> word;) {
      const bool is_keyword = word == "SOURCES" || word == "LINKS" || word == "PACKAGES" ||
                              word == "HEADERS_OF" || word == "PRIVATE_PACKAGES" ||
                              word == "PUBLIC_HEADERS";
      if (is_keyword) {
        section = word;
      } else if (section == "NAME") {
        room.name = word;
      } else if (section == "LINKS" || section == "HEADERS_OF") {
        room.links.push_back(word);
      }
    }
    // Variables belong to functions that define rooms, not to rooms.
    if (room.name.find('$') == std::string::npos) rooms.push_back(std::move(room));
  }
  return rooms;
}

std::vector<RoomTarget> read_rooms() {
  std::vector<RoomTarget> rooms;
  for (const char* top : {"core", "memory", "components", "tools"}) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(source_root() / top)) {
      if (entry.path().filename() != "CMakeLists.txt") continue;
      const auto folder = entry.path().parent_path().lexically_relative(source_root());
      for (RoomTarget& room : rooms_of(folder.generic_string(), read_text(entry.path()))) {
        rooms.push_back(std::move(room));
      }
    }
  }
  return rooms;
}

}  // namespace strata::test
