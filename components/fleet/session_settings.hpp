// SPDX-License-Identifier: Apache-2.0
/// What a connection of ours sets at the server, whatever the role's own defaults are.
#pragma once

namespace strata::fleet {

/// $1: how long a statement may take ("120s"). The server would let visits that it has acknowledged
/// go at a power cut, were it told so; a role may make its own sessions read-only or serializable,
/// or end where rows are not its own; and of a client without a network the server lets go after a
/// minute or so, not after two hours, so that a role's few connections are not used up.
inline constexpr const char* kSessionSettings =
    "SELECT set_config('statement_timeout', $1, false), "
    "set_config('lock_timeout', $1, false), "
    "set_config('idle_in_transaction_session_timeout', $1, false), "
    "set_config('synchronous_commit', 'on', false), "
    "set_config('default_transaction_read_only', 'off', false), "
    "set_config('default_transaction_isolation', 'read committed', false), "
    "set_config('row_security', 'on', false), "
    "set_config('tcp_keepalives_idle', '30', false), "
    "set_config('tcp_keepalives_interval', '10', false), "
    "set_config('tcp_keepalives_count', '3', false), "
    "set_config('tcp_user_timeout', '60s', false), "
    "set_config('client_encoding', 'UTF8', false), "
    "set_config('search_path', 'pg_catalog', false)";

}  // namespace strata::fleet
