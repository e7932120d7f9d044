// SPDX-License-Identifier: Apache-2.0
#include "components/log/damaged_file.hpp"

#include <string>
#include <system_error>

namespace fs = std::filesystem;

namespace strata::log {
namespace {

constexpr const char* kDamagedMark = ".damaged";
constexpr const char* kRemedy =
    "put the file back from a backup while the component is stopped, or remove what was set aside";

fs::path with(const fs::path& file, const std::string& ending) { return file.string() + ending; }

/// Also a link that leads nowhere.
bool is_there(const fs::path& path) {
  std::error_code error;
  return fs::exists(fs::symlink_status(path, error));
}

/// Neither the name itself nor that of a part is taken.
fs::path free_name(const fs::path& file) {
  for (int number = 1;; ++number) {
    const fs::path name =
        with(file, kDamagedMark + (number > 1 ? "-" + std::to_string(number) : ""));
    if (!is_there(name) && !is_there(with(name, "-wal")) && !is_there(with(name, "-shm"))) {
      return name;
    }
  }
}

bool is_empty_file(const fs::path& file) {
  std::error_code error;
  return fs::is_regular_file(file, error) && fs::file_size(file, error) == 0;
}

DamageError give_up(const fs::path& file, const InputError& reason, const Disk& disk) {
  const std::string problem = reason.problem().c_str();  // zeros of the file would end what is told
  fs::path aside;
  try {
    aside = set_aside(file, disk);
  } catch (const OutputError& error) {
    throw OutputError(reason.place(), problem + ", and cannot be set aside: " + error.problem(),
                      "check the folder's permissions, or move the file away");
  }
  return {reason.place(),
          problem + "; it was set aside as '" + aside.string() + "', and is gone on without",
          kRemedy};
}

}  // namespace

fs::path set_aside(const fs::path& file, const Disk& disk) {
  const fs::path aside = free_name(file);
  // The file itself comes last: a crash in between leaves what is again found to be damaged, not a
  // log beside a new file.
  for (const char* part : {"-shm", "-wal", ""}) {
    if (is_there(with(file, part))) disk.rename(with(file, part), with(aside, part));
  }
  disk.sync(file.has_parent_path() ? file.parent_path() : fs::path("."));
  return aside;
}

InputError other_frame(const fs::path& file, const fs::path& aside) {
  return {file.string(),
          "was learned in another map frame: where the robot is now it shows something else, at "
          "several places; it was set aside as '" +
              aside.string() + "', and is gone on without",
          "keep the stores of a scan matcher and of who learns in its map together"};
}

bool is_set_aside(const fs::path& path) {
  return path.filename().string().find(kDamagedMark) != std::string::npos;
}

std::optional<DamageError> restore_or_set_aside(const fs::path& file,
                                                const std::function<void()>& restore,
                                                const Disk& disk) {
  try {
    if (is_empty_file(file)) throw DamageError(file.string(), "is empty", kRemedy);
    restore();
    return std::nullopt;
  } catch (const DamageError& error) {
    return give_up(file, error, disk);
  } catch (const UnknownContentError& error) {
    return give_up(file, error, disk);
  }
}

}  // namespace strata::log
