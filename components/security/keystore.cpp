// SPDX-License-Identifier: Apache-2.0
#include "components/security/keystore.hpp"

#include <algorithm>
#include <utility>

#include <unistd.h>

#include "components/security/text_file.hpp"
#include "core/base/error.hpp"

namespace strata::security {
namespace {

namespace fs = std::filesystem;

constexpr const char* kAuthorityName = "strataCA";

/// Every name under which the authority is found: public and private part.
constexpr std::pair<const char*, const char*> kLinks[] = {
    {"public/identity_ca.cert.pem", "ca.cert.pem"},
    {"public/permissions_ca.cert.pem", "ca.cert.pem"},
    {"private/identity_ca.key.pem", "ca.key.pem"},
    {"private/permissions_ca.key.pem", "ca.key.pem"}};

/// Runs what touches the file system, and names the folder when that fails.
template <typename Body>
void writing_to(const fs::path& folder, Body&& body) {
  try {
    body();
  } catch (const fs::filesystem_error& error) {
    throw OutputError(folder.string(), "cannot be written: " + error.code().message(),
                      "free some space or choose a folder you may write to");
  }
}

/// A folder that is made beside its place and moved there when it is whole.
class FolderInTheMaking {
 public:
  explicit FolderInTheMaking(fs::path place)
      : place_(std::move(place)),
        partial_(place_.parent_path() /
                 ("." + place_.filename().string() + ".partial-" + std::to_string(getpid()))) {
    writing_to(place_, [&] {
      fs::remove_all(partial_);
      fs::create_directories(partial_);
    });
  }
  ~FolderInTheMaking() {
    std::error_code ignored;
    fs::remove_all(partial_, ignored);
  }
  FolderInTheMaking(const FolderInTheMaking&) = delete;
  FolderInTheMaking& operator=(const FolderInTheMaking&) = delete;

  [[nodiscard]] const fs::path& path() const { return partial_; }
  void finish() {
    writing_to(place_, [&] { fs::rename(partial_, place_); });
  }

 private:
  fs::path place_;
  fs::path partial_;
};

fs::path without_trailing_slash(const fs::path& folder) {
  const fs::path normal = fs::absolute(folder).lexically_normal();
  return normal.has_filename() ? normal : normal.parent_path();
}

bool is_enclave(const fs::path& folder) { return fs::exists(folder / "cert.pem"); }

void write_permissions(const fs::path& folder, const std::string& enclave,
                       const Permissions& permissions, const Identity& authority) {
  const std::string document = permissions_document(enclave, permissions, kValidDays);
  const std::string signed_document = sign(authority, document);
  write_text(folder / "permissions.xml", document);
  write_text(folder / "permissions.p7s", signed_document);
}

}  // namespace

Keystore Keystore::create(const fs::path& folder) {
  const fs::path place = without_trailing_slash(folder);
  std::error_code ignored;
  if (fs::exists(place, ignored) && !fs::is_empty(place, ignored)) {
    throw OutputError(folder.string(), "is there already",
                      "choose a new folder, or add to it with `strata keystore add`");
  }
  FolderInTheMaking making(place);
  const fs::path& made = making.path();
  const Identity authority = make_authority(kAuthorityName);
  writing_to(place, [&] {
    for (const char* part : {"public", "private", "enclaves"}) fs::create_directory(made / part);
    fs::permissions(made / "private", fs::perms::owner_all);
    write_text(made / "public/ca.cert.pem", authority.certificate);
    write_text(made / "private/ca.key.pem", authority.private_key, true);
    for (const auto& [link, target] : kLinks) fs::create_symlink(target, made / link);
    write_text(made / "enclaves/governance.xml", governance_document());
    write_text(made / "enclaves/governance.p7s", sign(authority, governance_document()));
  });
  making.finish();
  return Keystore(place);
}

Keystore::Keystore(fs::path folder) : folder_(std::move(folder)) {
  std::error_code ignored;
  for (const char* part : {"public/identity_ca.cert.pem", "enclaves/governance.p7s"}) {
    if (fs::exists(folder_ / part, ignored)) continue;
    throw InputError(folder_.string(), std::string("is no keystore: it has no ") + part,
                     "make one with `strata keystore create`");
  }
}

Identity Keystore::identity_authority() const {
  return {read_text(folder_ / "public/identity_ca.cert.pem"),
          read_text(folder_ / "private/identity_ca.key.pem")};
}

Identity Keystore::permissions_authority() const {
  return {read_text(folder_ / "public/permissions_ca.cert.pem"),
          read_text(folder_ / "private/permissions_ca.key.pem")};
}

void Keystore::add(const std::string& enclave) const {
  const Enclave added = enclave_in(folder_, enclave);
  if (enclave == "/") {
    throw ConfigError("enclave '/'", "is the root of all enclaves", "choose a name like /robot1");
  }
  if (is_enclave(added.folder)) {
    throw OutputError("enclave " + enclave, "is there already",
                      "change what it may do with `strata keystore permissions`");
  }
  const Identity identity = issue(identity_authority(), enclave);
  // One that others are below is there as a folder, and cannot be moved over: "/fleet".
  writing_to(added.folder, [&] { fs::create_directories(added.folder); });
  const fs::path up = fs::relative(folder_, added.folder);
  writing_to(added.folder, [&] {
    const std::pair<const char*, fs::path> links[] = {
        {"identity_ca.cert.pem", up / "public/identity_ca.cert.pem"},
        {"permissions_ca.cert.pem", up / "public/permissions_ca.cert.pem"},
        {"governance.p7s", up / "enclaves/governance.p7s"}};
    for (const auto& [name, target] : links) {
      fs::remove(added.folder / name);
      fs::create_symlink(target, added.folder / name);
    }
  });
  write_permissions(added.folder, enclave, all_permissions(), permissions_authority());
  write_text(added.private_key(), identity.private_key, true);
  write_text(added.certificate(), identity.certificate);  // last: makes it an enclave
}

void Keystore::set_permissions(const std::string& enclave, const Permissions& permissions) const {
  const Enclave changed = enclave_in(folder_, enclave);
  if (!is_enclave(changed.folder)) {
    throw InputError("enclave " + enclave, "is not in " + folder_.string(),
                     "add it with `strata keystore add`");
  }
  write_permissions(changed.folder, enclave, permissions, permissions_authority());
}

std::vector<std::string> Keystore::enclaves() const {
  const fs::path root = folder_ / "enclaves";
  std::vector<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(root)) {
    if (!entry.is_directory() || !is_enclave(entry.path())) continue;
    names.push_back("/" + entry.path().lexically_relative(root).string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace strata::security
