// SPDX-License-Identifier: Apache-2.0
#include "components/fleet/server_name.hpp"

#include <string_view>

#include "components/fleet/connection.hpp"
#include "components/fleet/libpq.hpp"

namespace strata::fleet {
namespace {

const std::string kScheme = "postgresql://";

}  // namespace

std::string server_name(const std::string& host, const std::string& port,
                        const std::string& database) {
  if (host.starts_with('/')) {  // the folder of a socket
    return kScheme + "/" + database + "?host=" + host + (port.empty() ? "" : "&port=" + port);
  }
  return kScheme + (host.empty() ? "localhost" : host) + (port.empty() ? "" : ":" + port) + "/" +
         database;
}

std::string url_for(const std::string& place, const std::string& user) {
  return kScheme + user + "@" + place.substr(kScheme.size());
}

std::string url_without_secrets(const std::string& url) {
  char* said = nullptr;
  PQconninfoOption* parts = libpq().conninfo_parse(url.c_str(), &said);
  if (parts == nullptr) {
    libpq().freemem(said);  // it may repeat the password
    throw InputError("URL", "is none of a PostgreSQL server",
                     "write it as postgresql://USER@HOST/DATABASE");
  }
  std::string host;
  std::string port;
  std::string database;
  for (const PQconninfoOption* part = parts; part->keyword != nullptr; ++part) {
    if (part->val == nullptr) continue;
    const std::string_view keyword = part->keyword;
    if (keyword == "host") host = part->val;
    if (keyword == "port") port = part->val;
    if (keyword == "dbname") database = part->val;
  }
  libpq().conninfo_free(parts);
  return server_name(host, port, database);
}

}  // namespace strata::fleet
