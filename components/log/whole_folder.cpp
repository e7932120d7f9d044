// SPDX-License-Identifier: Apache-2.0
#include "components/log/whole_folder.hpp"

#include <string>
#include <system_error>

#include "core/base/error.hpp"

namespace fs = std::filesystem;

namespace strata::log {

WholeFolder::WholeFolder(const fs::path& folder, const Disk& disk)
    : disk_(disk), folder_(fs::weakly_canonical(fs::absolute(folder))) {
  if (!folder_.has_filename()) folder_ = folder_.parent_path();
  std::error_code error;
  if (fs::exists(folder_, error) && (!fs::is_directory(folder_) || !fs::is_empty(folder_))) {
    throw OutputError(folder.string(), "exists already", "choose another name or remove it");
  }
  aside_ = staged_name(folder_);
  fs::remove_all(aside_, error);
}

WholeFolder::~WholeFolder() {
  std::error_code ignored;
  if (!committed_) fs::remove_all(aside_, ignored);
}

void WholeFolder::commit() {
  std::error_code error;
  fs::remove(folder_, error);  // an empty folder of that name
  put_in_place(disk_, aside_, folder_);
  committed_ = true;
}

}  // namespace strata::log
