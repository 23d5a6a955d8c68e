#include "harness/pinned_thread.h"

#include <tbb/info.h>

namespace raymeter {

PinnedThread::PinnedThread() {
  // TBB counts the CPUs that it may use only once: it must not do so while this thread has but one.
  tbb::info::default_concurrency();
  const int cpu = sched_getcpu();
  if (cpu < 0 || cpu >= CPU_SETSIZE || sched_getaffinity(0, sizeof saved_, &saved_) != 0) return;
  cpu_set_t one;
  CPU_ZERO(&one);
  CPU_SET(cpu, &one);
  pinned_ = sched_setaffinity(0, sizeof one, &one) == 0;
}

PinnedThread::~PinnedThread() {
  if (pinned_) sched_setaffinity(0, sizeof saved_, &saved_);
}

}  // namespace raymeter
