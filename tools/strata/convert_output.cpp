// SPDX-License-Identifier: Apache-2.0
#include "tools/strata/convert_output.hpp"

#include <string>
#include <system_error>

#include "components/log/disk.hpp"
#include "core/base/error.hpp"

namespace fs = std::filesystem;

namespace strata::tools {

void write_bag_or_file(const fs::path& out, StagedPaths& staged,
                       const std::function<void(const fs::path&)>& write) {
  const std::string ending = out.extension().string();
  if (ending != ".db3" && ending != ".mcap") {
    write(out);
    return;
  }
  log::remove_left_over(out);
  const fs::path aside = log::staged_name(out);
  staged.add(aside);
  std::error_code ignored;
  try {
    fs::remove_all(aside);
    fs::create_directory(aside);
    write(aside / "bag");
    for (const auto& entry : fs::directory_iterator(aside / "bag")) {
      if (entry.path().extension() == ".yaml") continue;
      log::put_in_place(log::real_disk(), entry.path(), out);
    }
  } catch (...) {
    fs::remove_all(aside, ignored);
    staged.forget(aside);
    throw;
  }
  fs::remove_all(aside, ignored);
  staged.forget(aside);
}

void require_writable(const fs::path& out, bool is_file) {
  std::error_code error;
  const auto refuse = [&](const std::string& why, const char* remedy) {
    throw OutputError(out.string(), why, remedy);
  };
  const bool is_folder = fs::is_directory(out, error);
  if (is_file && is_folder) refuse("is a folder, not a file", "give OUT another name");
  if (!is_file && fs::exists(out, error) && (!is_folder || !fs::is_empty(out, error))) {
    refuse("exists already", "choose another name or remove it");
  }
  const fs::path folder = out.has_parent_path() ? out.parent_path() : fs::path(".");
  if (!is_file && !fs::exists(folder, error)) return;  // made for the bag
  if (!fs::is_directory(folder, error)) refuse("its folder does not exist", "make it first");
  // As the name will be: the longest that is needed, where nothing else can be in the way.
  const fs::path probe = log::staged_name(out);
  log::remove_left_over(out);
  const bool is_made = fs::create_directory(probe, error);
  if (!is_made) refuse("cannot be written: " + error.message(), "choose another OUT");
  fs::remove(probe, error);
}

void refuse_to_write_over(const fs::path& in, const fs::path& out_given) {
  std::error_code error;
  const fs::path out = fs::absolute(out_given);
  const bool is_input = fs::equivalent(in, out, error);
  const bool is_part = fs::is_directory(in, error) && fs::is_regular_file(out, error) &&
                       fs::equivalent(in, out.parent_path(), error);
  if (!is_input && !is_part) return;
  throw OutputError(out_given.string(),
                    is_input ? "is the log to convert" : "is a part of the log to convert",
                    "give OUT another name");
}

}  // namespace strata::tools
