#pragma once
#include <filesystem>

namespace raymeter {

/// A file that appears under its name complete or not at all: it is written under another name in the same
/// folder, and renamed. What is not committed is removed, also when SIGINT, SIGTERM or SIGHUP end the
/// process. One at a time in a process.
class AtomicFile {
 public:
  explicit AtomicFile(std::filesystem::path file);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  /// Where to write; of the same extension.
  const std::filesystem::path& temporary() const { return temporary_; }
  /// Gives the file its name, in place of an older one. Throws Error when it can't.
  void commit();

 private:
  std::filesystem::path file_, temporary_;
};

}  // namespace raymeter
