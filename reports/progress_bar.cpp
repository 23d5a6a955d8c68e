#include "reports/progress_bar.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace raymeter {

ProgressBar::ProgressBar() : on_terminal_(isatty(STDERR_FILENO) == 1) {}

void ProgressBar::show(std::size_t done, std::size_t total, std::string_view doing) {
  if (!on_terminal_) return;
  constexpr std::size_t width = 30;
  const std::size_t filled = total ? std::min(width, width * done / total) : 0;
  fmt::print(stderr, "\r\033[K[{:#<{}}{:.<{}}] {:3}% {}", "", filled, "", width - filled,
             total ? 100 * done / total : 0, doing.substr(0, 60));
  std::fflush(stderr);
  shown_ = true;
}

void ProgressBar::clear() {
  if (shown_) fmt::print(stderr, "\r\033[K");
  std::fflush(stderr);
  shown_ = false;
}

}  // namespace raymeter
