// SPDX-License-Identifier: Apache-2.0
#include "components/log/whole_folder.hpp"

#include <string>
#include <system_error>

#include "components/log/folder_name.hpp"
#include "core/base/error.hpp"

namespace fs = std::filesystem;

namespace strata::log {

WholeFolder::WholeFolder(const fs::path& folder, const Disk& disk, Existing existing)
    : disk_(disk), folder_(without_slash(fs::weakly_canonical(fs::absolute(folder)))) {
  put_back(disk_, folder_);
  std::error_code error;
  const bool may_hold = existing == Existing::kReplace;
  if (fs::exists(folder_, error) &&
      (!fs::is_directory(folder_) || (!may_hold && !fs::is_empty(folder_)))) {
    throw OutputError(folder.string(), "exists already", "choose another name or remove it");
  }
  remove_left_over(folder_);
  aside_ = staged_name(folder_);
  fs::remove_all(aside_, error);
}

WholeFolder::~WholeFolder() {
  std::error_code ignored;
  if (!committed_) fs::remove_all(aside_, ignored);
}

/// Not what SQLite keeps beside a database that the new folder has: it belongs to the old one.
void WholeFolder::take_over_others() const {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder_)) {
    const std::string name = entry.path().filename().string();
    const bool is_beside = name.ends_with("-wal") || name.ends_with("-shm");
    if (is_beside || fs::exists(aside_ / name)) continue;
    constexpr auto kAsItIs = fs::copy_options::recursive | fs::copy_options::copy_symlinks;
    fs::copy(entry, aside_ / name, kAsItIs | fs::copy_options::create_hard_links, error);
    if (error)
      fs::copy(entry, aside_ / name, kAsItIs | fs::copy_options::overwrite_existing, error);
    if (error)
      throw OutputError(entry.path().string(), "cannot be copied: " + error.message(),
                        "mend its permissions, or take it out of the folder");
  }
}

void WholeFolder::commit() {
  std::error_code error;
  fs::remove(folder_, error);  // an empty folder of that name
  if (fs::exists(folder_, error)) {
    take_over_others();
    replace_folder(disk_, aside_, folder_);
  } else {
    put_in_place(disk_, aside_, folder_);
  }
  committed_ = true;
}

}  // namespace strata::log
