// SPDX-License-Identifier: Apache-2.0
/// A disk without space, to this process, as long as the object lives.
#pragma once

#include <csignal>

#include <sys/resource.h>

namespace strata::test {

class FullDisk {
 public:
  FullDisk() {
    (void)std::signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &before_);
    rlimit none = before_;
    none.rlim_cur = 0;  // no file may be written to, not even over what is there
    setrlimit(RLIMIT_FSIZE, &none);
  }
  ~FullDisk() { setrlimit(RLIMIT_FSIZE, &before_); }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;

 private:
  rlimit before_{};
};

}  // namespace strata::test
