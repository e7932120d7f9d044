// SPDX-License-Identifier: Apache-2.0
#include "tools/strata/shortage.hpp"

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <new>
#include <system_error>

#include <malloc.h>
#include <sys/resource.h>
#include <unistd.h>

#include "tools/strata/memory_advice.hpp"

namespace strata::tools {
namespace {

/// In MB; 0: none.
unsigned long long limit_on_address_space() {
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return 0;
  return limit.rlim_cur >> 20U;
}

/// " under the limit of 78 MB on address space"; empty: there is none. Needs no memory.
struct LimitText {
  char text[64] = "";
  LimitText() {
    if (const unsigned long long limit_mb = limit_on_address_space(); limit_mb > 0) {
      std::snprintf(text, sizeof text, " under the limit of %llu MB on address space", limit_mb);
    }
  }
  [[nodiscard]] const char* remedy() const {
    return text[0] != '\0' ? "raise it (`ulimit -v`)" : "free some";
  }
};

/// Of the last allocation that failed; 0: none was noted.
std::atomic<std::size_t> asked_bytes{0};
std::atomic<std::size_t> in_use_bytes{0};

std::string size_text(std::size_t bytes) {
  char text[32];
  std::snprintf(text, sizeof text, bytes < 10'000'000 ? "%.1f MB" : "%.0f MB",
                static_cast<double>(bytes) * 1e-6);
  return text;
}

/// ": 'match scans' needed 120 MB beside the 310 MB in use".
std::string what_was_asked(const Work& work) {
  if (asked_bytes == 0 && work.stage.empty()) return "";
  std::string text = ": " + (work.stage.empty() ? "it" : "'" + work.stage + "'");
  if (asked_bytes == 0) return text + " needed more";
  return text + " needed " + size_text(asked_bytes) + " more, beside " + size_text(in_use_bytes) +
         " in use";
}

/// Without memory of its own, since that is what may be lacking.
[[noreturn]] void end_with_a_line() {
  try {
    if (std::current_exception()) throw;
  } catch (const std::bad_alloc&) {
    // Also a destructor: nlohmann's JSON allocates in its own, to destroy what is nested.
    const LimitText under;
    std::fprintf(stderr,
                 "strata: error: memory: ran out%s where it ends the process (a thread of the "
                 "middleware, or a destructor); %s, or give it less to do\n",
                 under.text, under.remedy());
    _exit(1);
  } catch (const std::system_error& error) {
    if (error.code() == std::errc::resource_unavailable_try_again) {
      std::fputs(
          "strata: error: threads: the middleware could not make one, which ends the process; "
          "raise the limits on processes and address space (`ulimit -u`, `ulimit -v`)\n",
          stderr);
      _exit(1);
    }
    std::fprintf(stderr, "strata: error: %s\n", error.what());
  } catch (const std::exception& error) {
    std::fprintf(stderr, "strata: error: %s\n", error.what());
  } catch (...) {
    std::fputs("strata: error: an exception of unknown type\n", stderr);
  }
  std::abort();  // a mistake of the program: a core file may tell
}

}  // namespace

void note_failed_allocation(std::size_t bytes) noexcept {
  const struct mallinfo2 now = mallinfo2();
  in_use_bytes = now.uordblks + now.hblkhd;
  asked_bytes = bytes;
}

std::string describe_shortage(const std::exception& error, const Work& work) {
  const LimitText under;
  if (dynamic_cast<const std::bad_alloc*>(&error) != nullptr) {
    const std::string advice = memory_advice(work.verb, work.stage);
    return std::string("memory: ran out") + under.text + what_was_asked(work) + "; " +
           under.remedy() + ", or " + (advice.empty() ? "give it less to do" : advice);
  }
  const auto* system = dynamic_cast<const std::system_error*>(&error);
  if (system != nullptr && system->code() == std::errc::resource_unavailable_try_again) {
    return std::string("threads: no more can be made") + under.text +
           "; raise the limits on processes and address space (`ulimit -u`, `ulimit -v`)";
  }
  return "";
}

std::string shortage_in_words(std::string told, std::string_view type, std::string_view name) {
  const auto put = [&told](const std::string& system, const std::string& words) {
    if (const std::size_t at = told.find(system); at != std::string::npos) {
      told.replace(at, system.size(), words);
    }
  };
  put("std::bad_alloc",
      "memory ran out" + what_was_asked({}) + "; " + memory_advice_of_component(type, name));
  put("Resource temporarily unavailable",
      "no more threads can be made; raise the limits on processes and address space (`ulimit -u`, "
      "`ulimit -v`)");
  return told;
}

void prepare_for_shortage() {
  if (limit_on_address_space() > 0) mallopt(M_ARENA_MAX, 1);
  std::set_terminate(end_with_a_line);
}

}  // namespace strata::tools
