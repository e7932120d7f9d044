// SPDX-License-Identifier: Apache-2.0
#include <cerrno>
#include <csignal>
#include <cstring>
#include <string>
#include <vector>

#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/base/error.hpp"
#include "tools/report/image.hpp"

extern char** environ;

namespace strata::report {
namespace {

[[noreturn]] void fail(const std::string& what, const std::string& remedy) {
  throw OutputError("plot", what, remedy);
}

/// A nameless file in memory: a child may read or write it whole, in any order, where a pipe would
/// have to be emptied while it is filled.
class MemoryFile {
 public:
  MemoryFile() : descriptor_(memfd_create("strata plot", MFD_CLOEXEC)) {
    if (descriptor_ < 0) fail(std::strerror(errno), "close some files or free some memory");
  }
  ~MemoryFile() { close(descriptor_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  [[nodiscard]] int descriptor() const { return descriptor_; }

  void fill(const std::string& bytes) {
    for (std::size_t done = 0; done < bytes.size();) {
      const ssize_t count = write(descriptor_, bytes.data() + done, bytes.size() - done);
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) fail(std::strerror(errno), "free some memory");
      done += static_cast<std::size_t>(count);
    }
    lseek(descriptor_, 0, SEEK_SET);
  }

  [[nodiscard]] std::string bytes() const {
    std::string all(static_cast<std::size_t>(lseek(descriptor_, 0, SEEK_END)), '\0');
    for (std::size_t done = 0; done < all.size();) {
      const ssize_t count =
          pread(descriptor_, all.data() + done, all.size() - done, static_cast<off_t>(done));
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) fail(std::strerror(errno), "free some memory");
      done += static_cast<std::size_t>(count);
    }
    return all;
  }

 private:
  int descriptor_;
};

/// Starts `words` with the three files as its standard streams and waits for its end; its status.
int run(std::vector<std::string> words, const MemoryFile& in, const MemoryFile& out,
        const MemoryFile& errors) {
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t streams;
  posix_spawn_file_actions_init(&streams);
  posix_spawn_file_actions_adddup2(&streams, in.descriptor(), STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&streams, out.descriptor(), STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&streams, errors.descriptor(), STDERR_FILENO);
  pid_t pid = 0;
  const int failed =
      posix_spawnp(&pid, arguments.front(), &streams, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&streams);
  if (failed != 0) {
    fail("cannot be drawn: " + words.front() + " cannot be started: " + std::strerror(failed),
         "install librsvg2-bin");
  }
  int status = 0;
  pid_t ended = 0;
  while ((ended = waitpid(pid, &status, 0)) < 0 && errno == EINTR) {
  }
  if (ended != pid)
    fail("cannot be drawn: how " + words.front() + " ended cannot be told",
         "do not ignore SIGCHLD");
  return status;
}

/// What fontconfig and glib say, and how the system ends, a process that gets no memory or no
/// thread.
bool lacks_memory(int status, const std::string& said) {
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL) return true;
  return said.find("Resource temporarily unavailable") != std::string::npos ||
         said.find("emory") != std::string::npos ||
         said.find("failed to map segment") != std::string::npos;
}

[[noreturn]] void fail_to_draw(int status, const std::string& said) {
  if (lacks_memory(status, said)) {
    fail("cannot be drawn: memory or threads ran out for rsvg-convert",
         "free some memory, or raise the limits on address space and processes (`ulimit -v`, "
         "`ulimit -u`)");
  }
  const std::string why = WIFSIGNALED(status) ? std::string(": ") + strsignal(WTERMSIG(status))
                                              : " with " + std::to_string(WEXITSTATUS(status));
  fail("cannot be drawn: rsvg-convert ended" + why + (said.empty() ? "" : " and says: " + said),
       "report this with the log at hand");
}

}  // namespace

// In a process of its own: fontconfig, which letters need, never frees what it has read, and a
// robot's process need not load the thirty libraries below librsvg.
std::string render_svg_to_png(const std::string& svg, double scale) {
  MemoryFile picture;
  picture.fill(svg);
  const MemoryFile png;
  const MemoryFile errors;
  const int status = run({"rsvg-convert", "--format=png", "--unlimited", "--background-color=white",
                          "--zoom=" + std::to_string(scale)},
                         picture, png, errors);
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    fail_to_draw(status, errors.bytes());
  }
  return png.bytes();
}

}  // namespace strata::report
