// SPDX-License-Identifier: Apache-2.0
#include "components/log/set_back_watch.hpp"

namespace strata::log {

SetBackWatch::Verdict SetBackWatch::add(Stamp stamp) {
  if (!newest_ || stamp >= *newest_) {
    newest_ = stamp;
    suspect_.reset();
    return Verdict::kOn;
  }
  if ((*newest_ - stamp).seconds() <= kMinSetBackS) {
    suspect_.reset();  // the clock is not set back: this one goes by it
    return Verdict::kLate;
  }
  if (!suspect_ || stamp < *suspect_) {
    suspect_ = stamp;
    return Verdict::kSuspect;
  }
  newest_ = stamp;
  suspect_.reset();
  return Verdict::kSetBack;
}

}  // namespace strata::log
