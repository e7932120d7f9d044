// SPDX-License-Identifier: Apache-2.0
#include "tests/components/fleet/postgres_server.hpp"

#include <csignal>
#include <fstream>
#include <stdexcept>
#include <utility>
#include <vector>

#include <pwd.h>
#include <unistd.h>

#include "tests/support/comes_true.hpp"
#include "tests/support/command.hpp"

namespace fs = std::filesystem;

namespace strata::test {
namespace {

/// The server refuses to run as root: then as the user that Debian's package makes.
constexpr const char* kUser = "postgres";

std::vector<std::string> as_a_user() {
  if (geteuid() != 0) return {};
  return {"setpriv", std::string("--reuid=") + kUser, std::string("--regid=") + kUser,
          "--clear-groups"};
}

void give_to_user(const fs::path& path) {
  if (geteuid() != 0) return;
  const passwd* user = getpwnam(kUser);
  if (user == nullptr || chown(path.c_str(), user->pw_uid, user->pw_gid) != 0) {
    throw std::runtime_error(path.string() + " cannot be given to " + kUser);
  }
}

}  // namespace

std::optional<fs::path> PostgresServer::programs() {
  std::optional<fs::path> newest;
  std::error_code error;
  for (const auto& version : fs::directory_iterator("/usr/lib/postgresql", error)) {
    const fs::path bin = version.path() / "bin";
    if (fs::exists(bin / "initdb") && (!newest || newest < bin)) newest = bin;
  }
  return newest;
}

PostgresServer::PostgresServer(const std::string& more) : more_(more) {
  give_to_user(folder());
  const fs::path secret = folder() / "secret";
  std::ofstream(secret) << "admin secret\n";
  give_to_user(secret);
  std::string command;
  for (const std::string& word : as_a_user()) command += word + " ";
  command += quoted(*programs() / "initdb") + " -D " + quoted(folder() / "data") +
             " -U admin -A scram-sha-256 -E UTF8 --locale=C --no-sync --pwfile=" + quoted(secret) +
             " 2>&1";
  const Outcome made = run_command("cd / && " + command);
  if (made.code != 0) throw std::runtime_error("initdb: " + made.out);
  start();
}

PostgresServer::~PostgresServer() {
  if (process_) kill_hard();
}

std::string PostgresServer::url(const std::string& role, const std::string& password,
                                const std::string& more) const {
  std::string escaped;
  for (const char c : password) escaped += c == ' ' ? std::string("%20") : std::string(1, c);
  return "postgresql://" + role + ":" + escaped + "@/postgres?host=" + folder().string() + more;
}

void PostgresServer::kill_hard() {
  process_->send(SIGSTOP);  // it would start them again
  for (const pid_t child : process_->children()) (void)kill(child, SIGKILL);
  process_->kill_hard();
  (void)process_->wait();
  process_.reset();
}

void PostgresServer::start() {
  // Until the kernel has cleared up after those that were killed it may refuse.
  const bool is_up = comes_true([&] {
    if (!process_ || !process_->runs()) {
      std::vector<std::string> command = as_a_user();
      for (const std::string& word :
           {(*programs() / "postgres").string(), std::string("-D"), (folder() / "data").string(),
            std::string("-k"), folder().string(), std::string("-c"),
            std::string("listen_addresses="), std::string("-c"),
            std::string("logging_collector=on"), std::string("-c"),
            // What processes that die have written is the kernel's, and stays.
            std::string("fsync=off")}) {
        command.push_back(word);
      }
      if (!more_.empty()) {
        command.emplace_back("-c");
        command.push_back(more_);
      }
      process_ = std::make_unique<ChildProcess>(std::move(command), std::vector<std::string>{},
                                                ChildProcess::Errors::kMerged);
    }
    try {
      (void)admin().query("SELECT 1");
      return true;
    } catch (const Error&) {
      return false;
    }
  });
  if (!is_up) throw std::runtime_error("PostgreSQL does not start in " + folder().string());
}

}  // namespace strata::test
