#pragma once
#include <cstddef>
#include <string_view>

namespace raymeter {

/// A one-line progress bar on standard error, shown only when that is a terminal.
class ProgressBar {
 public:
  ProgressBar();
  ~ProgressBar() { clear(); }
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// `done` of `total` units are finished, and `doing` is being done.
  void show(std::size_t done, std::size_t total, std::string_view doing);
  /// Takes the bar off the screen, so that something else can be printed.
  void clear();

 private:
  bool on_terminal_;
  bool shown_ = false;
};

}  // namespace raymeter
