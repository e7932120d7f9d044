// SPDX-License-Identifier: Apache-2.0
/// `strata VERB`: reads the command line, runs one verb, turns errors into one line and an exit
/// code: 0 done, 1 failed while running, 2 bad usage or bad input.
#include <csignal>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <unistd.h>

#include "components/settings/config_reader.hpp"
#include "core/base/error.hpp"
#include "tools/strata/shortage.hpp"
#include "tools/strata/verbs.hpp"

namespace strata::tools {
namespace {

constexpr int kFailed = 1;
constexpr int kBadInput = 2;

std::string one_line(std::string text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == '.')) text.pop_back();
  for (char& c : text) {
    if (c == '\n') c = ' ';
  }
  return text;
}

std::string first_word(int argc, char** argv) {
  return argc > 1 && argv[1][0] != '-' ? std::string(argv[1]) : std::string();
}

std::string verb_of(const CLI::App& app, int argc, char** argv) {
  for (const CLI::App* verb : app.get_subcommands()) return verb->get_name();
  return first_word(argc, argv);
}

/// Nothing when the word is a verb.
std::string what_was_meant(const CLI::App& app, const std::string& word) {
  std::vector<std::string> names;
  for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (verb->get_name() == word) return "";
    names.push_back(verb->get_name());
  }
  return settings::detail::suggestion(word, names, "verbs");
}

/// What is under way lies beside its place (log::staged_name); users know only the place.
std::string with_names_of_users(std::string text) {
  const std::string mark = ".partial-" + std::to_string(getpid());
  for (auto at = text.find(mark); at != std::string::npos; at = text.find(mark)) {
    text.erase(at, mark.size());
    const std::size_t before = text.substr(0, at).find_last_of("/ ");
    const std::size_t begin = before == std::string::npos ? 0 : before + 1;
    if (text[begin] == '.') text.erase(begin, 1);
  }
  return text;
}

int fail(const std::string& verb, const std::string& message, int code) {
  std::cerr << "strata" << (verb.empty() ? "" : " ") << verb
            << ": error: " << one_line(with_names_of_users(message)) << std::endl;
  return code;
}

std::string plain(const std::exception& error, const Work& work = {}) {
  if (const auto* file = dynamic_cast<const std::filesystem::filesystem_error*>(&error)) {
    return file->path1().string() + ": " + file->code().message() +
           "; check the path, its permissions and free space";
  }
  const std::string shortage = describe_shortage(error, work);
  return shortage.empty() ? error.what() : shortage;
}

const char* what_overdue_means(Interrupt::Overdue why) {
  switch (why) {
    case Interrupt::Overdue::kHurried:
      return "interrupted a second time, before all was written; run the command again";
    case Interrupt::Overdue::kUnwritten:
      return "did not end in its time; what it had not written yet is lost; look for a slow disk "
             "or a component that hangs";
    case Interrupt::Overdue::kGraceIsOver:
      break;
  }
  return "interrupted; run the command again";
}

int run(int argc, char** argv) {
  // Who read what it says may be gone (`| tee log`): that is no reason to end unsaved.
  (void)std::signal(SIGPIPE, SIG_IGN);
  StagedPaths staged;  // outlives the watcher of signals, which may empty it to the last
  Interrupt interrupt;
  interrupt.set_on_overdue([&staged](Interrupt::Overdue why) {
    staged.remove_all();
    std::fprintf(stderr, "\nstrata: error: %s\n", what_overdue_means(why));
  });
  VerbContext context(interrupt, staged);
  CLI::App app("Maps that know change, for robots that stay", "strata");
  app.set_version_flag("--version", STRATA_VERSION);
  app.require_subcommand(1);
  for (const AddVerb add : kVerbs) add(app, context);
  refuse_odd_numbers(app);

  const auto verb = [&] { return verb_of(app, argc, argv); };
  // Before --help is read, which would answer for any word.
  if (const std::string word = first_word(argc, argv); !word.empty()) {
    const std::string meant = what_was_meant(app, word);
    if (!meant.empty()) {
      return fail(word, "command line: there is no verb '" + word + "'; " + meant, kBadInput);
    }
  }
  try {
    app.parse(argc, argv);
    std::cout.flush();
    if (!std::cout) throw OutputError("stdout", "cannot be written", "free some space");
    return 0;
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
    if (argc < 2) std::cerr << app.help();
    const std::string name = verb();
    return fail(name,
                "command line: " + one_line(error.what()) + "; see `strata" +
                    (name.empty() ? "" : " " + name) + " --help`",
                kBadInput);
  } catch (const InputError& error) {
    return fail(verb(), error.what(), kBadInput);
  } catch (const ConfigError& error) {
    return fail(verb(), error.what(), kBadInput);
  } catch (const std::exception& error) {
    return fail(verb(), plain(error, {verb(), context.stage()}), kFailed);
  }
}

}  // namespace
}  // namespace strata::tools

int main(int argc, char** argv) {
  strata::tools::prepare_for_shortage();
  try {
    return strata::tools::run(argc, argv);
  } catch (const std::exception& error) {  // before the verb is known
    return strata::tools::fail("", strata::tools::plain(error), strata::tools::kFailed);
  }
}
