// SPDX-License-Identifier: Apache-2.0
/// A disk without space, to this process, as long as the object lives.
#pragma once

#include <csignal>

#include <sys/resource.h>

namespace strata::test {

class FullDisk {
 public:
  /// No file may be written to beyond so many bytes; 0: not even over what is there.
  explicit FullDisk(rlim_t largest_file_bytes = 0) {
    (void)std::signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &before_);
    rlimit limit = before_;
    limit.rlim_cur = largest_file_bytes;
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FullDisk() { setrlimit(RLIMIT_FSIZE, &before_); }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;

 private:
  rlimit before_{};
};

}  // namespace strata::test
