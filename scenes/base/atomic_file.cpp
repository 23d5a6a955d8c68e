#include "scenes/base/atomic_file.h"

#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <system_error>

#include "scenes/base/error.h"

namespace raymeter {
namespace {

constexpr int ending_signals[] = {SIGINT, SIGTERM, SIGHUP};

/// The name of the file that is being written; the handler must not allocate.
std::atomic<const char*> unfinished = nullptr;
struct sigaction earlier_actions[std::size(ending_signals)];

extern "C" void remove_unfinished_and_end(int signal) {
  if (const char* file = unfinished.exchange(nullptr)) unlink(file);
  struct sigaction ordinary{};
  ordinary.sa_handler = SIG_DFL;
  sigaction(signal, &ordinary, nullptr);
  raise(signal);  // pending until this handler returns
}

/// A program that has handlers of its own keeps them.
void install_handlers() {
  for (std::size_t i = 0; i < std::size(ending_signals); ++i) {
    sigaction(ending_signals[i], nullptr, &earlier_actions[i]);
    if (earlier_actions[i].sa_handler != SIG_DFL) continue;
    struct sigaction action{};
    action.sa_handler = remove_unfinished_and_end;
    sigaction(ending_signals[i], &action, nullptr);
  }
}

void restore_handlers() {
  for (std::size_t i = 0; i < std::size(ending_signals); ++i)
    sigaction(ending_signals[i], &earlier_actions[i], nullptr);
}

}  // namespace

AtomicFile::AtomicFile(std::filesystem::path file)
    : file_(std::move(file)),
      temporary_(file_.parent_path() /
                 fmt::format(".{}.{}{}", file_.stem().string(), getpid(), file_.extension().string())) {
  install_handlers();
  unfinished = temporary_.c_str();
}

AtomicFile::~AtomicFile() {
  if (unfinished.exchange(nullptr)) {
    std::error_code ignored;
    std::filesystem::remove(temporary_, ignored);
  }
  restore_handlers();
}

void AtomicFile::commit() {
  std::error_code status;
  std::filesystem::rename(temporary_, file_, status);
  if (status) throw Error(fmt::format("{}: can't be written: {}", file_.string(), status.message()));
  unfinished = nullptr;
}

}  // namespace raymeter
