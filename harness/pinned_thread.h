#pragma once
#include <sched.h>

namespace raymeter {

/// Holds the calling thread on the CPU it is running on, while it lives. Harmless where that is not allowed.
class PinnedThread {
 public:
  PinnedThread();
  ~PinnedThread();
  PinnedThread(const PinnedThread&) = delete;
  PinnedThread& operator=(const PinnedThread&) = delete;
  bool pinned() const { return pinned_; }

 private:
  cpu_set_t saved_{};
  bool pinned_ = false;
};

}  // namespace raymeter
