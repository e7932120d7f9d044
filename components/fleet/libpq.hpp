// SPDX-License-Identifier: Apache-2.0
// The functions of libpq that a connection calls; only connection.cpp sees it.
#pragma once

#include <libpq-fe.h>

namespace strata::fleet {

/// libpq, loaded when somebody first asks a server: it brings TLS, Kerberos and LDAP along, 13 MB
/// of address space, for which a robot that runs no `strata fleet` need not have room.
class Libpq {
  void* library_ = load();
  [[nodiscard]] static void* load();
  [[nodiscard]] void* symbol(const char* name) const;
  template <class Function>
  [[nodiscard]] Function* find(const char* name) const {
    return reinterpret_cast<Function*>(symbol(name));
  }

 public:
  decltype(PQclear)* clear = find<decltype(PQclear)>("PQclear");
  decltype(PQcmdTuples)* cmd_tuples = find<decltype(PQcmdTuples)>("PQcmdTuples");
  decltype(PQconnectdbParams)* connectdb_params =
      find<decltype(PQconnectdbParams)>("PQconnectdbParams");
  decltype(PQconnectionNeedsPassword)* connection_needs_password =
      find<decltype(PQconnectionNeedsPassword)>("PQconnectionNeedsPassword");
  decltype(PQconnectionUsedPassword)* connection_used_password =
      find<decltype(PQconnectionUsedPassword)>("PQconnectionUsedPassword");
  decltype(PQconninfoFree)* conninfo_free = find<decltype(PQconninfoFree)>("PQconninfoFree");
  decltype(PQconninfoParse)* conninfo_parse = find<decltype(PQconninfoParse)>("PQconninfoParse");
  decltype(PQdb)* db = find<decltype(PQdb)>("PQdb");
  decltype(PQencryptPasswordConn)* encrypt_password_conn =
      find<decltype(PQencryptPasswordConn)>("PQencryptPasswordConn");
  decltype(PQerrorMessage)* error_message = find<decltype(PQerrorMessage)>("PQerrorMessage");
  decltype(PQexec)* exec = find<decltype(PQexec)>("PQexec");
  decltype(PQexecParams)* exec_params = find<decltype(PQexecParams)>("PQexecParams");
  decltype(PQfinish)* finish = find<decltype(PQfinish)>("PQfinish");
  decltype(PQfreemem)* freemem = find<decltype(PQfreemem)>("PQfreemem");
  decltype(PQgetisnull)* getisnull = find<decltype(PQgetisnull)>("PQgetisnull");
  decltype(PQgetlength)* getlength = find<decltype(PQgetlength)>("PQgetlength");
  decltype(PQgetvalue)* getvalue = find<decltype(PQgetvalue)>("PQgetvalue");
  decltype(PQhost)* host = find<decltype(PQhost)>("PQhost");
  decltype(PQntuples)* ntuples = find<decltype(PQntuples)>("PQntuples");
  decltype(PQport)* port = find<decltype(PQport)>("PQport");
  decltype(PQresultErrorField)* result_error_field =
      find<decltype(PQresultErrorField)>("PQresultErrorField");
  decltype(PQresultStatus)* result_status = find<decltype(PQresultStatus)>("PQresultStatus");
  decltype(PQsetNoticeProcessor)* set_notice_processor =
      find<decltype(PQsetNoticeProcessor)>("PQsetNoticeProcessor");
  decltype(PQsocket)* socket = find<decltype(PQsocket)>("PQsocket");
  decltype(PQsslInUse)* ssl_in_use = find<decltype(PQsslInUse)>("PQsslInUse");
  decltype(PQstatus)* status = find<decltype(PQstatus)>("PQstatus");
  decltype(PQuser)* user = find<decltype(PQuser)>("PQuser");
};

/// The same one for all. Throws OutputError where it cannot be loaded. Thread-safe.
[[nodiscard]] const Libpq& libpq();

}  // namespace strata::fleet
