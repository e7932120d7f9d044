// SPDX-License-Identifier: Apache-2.0
/// Which visits lie in folders of maps here, read again only where a folder changed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <vector>

namespace strata::fleet_member {

class LocalVisits {
 public:
  /// maps: to push from. site: whose active version's visits came from the server; may be empty.
  LocalVisits(std::vector<std::filesystem::path> maps, std::filesystem::path site);

  /// Looks at the folders. One that cannot be read stays as it was known. O(beams) of those that
  /// changed.
  void look();
  /// The server has it, or it is part of a version.
  void is_there(const std::string& sha256) { there_.insert(sha256); }
  /// Those that nobody knows to be on the server.
  [[nodiscard]] std::size_t waiting() const;
  /// Whether the folder holds maps, and they are others than when they were last pushed as a whole.
  [[nodiscard]] bool is_to_push(const std::filesystem::path& maps) const;
  /// The folder, as it was at the last look, is on the server as a whole.
  void is_pushed(const std::filesystem::path& maps);
  /// Asks the server again about everything: it may be another one, or an older copy of it.
  void forget_pushed() { pushed_.clear(); }

 private:
  /// Tells a store that was replaced or written to.
  using State = std::tuple<std::uint64_t, std::int64_t, std::uint64_t>;  // inode, time, size
  struct Folder {
    State state;
    std::vector<std::string> hashes;
  };
  [[nodiscard]] static State state_of(const std::filesystem::path& maps);
  void look_at(const std::filesystem::path& maps);

  std::vector<std::filesystem::path> maps_;
  std::filesystem::path active_;
  std::map<std::filesystem::path, Folder> folders_;
  std::map<std::filesystem::path, State> pushed_;
  std::set<std::string> there_;
};

}  // namespace strata::fleet_member
