// SPDX-License-Identifier: Apache-2.0
/// Every verb of `strata`, one a file: verb_<name>.cpp defines add_<name>, which calls add_verb.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "tools/strata/verb_context.hpp"

namespace strata::tools {

using AddVerb = void (*)(CLI::App& app, VerbContext& context);

void add_changes(CLI::App& app, VerbContext& context);
void add_compare(CLI::App& app, VerbContext& context);
void add_convert(CLI::App& app, VerbContext& context);
void add_doctor(CLI::App& app, VerbContext& context);
void add_evaluate(CLI::App& app, VerbContext& context);
void add_fleet(CLI::App& app, VerbContext& context);
void add_incidents(CLI::App& app, VerbContext& context);
void add_info(CLI::App& app, VerbContext& context);
void add_keystore(CLI::App& app, VerbContext& context);
void add_learn(CLI::App& app, VerbContext& context);
void add_localize(CLI::App& app, VerbContext& context);
void add_messages(CLI::App& app, VerbContext& context);
void add_play(CLI::App& app, VerbContext& context);
void add_record(CLI::App& app, VerbContext& context);
void add_replay(CLI::App& app, VerbContext& context);
void add_run(CLI::App& app, VerbContext& context);
void add_simulate(CLI::App& app, VerbContext& context);
void add_site(CLI::App& app, VerbContext& context);
void add_topology(CLI::App& app, VerbContext& context);
void add_view(CLI::App& app, VerbContext& context);
void add_volume(CLI::App& app, VerbContext& context);

/// In the order of the help text.
inline constexpr AddVerb kVerbs[] = {
    add_info,       //
    add_convert,    //
    add_learn,      //
    add_localize,   //
    add_compare,    //
    add_evaluate,   //
    add_changes,    //
    add_topology,   //
    add_volume,     //
    add_simulate,   //
    add_run,        //
    add_replay,     //
    add_record,     //
    add_play,       //
    add_view,       //
    add_incidents,  //
    add_site,       //
    add_fleet,      //
    add_doctor,     //
    add_keystore,   //
    add_messages,   //
};

/// The command line of one process of a composition (verb_run.cpp).
[[nodiscard]] std::vector<std::string> child_arguments(const std::string& composition,
                                                       const std::string& process,
                                                       const VerbContext& context, bool lockstep);

}  // namespace strata::tools
